#include "drivers/mcap/mcap_reader.hpp"

#include <algorithm>
#include <utility>

namespace slamd {
namespace {

constexpr std::size_t kFooterBytes = kMcapRecordHead + 20;

/// Calls visit(op, content) for the records in `bytes` until it returns false or the bytes end.
template <class Visit>
void visit_records(std::span<const std::uint8_t> bytes, Visit&& visit) {
  ByteReader from{bytes};
  while (from.remaining() >= kMcapRecordHead) {
    const auto op = static_cast<McapOp>(from.u8());
    const auto content = from.take(from.u64_le());
    if (!from.ok() || !visit(op, content)) return;
  }
}

/// The summary section up to the footer's checksum, checked by it; empty when there is none.
std::span<const std::uint8_t> summary_of(std::span<const std::uint8_t> file) {
  if (file.size() < 2 * kMcapMagic.size() + kFooterBytes) return {};
  const std::size_t footer = file.size() - kMcapMagic.size() - kFooterBytes;
  if (!McapReader::is_mcap(file.last(kMcapMagic.size())) || file[footer] != static_cast<std::uint8_t>(McapOp::kFooter)) return {};
  ByteReader from{file.subspan(footer + kMcapRecordHead)};
  const std::uint64_t begin = from.u64_le();
  from.skip(8);
  const std::uint32_t crc = from.u32_le();
  if (begin < kMcapMagic.size() || begin >= footer) return {};
  const auto summed = file.subspan(begin, file.size() - kMcapMagic.size() - 4 - begin);
  if (crc != 0 && crc != crc32_of(summed)) return {};
  return file.subspan(begin, footer - begin);
}

}  // namespace

bool McapReader::is_mcap(std::span<const std::uint8_t> file) {
  return file.size() >= kMcapMagic.size() && std::equal(kMcapMagic.begin(), kMcapMagic.end(), file.begin());
}

McapReader::McapReader(std::span<const std::uint8_t> file, std::function<bool(const McapChannel&)> wanted)
    : file_{file}, wanted_{std::move(wanted)}, at_{std::min(kMcapMagic.size(), file.size())} {
  // A damaged record at the file's begin then costs no channel.
  visit_records(summary_of(file), [this](McapOp op, std::span<const std::uint8_t> content) {
    if (op == McapOp::kSchema || op == McapOp::kChannel) take({op, content, true});
    return true;
  });
}

/// Nothing where not even a head is left.
std::optional<McapReader::Record> McapReader::record_at(std::span<const std::uint8_t> bytes, std::size_t at) const {
  ByteReader from{bytes.subspan(at)};
  const auto op = static_cast<McapOp>(from.u8());
  const std::uint64_t length = from.u64_le();
  if (!from.ok()) return std::nullopt;
  const bool is_whole = length <= from.remaining();
  return Record{op, from.take(is_whole ? length : from.remaining()), is_whole};
}

const McapMessage* McapReader::next() {
  while (true) {
    if (const McapMessage* message = next_of_chunk()) return message;
    if (closed_ || at_ >= file_.size()) return nullptr;
    record_at_ = at_;
    const std::optional<Record> record = record_at(file_, at_);
    const bool is_damaged = !record || !record->is_whole || record->op == McapOp{0};
    if (is_damaged) {
      blame("a record breaks off or its length is wrong");
      if (!record || record->op != McapOp::kChunk || !enter(*record)) search();
      continue;
    }
    at_ += kMcapRecordHead + record->content.size();
    if (const McapMessage* message = take(*record)) return message;
  }
}

const McapMessage* McapReader::next_of_chunk() {
  while (chunk_at_ < chunk_.bytes.size()) {
    const std::optional<Record> record = record_at(chunk_.bytes, chunk_at_);
    if (!record || !record->is_whole) {
      chunk_at_ = chunk_.bytes.size();  // the rest of a chunk that is cut off
      break;
    }
    chunk_at_ += kMcapRecordHead + record->content.size();
    if (record->op == McapOp::kChunk) continue;  // none may be in one
    if (const McapMessage* message = take(*record)) return message;
  }
  return nullptr;
}

/// A message that is wanted comes back; what else a record says is noted.
const McapMessage* McapReader::take(const Record& record) {
  if (record.op == McapOp::kChunk) open_chunk(record);
  if (record.op > McapOp::kDataEnd) {
    damage_.unreadable_bytes += kMcapRecordHead + record.content.size();
    blame("a record of an unknown kind");
  }
  if (record.op == McapOp::kDataEnd || record.op == McapOp::kFooter) closed_ = true;
  if (record.op == McapOp::kSchema) {
    if (std::optional<McapSchema> schema = parse_schema(record.content)) schemas_.emplace(schema->id, *std::move(schema));
  }
  if (record.op == McapOp::kChannel) {
    if (std::optional<McapChannel> channel = parse_channel(record.content)) {
      is_wanted_.emplace(channel->id, !wanted_ || wanted_(*channel));
      channels_.emplace(channel->id, *std::move(channel));
    }
  }
  if (record.op != McapOp::kMessage) return nullptr;
  const std::optional<McapMessage> message = parse_message(record.content);
  const auto wanted = message ? is_wanted_.find(message->channel_id) : is_wanted_.end();
  if (wanted == is_wanted_.end()) {
    ++damage_.orphans;
    blame("a message of a channel that nothing declared");
    return nullptr;
  }
  if (!wanted->second) return nullptr;
  message_ = *message;
  return &message_;
}

void McapReader::open_chunk(const Record& record) {
  chunk_ = {};
  chunk_at_ = 0;
  const auto give_up = [this](const char* reason) {
    ++damage_.chunks;
    blame(reason);
  };
  const std::optional<McapChunk> chunk = parse_chunk(record.content);
  if (!chunk) return give_up("the head of a chunk is damaged");
  if (chunk->uncompressed_bytes > kMostChunkBytes) return give_up("a chunk says that it is larger than 1 GiB");
  Decompressed records = decompress(chunk->compression, chunk->records, chunk->uncompressed_bytes);
  const bool is_cut = !chunk->is_whole || !records.whole || records.bytes.size() != chunk->uncompressed_bytes;
  if (is_cut && chunk->is_whole) return give_up("a chunk cannot be decompressed");
  if (is_cut) give_up("a chunk breaks off: its whole messages are used");
  if (!is_cut && chunk->crc != 0 && crc32_of(records.bytes) != chunk->crc) return give_up("the checksum of a chunk is wrong");
  chunk_ = std::move(records);
}

/// Of a chunk that breaks off, what is there: uncompressed records are the file's next ones. False: it has to be searched behind.
bool McapReader::enter(const Record& record) {
  const std::optional<McapChunk> chunk = parse_chunk(record.content);
  if (chunk && chunk->compression == Compression::kNone) {
    ++damage_.chunks;
    at_ += kMcapRecordHead + static_cast<std::size_t>(chunk->records.data() - record.content.data());
    return true;
  }
  open_chunk(record);
  return false;
}

/// A record that cannot have come about by chance: a whole chunk, or a message of a known channel with a record behind it.
bool McapReader::looks_whole(std::size_t at) const {
  const auto op = static_cast<McapOp>(file_[at]);
  if (op != McapOp::kChunk && op != McapOp::kMessage) return false;
  const std::optional<Record> record = record_at(file_, at);
  if (!record || !record->is_whole) return false;
  if (op == McapOp::kChunk) {
    const std::optional<McapChunk> chunk = parse_chunk(record->content);
    return chunk && chunk->is_whole && chunk->records.data() + chunk->records.size() == record->content.data() + record->content.size();
  }
  const std::optional<McapMessage> message = parse_message(record->content);
  const std::optional<Record> after = record_at(file_, at + kMcapRecordHead + record->content.size());
  return message && channels_.contains(message->channel_id) && after && after->is_whole && after->op >= McapOp::kHeader &&
         after->op <= McapOp::kDataEnd;
}

/// To the next record that looks whole, or the end.
void McapReader::search() {
  const std::size_t from = at_++;
  while (at_ < file_.size() && !looks_whole(at_)) ++at_;
  damage_.unreadable_bytes += at_ - from;
}

void McapReader::blame(const char* reason) {
  if (damage_.first_reason != nullptr) return;
  damage_.first_at = record_at_;
  damage_.first_reason = reason;
}

McapContents read_contents(std::span<const std::uint8_t> file) {
  McapContents contents;
  visit_records(summary_of(file), [&](McapOp op, std::span<const std::uint8_t> content) {
    if (op == McapOp::kSchema) {
      if (auto schema = parse_schema(content)) contents.schemas.emplace(schema->id, *schema);
    } else if (op == McapOp::kChannel) {
      if (auto channel = parse_channel(content)) contents.channels.emplace(channel->id, *channel);
    } else if (op == McapOp::kStatistics) {
      if (auto counts = parse_statistics(content)) contents.messages = *counts;
    }
    return true;
  });
  contents.has_summary = !contents.channels.empty() && !contents.messages.empty();
  if (contents.has_summary) return contents;
  McapReader reader{file};
  contents.messages.clear();
  while (const McapMessage* message = reader.next()) ++contents.messages[message->channel_id];
  contents.schemas = reader.schemas();
  contents.channels = reader.channels();
  return contents;
}

std::optional<McapAttachment> find_attachment(std::span<const std::uint8_t> file, const std::string& name) {
  std::optional<McapAttachment> found;
  if (!McapReader::is_mcap(file)) return found;
  visit_records(file.subspan(kMcapMagic.size()), [&](McapOp op, std::span<const std::uint8_t> content) {
    if (op == McapOp::kAttachment) found = parse_attachment(content);
    if (found && found->name != name) found.reset();
    return !found && op != McapOp::kChunk && op != McapOp::kDataEnd;
  });
  return found;
}

std::optional<McapMetadata> find_metadata(std::span<const std::uint8_t> file, const std::string& name) {
  std::optional<McapMetadata> found;
  if (!McapReader::is_mcap(file)) return found;
  visit_records(file.subspan(kMcapMagic.size()), [&](McapOp op, std::span<const std::uint8_t> content) {
    if (op == McapOp::kMetadata) found = parse_metadata(content);
    if (found && found->name != name) found.reset();
    return !found && op != McapOp::kChunk && op != McapOp::kDataEnd;
  });
  return found;
}

}  // namespace slamd
