#include "tools/slam-replay/bag/db3_bag.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <map>
#include <utility>

#include "drivers/io/host_ns.hpp"
#include "drivers/mcap/compression.hpp"
#include "tools/slam-replay/bag/mapped_file.hpp"

namespace slamd::replay {
namespace {

constexpr std::int64_t kMostMisses = 100'000;  // rows asked for one by one behind a damaged page
constexpr std::size_t kMostMessageBytes = 1U << 30U;
constexpr std::size_t kShortMessage = 256;  // lies on one page
constexpr std::ptrdiff_t kTail = 16;

using Statement = std::unique_ptr<sqlite3_stmt, decltype(&sqlite3_finalize)>;

/// One SQLite file in memory as far as its pages are whole: SQLite reads zeros behind a file's end, not an error.
class Database {
 public:
  explicit Database(const std::string& path) : file_{MappedFile::open(path)} {
    if (!file_ || file_->bytes().size() < kHeadBytes) return;
    const auto bytes = file_->bytes();
    const std::size_t told = static_cast<std::size_t>(bytes[16]) << 8U | bytes[17];
    const std::size_t page = told == 1 ? 65'536 : std::max<std::size_t>(512, told);
    const std::size_t whole = bytes.size() / page * page;
    is_cut_ = whole != bytes.size() || whole / page < big_endian(bytes.subspan(28, 4));
    bytes[18] = bytes[19] = 1;  // a write-ahead log that may lie beside the file is not read
    sqlite3* raw = nullptr;
    sqlite3_open(":memory:", &raw);
    handle_.reset(raw);
    const auto size = static_cast<sqlite3_int64>(whole);
    if (sqlite3_deserialize(raw, "main", bytes.data(), size, size, SQLITE_DESERIALIZE_READONLY) != SQLITE_OK) handle_.reset();
    sqlite3_exec(raw, "PRAGMA writable_schema=ON", nullptr, nullptr, nullptr);  // lets a file that breaks off be read
    sqlite3_exec(raw, "PRAGMA cell_size_check=ON", nullptr, nullptr, nullptr);
  }

  sqlite3* get() const { return handle_.get(); }
  /// The file is shorter than it says.
  bool is_cut() const { return is_cut_; }

 private:
  static constexpr std::size_t kHeadBytes = 100;
  static std::size_t big_endian(std::span<const std::uint8_t> bytes) {
    std::size_t value = 0;
    for (const std::uint8_t byte : bytes) value = value << 8U | byte;
    return value;
  }

  std::optional<MappedFile> file_;
  std::unique_ptr<sqlite3, decltype(&sqlite3_close)> handle_{nullptr, &sqlite3_close};
  bool is_cut_ = false;
};

Statement prepare(sqlite3* database, const char* sql) {
  sqlite3_stmt* raw = nullptr;
  sqlite3_prepare_v2(database, sql, -1, &raw, nullptr);
  return {raw, &sqlite3_finalize};
}

std::string text_at(sqlite3_stmt* row, int column) {
  const auto* text = sqlite3_column_text(row, column);
  return text == nullptr ? std::string{} : std::string{reinterpret_cast<const char*>(text)};
}

bool is_zstd(std::span<const std::uint8_t> bytes) {
  return bytes.size() > 4 && bytes[0] == 0x28 && bytes[1] == 0xB5 && bytes[2] == 0x2F && bytes[3] == 0xFD;
}

/// The rows of one topic in one file, by their number, so that a damaged page costs only what lies on it.
class Rows {
 public:
  Rows(const std::string& path, std::int64_t topic_id)
      : path_{path}, database_{path}, range_{prepare(database_.get(), "SELECT id, timestamp, data FROM messages WHERE id > ?1 AND topic_id = ?2 ORDER BY id")},
        single_{prepare(database_.get(), "SELECT id, timestamp, data FROM messages WHERE id = ?1 AND topic_id = ?2")}, topic_id_{topic_id} {
    begin(range_.get(), 0);
  }

  /// Null at the end.
  sqlite3_stmt* next() {
    while (range_ && !ended_) {
      const int answer = sqlite3_step(range_.get());
      if (answer == SQLITE_ROW) return note(range_.get());
      if (answer == SQLITE_DONE) break;
      damage(answer);
      if (sqlite3_stmt* row = behind_damage()) return row;
    }
    ended_ = true;
    return nullptr;
  }

  bool is_cut() const { return database_.is_cut(); }
  const BagDamage& found() const { return damage_; }
  void damage(int answer) {
    ++damage_.places;
    if (damage_.first.empty()) damage_.first = path_ + ": behind message " + std::to_string(last_id_) + ": " + sqlite3_errstr(answer);
  }

 private:
  sqlite3_stmt* note(sqlite3_stmt* row) {
    last_id_ = sqlite3_column_int64(row, 0);
    return row;
  }

  void begin(sqlite3_stmt* statement, std::int64_t id) {
    if (statement == nullptr) return;
    sqlite3_reset(statement);
    sqlite3_bind_int64(statement, 1, id);
    sqlite3_bind_int64(statement, 2, topic_id_);
  }

  /// The first row that can be read behind the damage, from which the range goes on; null when there is none.
  sqlite3_stmt* behind_damage() {
    if (!single_) return nullptr;
    for (std::int64_t id = last_id_ + 1; id <= last_id_ + kMostMisses; ++id) {
      begin(single_.get(), id);
      if (sqlite3_step(single_.get()) != SQLITE_ROW) continue;
      begin(range_.get(), id);
      return note(single_.get());
    }
    ended_ = true;
    return nullptr;
  }

