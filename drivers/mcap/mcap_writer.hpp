#pragma once
// Writes an MCAP file: chunks compressed by zstd with checksums, message indices and a summary. A file that is never finished has
// every closed chunk whole, and McapReader and other tools' recovery read it. It encodes no message.

#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "drivers/mcap/compression.hpp"
#include "drivers/mcap/mcap_format.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

/// One thread; not for real-time threads: it allocates and writes to the disk.
class McapWriter {
 public:
  static constexpr std::size_t kChunkBytes = 2U << 20U;  // before compression; then a chunk is closed

  /// Makes the file; fails when there is one already or it cannot be made.
  /// profile  "ros2" where every channel is of ROS 2; library  who writes
  [[nodiscard]] static Result<McapWriter> open(const std::string& path, const std::string& profile, const std::string& library);

  // Before the first message: so that they stand in clear at the file's begin.
  std::uint16_t add_schema(const std::string& name, const std::string& encoding, const std::string& text);
  std::uint16_t add_channel(std::uint16_t schema_id, const std::string& topic, const std::string& encoding);
  void attach(const std::string& name, const std::string& media_type, std::span<const std::uint8_t> bytes, std::uint64_t time_ns);
  void add_metadata(const std::string& name, const std::map<std::string, std::string>& values);

  void write(std::uint16_t channel_id, std::uint64_t time_ns, std::span<const std::uint8_t> bytes);
  /// Closes the open chunk and hands everything to the system. Fails when anything so far could not be written (disk full).
  Result<void> flush();
  /// flush(), then the summary; nothing may be written behind it.
  Result<void> finish();

  /// In the file or waiting for it, so far.
  std::uint64_t bytes() const { return at_ + chunk_.size(); }
  std::uint64_t messages() const { return messages_; }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using Entries = std::vector<std::pair<std::uint64_t, std::uint64_t>>;  // time, offset in the chunk

  explicit McapWriter(std::FILE* file) : file_{file} {}
  void put(std::span<const std::uint8_t> bytes);
  void close_chunk();
  Bytes message_indices(std::map<std::uint16_t, std::uint64_t>& offsets) const;
  Bytes statistics() const;

  std::unique_ptr<std::FILE, Closer> file_;
  std::uint64_t at_ = 0;                  // in the file
  bool failed_ = false;
  Bytes chunk_;                           // records of the open one,
  std::map<std::uint16_t, Entries> indices_;  // its messages by channel,
  std::uint64_t begin_ns_ = 0, end_ns_ = 0;   // and their times
  std::uint64_t first_ns_ = 0, last_ns_ = 0;  // of all messages
  std::uint64_t messages_ = 0;
  std::map<std::uint16_t, std::uint64_t> counts_;  // by channel
  Bytes schema_records_, channel_records_;    // whole records, repeated in the summary
  std::vector<std::pair<McapOp, Bytes>> index_records_;  // of the summary: chunks, attachments, metadata
  std::uint16_t schemas_ = 0, channels_ = 0;
};

}  // namespace slamd
