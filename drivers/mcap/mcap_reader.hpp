#pragma once
// Walks an MCAP file from its begin to its end and hands out whole messages, also of a file that breaks off or is damaged. Needs no
// index; it interprets no message.

#include <functional>
#include <map>
#include <optional>
#include <string>

#include "drivers/mcap/mcap_records.hpp"
#include "estimator/types/result.hpp"

namespace slamd {

/// What could not be used.
struct McapDamage {
  std::uint64_t unreadable_bytes = 0;  // of the file, where no record could be found
  std::uint64_t chunks = 0;            // damaged or cut off; of the cut ones the whole messages were used
  std::uint64_t orphans = 0;           // messages of a channel that nothing declared
  std::uint64_t first_at = 0;          // in the file, of the first of these,
  const char* first_reason = nullptr;  // and what it was; null: nothing
};

class McapReader {
 public:
  static constexpr std::size_t kMostChunkBytes = 1U << 30U;  // uncompressed; larger ones are damage

  /// Whether these bytes begin like an MCAP file.
  static bool is_mcap(std::span<const std::uint8_t> file);

  /// file    lives longer than the reader; it begins with the magic
  /// wanted  channels whose messages are handed out; without it all
  explicit McapReader(std::span<const std::uint8_t> file, std::function<bool(const McapChannel&)> wanted = {});

  /// The next message in the file's order, valid until the next call; null at the end. A chunk whose checksum is wrong is
  /// left out as a whole.
  const McapMessage* next();

  /// Those met so far.
  const std::map<std::uint16_t, McapChannel>& channels() const { return channels_; }
  const std::map<std::uint16_t, McapSchema>& schemas() const { return schemas_; }
  const McapDamage& damage() const { return damage_; }
  /// In the file, where it will go on.
  std::uint64_t position() const { return at_; }
  /// The data section's end was seen: the writer closed the file.
  bool is_closed() const { return closed_; }

 private:
  /// One record; `content` is cut where the bytes end.
  struct Record {
    McapOp op;
    std::span<const std::uint8_t> content;
    bool is_whole;
  };
  std::optional<Record> record_at(std::span<const std::uint8_t> bytes, std::size_t at) const;
  bool looks_whole(std::size_t at) const;
  const McapMessage* next_of_chunk();
  const McapMessage* take(const Record& record);
  void open_chunk(const Record& record);
  bool enter(const Record& record);
  void search();
  void blame(const char* reason);

  std::span<const std::uint8_t> file_;
  std::function<bool(const McapChannel&)> wanted_;
  std::size_t at_ = 0;        // in the file, of the next record
  std::size_t record_at_ = 0; // of the one in work
  Decompressed chunk_;
  std::size_t chunk_at_ = 0;  // in it
  std::map<std::uint16_t, McapSchema> schemas_;
  std::map<std::uint16_t, McapChannel> channels_;
  std::map<std::uint16_t, bool> is_wanted_;
  McapMessage message_;
  McapDamage damage_;
  bool closed_ = false;
};

/// What a file holds, by its summary where that is whole, else by going through it.
struct McapContents {
  std::map<std::uint16_t, McapSchema> schemas;
  std::map<std::uint16_t, McapChannel> channels;
  std::map<std::uint16_t, std::uint64_t> messages;  // by channel
  bool has_summary = false;
};
McapContents read_contents(std::span<const std::uint8_t> file);

/// Of the data section's first records, before any chunk: nothing when it is not there. `bytes` borrows from the file.
std::optional<McapAttachment> find_attachment(std::span<const std::uint8_t> file, const std::string& name);
std::optional<McapMetadata> find_metadata(std::span<const std::uint8_t> file, const std::string& name);

}  // namespace slamd
