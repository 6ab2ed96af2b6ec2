#pragma once
// Makes bags for tests: ROS 1 (format 2.0) and ROS 2 (SQLite). Not for MCAP: drivers/mcap writes those.

#include <sqlite3.h>

#include <cstdint>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "drivers/mcap/compression.hpp"

namespace slamd::test {

struct SentMessage {
  std::string topic, type;  // type as the container has it
  std::int64_t time_ns;
  std::vector<std::uint8_t> bytes;
};

/// A ROS 1 bag: messages in chunks of `chunk`, none compressed; closed ones have their index.
class Ros1BagMaker {
 public:
  static std::string make(const std::vector<SentMessage>& messages, std::size_t chunk, bool closed = true) {
    Ros1BagMaker maker;
    std::string body;
    for (std::size_t i = 0; i < messages.size(); i += chunk) body += maker.make_chunk(messages, i, std::min(messages.size(), i + chunk));
    const std::string begin = "#ROSBAG V2.0\n";
    const std::uint64_t index_at = closed ? begin.size() + maker.header(0).size() + body.size() : 0;
    std::string file = begin + maker.header(index_at) + body;
    if (!closed) return file;
    for (const auto& [topic, id] : maker.ids_) file += maker.connection(topic.first, topic.second, id);
    for (const std::string& counts : maker.counts_) file += record("\x06", "", counts);
    return file;
  }

 private:
  template <class Number>
  static std::string le(Number number) { return {reinterpret_cast<const char*>(&number), sizeof number}; }
  static std::string field(const std::string& name, const std::string& value) {
    return le(static_cast<std::uint32_t>(name.size() + 1 + value.size())) + name + "=" + value;
  }
  static std::string record(const std::string& op, const std::string& fields, const std::string& body) {
    const std::string head = field("op", op) + fields;
    return le(static_cast<std::uint32_t>(head.size())) + head + le(static_cast<std::uint32_t>(body.size())) + body;
  }
  std::string header(std::uint64_t index_at) const {
    return record("\x03", field("index_pos", le(index_at)) + field("conn_count", le(std::uint32_t{0})) + field("chunk_count", le(std::uint32_t{0})),
                  std::string(4000, ' '));
  }
  static std::string connection(const std::string& topic, const std::string& type, std::uint32_t id) {
    return record("\x07", field("conn", le(id)) + field("topic", topic), field("topic", topic) + field("type", type) + field("md5sum", "*"));
  }
  std::string make_chunk(const std::vector<SentMessage>& messages, std::size_t begin, std::size_t end) {
    std::string body, counts;
    for (std::size_t i = begin; i < end; ++i) {
      const SentMessage& m = messages[i];
      const auto [known, is_new] = ids_.emplace(std::pair{m.topic, m.type}, static_cast<std::uint32_t>(ids_.size()));
      if (is_new) body += connection(m.topic, m.type, known->second);
      const std::string time = le(static_cast<std::uint32_t>(m.time_ns / 1'000'000'000)) + le(static_cast<std::uint32_t>(m.time_ns % 1'000'000'000));
      body += record("\x02", field("conn", le(known->second)) + field("time", time), {m.bytes.begin(), m.bytes.end()});
      counts += le(known->second) + le(std::uint32_t{1});
    }
    counts_.push_back(counts);
    return record("\x05", field("compression", "none") + field("size", le(static_cast<std::uint32_t>(body.size()))), body);
  }

  std::map<std::pair<std::string, std::string>, std::uint32_t> ids_;
  std::vector<std::string> counts_;
};

/// A ROS 2 bag at `path`. zstd  each message compressed.
inline void make_db3(const std::string& path, const std::vector<SentMessage>& messages, bool zstd = false) {
  sqlite3* db = nullptr;
  sqlite3_open(path.c_str(), &db);
  sqlite3_exec(db,
               "CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT NOT NULL, type TEXT NOT NULL, serialization_format TEXT NOT NULL, "
               "offered_qos_profiles TEXT NOT NULL); CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER NOT NULL, "
               "timestamp INTEGER NOT NULL, data BLOB NOT NULL); BEGIN",
               nullptr, nullptr, nullptr);
  std::map<std::string, int> ids;
  for (const SentMessage& m : messages) {
    const auto [known, is_new] = ids.emplace(m.topic, static_cast<int>(ids.size()) + 1);
    sqlite3_stmt* insert = nullptr;
    if (is_new) {
      const std::string sql = "INSERT INTO topics VALUES(" + std::to_string(known->second) + ",'" + m.topic + "','" + m.type + "','cdr','')";
      sqlite3_exec(db, sql.c_str(), nullptr, nullptr, nullptr);
    }
    const std::vector<std::uint8_t> bytes = zstd ? compress_zstd(m.bytes) : m.bytes;
    sqlite3_prepare_v2(db, "INSERT INTO messages(topic_id, timestamp, data) VALUES(?1, ?2, ?3)", -1, &insert, nullptr);
    sqlite3_bind_int(insert, 1, known->second);
    sqlite3_bind_int64(insert, 2, m.time_ns);
    sqlite3_bind_blob(insert, 3, bytes.data(), static_cast<int>(bytes.size()), SQLITE_STATIC);
    sqlite3_step(insert);
    sqlite3_finalize(insert);
  }
  sqlite3_exec(db, "COMMIT", nullptr, nullptr, nullptr);
  sqlite3_close(db);
}

inline void write_file(const std::string& path, const std::string& content) {
  std::ofstream{path, std::ios::binary}.write(content.data(), static_cast<std::streamsize>(content.size()));
}

}  // namespace slamd::test
