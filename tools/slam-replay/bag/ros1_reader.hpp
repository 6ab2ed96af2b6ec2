#pragma once
// Walks a ROS 1 bag from its begin to its end and hands out whole messages, also of a bag that was never closed, breaks off or is
// damaged. Needs no index.

#include <functional>
#include <map>
#include <string>

#include "tools/slam-replay/bag/bag.hpp"
#include "tools/slam-replay/bag/ros1_records.hpp"

namespace slamd::replay {

struct Ros1Connection {
  std::string topic, type;
};

class Ros1Reader {
 public:
  /// file    lives longer than the reader and begins with the magic; path for faults
  /// wanted  connections whose messages are handed out
  Ros1Reader(std::span<const std::uint8_t> file, std::string path, std::function<bool(const Ros1Connection&)> wanted);

  /// The next wanted message, valid until the next call; null at the end.
  const BagMessage* next();

  /// Of the message handed out last.
  std::uint32_t connection() const { return connection_; }
  /// Those met so far.
  const std::map<std::uint32_t, Ros1Connection>& connections() const { return connections_; }
  const BagDamage& damage() const { return damage_; }
  /// In the file, where it will go on.
  std::size_t position() const { return at_; }

 private:
  const BagMessage* next_of_chunk();
  const BagMessage* take(const Ros1Record& record);
  void open_chunk(const Ros1Record& record);
  bool enter(const Ros1Record& record);
  void search();
  void blame(const char* reason);

  std::span<const std::uint8_t> file_;
  std::string path_;
  std::function<bool(const Ros1Connection&)> wanted_;
  std::size_t at_ = kRos1Magic.size();
  std::size_t record_at_ = 0;  // of the record in work
  Decompressed chunk_;
  std::size_t chunk_at_ = 0;
  std::map<std::uint32_t, Ros1Connection> connections_;
  std::map<std::uint32_t, bool> is_wanted_;
  std::uint32_t connection_ = 0;
  BagMessage message_;
  BagDamage damage_;
};

}  // namespace slamd::replay
