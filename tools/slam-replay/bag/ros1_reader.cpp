#include "tools/slam-replay/bag/ros1_reader.hpp"

#include <utility>

#include "drivers/io/host_ns.hpp"

namespace slamd::replay {

Ros1Reader::Ros1Reader(std::span<const std::uint8_t> file, std::string path, std::function<bool(const Ros1Connection&)> wanted)
    : file_{file}, path_{std::move(path)}, wanted_{std::move(wanted)} {
  // A damaged record within a chunk then costs no connection.
  visit_ros1_index(file_, [this](const Ros1Record& record) {
    if (record.op == Ros1Op::kConnection) take(record);
  });
}

const BagMessage* Ros1Reader::next() {
  while (true) {
    if (const BagMessage* message = next_of_chunk()) return message;
    if (at_ >= file_.size()) return nullptr;
    record_at_ = at_;
    const std::optional<Ros1Record> record = parse_ros1_record(file_.subspan(at_));
    if (!record || !record->is_whole) {
      blame("a record breaks off or is damaged");
      if (!record || record->op != Ros1Op::kChunk || !enter(*record)) search();
      continue;
    }
    at_ += record->bytes;
    if (const BagMessage* message = take(*record)) return message;
  }
}

const BagMessage* Ros1Reader::next_of_chunk() {
  while (chunk_at_ < chunk_.bytes.size()) {
    const std::optional<Ros1Record> record = parse_ros1_record(std::span{chunk_.bytes}.subspan(chunk_at_));
    if (!record || !record->is_whole || record->op == Ros1Op::kChunk) {
      if (chunk_.whole) blame("a record in a chunk is damaged: the rest of the chunk is left out");
      chunk_at_ = chunk_.bytes.size();
      break;
    }
    chunk_at_ += record->bytes;
    if (const BagMessage* message = take(*record)) return message;
  }
  return nullptr;
}

const BagMessage* Ros1Reader::take(const Ros1Record& record) {
  if (record.op == Ros1Op::kChunk) open_chunk(record);
  if (record.op == Ros1Op::kConnection) {
    const Ros1Connection connection{std::string{record.topic}, std::string{ros1_field(record.body, "type").value_or("")}};
    is_wanted_.emplace(record.connection, wanted_(connection));
    connections_.emplace(record.connection, connection);
  }
  if (record.op != Ros1Op::kMessage) return nullptr;
  const auto wanted = is_wanted_.find(record.connection);
  if (wanted == is_wanted_.end() || !is_host_ns(record.time_ns)) {
    blame("a message of a connection that nothing declared, or without a time");
    return nullptr;
  }
  if (!wanted->second) return nullptr;
  connection_ = record.connection;
  message_ = {from_ns<HostTime>(record.time_ns), record.body};
  return &message_;
}

void Ros1Reader::open_chunk(const Ros1Record& record) {
  chunk_ = {};
  chunk_at_ = 0;
  if (!record.compression) return blame("a chunk is compressed in an unknown way");
  chunk_ = decompress(*record.compression, record.body, record.chunk_bytes);
  if (record.is_whole && (!chunk_.whole || chunk_.bytes.size() != record.chunk_bytes)) {
    blame("a chunk cannot be decompressed to its end: its whole messages are used");
    chunk_.whole = false;
  }
}

/// Of a chunk that breaks off, what is there: uncompressed records are the file's next ones. False: it has to be searched behind.
bool Ros1Reader::enter(const Ros1Record& record) {
  if (record.compression == Compression::kNone) {
    at_ += record.bytes - record.body.size();
    return true;
  }
  open_chunk(record);
  return false;
}

/// To the next chunk or connection that looks whole, or the end.
void Ros1Reader::search() {
  const std::size_t from = at_++;
  for (; at_ < file_.size(); ++at_) {
    const std::optional<Ros1Record> record = parse_ros1_record(file_.subspan(at_));
    if (record && record->is_whole && (record->op == Ros1Op::kChunk || record->op == Ros1Op::kConnection)) break;
  }
  damage_.bytes += at_ - from;
}

void Ros1Reader::blame(const char* reason) {
  ++damage_.places;
  if (damage_.first.empty()) damage_.first = fault_at(path_, record_at_, reason);
}

}  // namespace slamd::replay
