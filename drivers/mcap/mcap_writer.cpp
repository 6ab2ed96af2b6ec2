#include "drivers/mcap/mcap_writer.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "drivers/mcap/byte_writer.hpp"

namespace slamd {

Result<McapWriter> McapWriter::open(const std::string& path, const std::string& profile, const std::string& library) {
  std::FILE* const file = std::fopen(path.c_str(), "wbxe");
  if (file == nullptr) return Error{"the file is there already or cannot be made"};
  McapWriter writer{file};
  writer.put(kMcapMagic);
  writer.put(mcap_record(McapOp::kHeader, ByteWriter{}.text(profile).text(library)));
  if (Result<void> written = writer.flush(); !written) return Error{written.reason()};
  return writer;
}

std::uint16_t McapWriter::add_schema(const std::string& name, const std::string& encoding, const std::string& text) {
  close_chunk();
  const Bytes record = mcap_record(McapOp::kSchema, ByteWriter{}.put(++schemas_).text(name).text(encoding).text(text));
  put(record);
  schema_records_.insert(schema_records_.end(), record.begin(), record.end());
  return schemas_;
}

std::uint16_t McapWriter::add_channel(std::uint16_t schema_id, const std::string& topic, const std::string& encoding) {
  close_chunk();
  const std::map<std::string, std::string> no_metadata;
  const std::uint16_t id = channels_++;
  const Bytes record =
      mcap_record(McapOp::kChannel, ByteWriter{}.put(id).put(schema_id).text(topic).text(encoding).text_map(no_metadata));
  put(record);
  channel_records_.insert(channel_records_.end(), record.begin(), record.end());
  return id;
}

void McapWriter::attach(const std::string& name, const std::string& media_type, std::span<const std::uint8_t> bytes,
                        std::uint64_t time_ns) {
  close_chunk();
  ByteWriter content;
  content.put(time_ns).put(time_ns).text(name).text(media_type).put(std::uint64_t{bytes.size()}).raw(bytes);
  content.put(crc32_of(content.bytes()));
  const Bytes record = mcap_record(McapOp::kAttachment, content);
  ByteWriter index;
  index.put(at_).put(std::uint64_t{record.size()}).put(time_ns).put(time_ns).put(std::uint64_t{bytes.size()}).text(name).text(media_type);
  index_records_.emplace_back(McapOp::kAttachmentIndex, mcap_record(McapOp::kAttachmentIndex, index));
  put(record);
}

void McapWriter::add_metadata(const std::string& name, const std::map<std::string, std::string>& values) {
  close_chunk();
  const Bytes record = mcap_record(McapOp::kMetadata, ByteWriter{}.text(name).text_map(values));
  const ByteWriter index = ByteWriter{}.put(at_).put(std::uint64_t{record.size()}).text(name);
  index_records_.emplace_back(McapOp::kMetadataIndex, mcap_record(McapOp::kMetadataIndex, index));
  put(record);
}

void McapWriter::write(std::uint16_t channel_id, std::uint64_t time_ns, std::span<const std::uint8_t> bytes) {
  const bool is_first_here = chunk_.empty();
  begin_ns_ = is_first_here ? time_ns : std::min(begin_ns_, time_ns);
  end_ns_ = is_first_here ? time_ns : std::max(end_ns_, time_ns);
  first_ns_ = messages_ == 0 ? time_ns : std::min(first_ns_, time_ns);
  last_ns_ = std::max(last_ns_, time_ns);
  indices_[channel_id].emplace_back(time_ns, chunk_.size());
  const auto sequence = static_cast<std::uint32_t>(counts_[channel_id]++);
  ++messages_;
  ByteWriter head;
  head.put(static_cast<std::uint8_t>(McapOp::kMessage)).put(std::uint64_t{22 + bytes.size()});
  head.put(channel_id).put(sequence).put(time_ns).put(time_ns);
  chunk_.insert(chunk_.end(), head.bytes().begin(), head.bytes().end());
  chunk_.insert(chunk_.end(), bytes.begin(), bytes.end());
  if (chunk_.size() >= kChunkBytes) close_chunk();
}

void McapWriter::put(std::span<const std::uint8_t> bytes) {
  failed_ = std::fwrite(bytes.data(), 1, bytes.size(), file_.get()) != bytes.size() || failed_;
  at_ += bytes.size();
}

void McapWriter::close_chunk() {
  if (chunk_.empty()) return;
  const Bytes packed = compress_zstd(chunk_);
  ByteWriter content;
  content.put(begin_ns_).put(end_ns_).put(std::uint64_t{chunk_.size()}).put(crc32_of(chunk_)).text("zstd");
  content.put(std::uint64_t{packed.size()}).raw(packed);
  const std::uint64_t chunk_at = at_;
  put(mcap_record(McapOp::kChunk, content));
  const std::uint64_t chunk_bytes = at_ - chunk_at;
  std::map<std::uint16_t, std::uint64_t> offsets;
  const Bytes indices = message_indices(offsets);
  put(indices);
  ByteWriter places;
  for (const auto& [channel, offset] : offsets) places.put(channel).put(offset);
  ByteWriter index;
  index.put(begin_ns_).put(end_ns_).put(chunk_at).put(chunk_bytes).block(places).put(std::uint64_t{indices.size()});
  index.text("zstd").put(std::uint64_t{packed.size()}).put(std::uint64_t{chunk_.size()});
  index_records_.emplace_back(McapOp::kChunkIndex, mcap_record(McapOp::kChunkIndex, index));
  chunk_.clear();
  indices_.clear();
}

/// The records that follow the chunk that ends at at_, and where each will stand.
Bytes McapWriter::message_indices(std::map<std::uint16_t, std::uint64_t>& offsets) const {
  Bytes all;
  for (const auto& [channel, entries] : indices_) {
    ByteWriter times;
    for (const auto& [time_ns, offset] : entries) times.put(time_ns).put(offset);
    offsets[channel] = at_ + all.size();
    const Bytes record = mcap_record(McapOp::kMessageIndex, ByteWriter{}.put(channel).block(times));
    all.insert(all.end(), record.begin(), record.end());
  }
  return all;
}

Result<void> McapWriter::flush() {
  close_chunk();
  failed_ = std::fflush(file_.get()) != 0 || failed_;
  if (failed_) return Error{"the recording cannot be written (disk full?)"};
  return {};
}

Bytes McapWriter::statistics() const {
  const auto count = [this](McapOp op) {
    return static_cast<std::uint32_t>(
        std::count_if(index_records_.begin(), index_records_.end(), [op](const auto& record) { return record.first == op; }));
  };
  ByteWriter counts;
  for (const auto& [channel, messages] : counts_) counts.put(channel).put(messages);
  ByteWriter content;
  content.put(messages_).put(schemas_).put(std::uint32_t{channels_}).put(count(McapOp::kAttachmentIndex));
  content.put(count(McapOp::kMetadataIndex)).put(count(McapOp::kChunkIndex)).put(first_ns_).put(last_ns_).block(counts);
  return mcap_record(McapOp::kStatistics, content);
}

Result<void> McapWriter::finish() {
  close_chunk();
  put(mcap_record(McapOp::kDataEnd, ByteWriter{}.put(std::uint32_t{0})));
  const std::uint64_t summary_at = at_;
  ByteWriter summary, offsets;
  const auto group = [&](McapOp op, const Bytes& records) {
    if (records.empty()) return;
    ByteWriter offset;
    offset.put(static_cast<std::uint8_t>(op)).put(summary_at + summary.bytes().size()).put(std::uint64_t{records.size()});
    offsets.raw(mcap_record(McapOp::kSummaryOffset, offset));
    summary.raw(records);
  };
  group(McapOp::kSchema, schema_records_);
  group(McapOp::kChannel, channel_records_);
  for (const McapOp op : {McapOp::kChunkIndex, McapOp::kAttachmentIndex, McapOp::kMetadataIndex}) {
    ByteWriter records;
    for (const auto& [kind, record] : index_records_) {
      if (kind == op) records.raw(record);
    }
    group(op, records.bytes());
  }
  group(McapOp::kStatistics, statistics());
  const std::uint64_t offsets_at = summary_at + summary.bytes().size();
  summary.raw(offsets.bytes());
  summary.put(static_cast<std::uint8_t>(McapOp::kFooter)).put(std::uint64_t{20}).put(summary_at).put(offsets_at);
  summary.put(crc32_of(summary.bytes()));
  put(summary.bytes());
  put(kMcapMagic);
  return flush();
}

}  // namespace slamd