  std::string path_;
  Database database_;
  Statement range_, single_;
  std::int64_t topic_id_;
  std::int64_t last_id_ = 0;
  BagDamage damage_;
  bool ended_ = false;
};

struct Part {
  std::string path;
  std::int64_t topic_id;
};

class Db3Cursor : public BagCursor {
 public:
  explicit Db3Cursor(std::vector<Part> parts, std::uint64_t messages) : parts_{std::move(parts)}, expected_{messages} {}

  const BagMessage* next() override {
    for (; part_ < parts_.size(); ++part_, rows_.reset()) {
      if (!rows_) rows_ = std::make_unique<Rows>(parts_[part_].path, parts_[part_].topic_id);
      while (sqlite3_stmt* row = rows_->next()) {
        if (take(row)) return &message_;
      }
      add(rows_->found());
    }
    return nullptr;
  }

  BagDamage damage() const override { return damage_; }
  double progress() const override {
    return std::min(1.0, static_cast<double>(given_) / static_cast<double>(std::max<std::uint64_t>(1, expected_)));
  }

 private:
  bool take(sqlite3_stmt* row) {
    const std::int64_t recorded_ns = sqlite3_column_int64(row, 1);
    const auto* blob = static_cast<const std::uint8_t*>(sqlite3_column_blob(row, 2));
    std::span bytes{blob, static_cast<std::size_t>(sqlite3_column_bytes(row, 2))};
    // Where a file breaks off the last page of a long message may be missing, which SQLite reads as zeros.
    const bool has_end = !rows_->is_cut() || bytes.size() < kShortMessage ||
                         std::any_of(bytes.end() - kTail, bytes.end(), [](std::uint8_t byte) { return byte != 0; });
    if (blob == nullptr || !is_host_ns(recorded_ns) || !has_end) {
      rows_->damage(SQLITE_CORRUPT);
      return false;
    }
    if (is_zstd(bytes)) {  // compression_mode MESSAGE
      plain_ = decompress(Compression::kZstd, bytes, kMostMessageBytes);
      if (!plain_.whole) {
        rows_->damage(SQLITE_CORRUPT);
        return false;
      }
      bytes = plain_.bytes;
    }
    message_ = {from_ns<HostTime>(recorded_ns), bytes};
    ++given_;
    return true;
  }

  void add(const BagDamage& more) {
    damage_.places += more.places;
    if (damage_.first.empty()) damage_.first = more.first;
  }

  std::vector<Part> parts_;
  std::uint64_t expected_;
  std::size_t part_ = 0;
  std::unique_ptr<Rows> rows_;
  Decompressed plain_;
  BagMessage message_;
  BagDamage damage_;
  std::uint64_t given_ = 0;
};

class Db3Bag : public Bag {
 public:
  /// Why it cannot be read; empty: it can.
  std::string add(const std::string& path) {
    const Database database{path};
    if (database.get() == nullptr) return path + ": cannot be opened as an SQLite file";
    const Statement rows = prepare(database.get(), "SELECT id, name, type, serialization_format FROM topics");
    if (!rows) return path + ": is no ROS 2 bag: " + sqlite3_errmsg(database.get());
    int answer = SQLITE_ROW;
    while ((answer = sqlite3_step(rows.get())) == SQLITE_ROW) {
      const bool is_cdr = text_at(rows.get(), 3) == "cdr";
      add({text_at(rows.get(), 1), plain_type(text_at(rows.get(), 2)), is_cdr ? std::optional{RosEncoding::kCdr} : std::nullopt, 0},
          {path, sqlite3_column_int64(rows.get(), 0)});
    }
    if (answer != SQLITE_DONE && topics_.empty()) return path + ": its topics cannot be read: " + sqlite3_errstr(answer);
    count(database.get(), path);
    return {};
  }

  const std::vector<Topic>& topics() const override { return topics_; }
  const char* form() const override { return "ROS 2 bag (SQLite)"; }
  std::unique_ptr<BagCursor> read(std::size_t topic) const override {
    return std::make_unique<Db3Cursor>(parts_[topic], topics_[topic].messages);
  }

 private:
  void add(Topic topic, Part part) {
    const auto same = std::find_if(topics_.begin(), topics_.end(), [&](const Topic& t) { return t.name == topic.name && t.type == topic.type; });
    if (same != topics_.end()) return parts_[static_cast<std::size_t>(same - topics_.begin())].push_back(std::move(part));
    topics_.push_back(std::move(topic));
    parts_.push_back({std::move(part)});
  }

  /// As far as a damaged file can be counted.
  void count(sqlite3* database, const std::string& path) {
    const Statement rows = prepare(database, "SELECT topic_id FROM messages");
    std::map<std::int64_t, std::uint64_t> counts;
    while (rows && sqlite3_step(rows.get()) == SQLITE_ROW) ++counts[sqlite3_column_int64(rows.get(), 0)];
    for (std::size_t i = 0; i < topics_.size(); ++i) {
      for (const Part& part : parts_[i]) {
        if (part.path == path) topics_[i].messages += counts[part.topic_id];
      }
    }
  }

  std::vector<Topic> topics_;
  std::vector<std::vector<Part>> parts_;  // of each topic
};

}  // namespace

OpenedBag open_db3(const std::vector<std::string>& paths) {
  auto bag = std::make_unique<Db3Bag>();
  for (const std::string& path : paths) {
    if (std::string fault = bag->add(path); !fault.empty()) return fault;
  }
  return bag;
}

}  // namespace slamd::replay
