#pragma once
// A recording of messages by topic, whatever its container. It interprets no message: bag_sensors.hpp does.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "drivers/ros/message_reader.hpp"
#include "estimator/types/time.hpp"

namespace slamd::replay {

struct Topic {
  std::string name;
  std::string type;  // "sensor_msgs/Imu", also of ROS 2
  std::optional<RosEncoding> encoding;  // nothing: none that can be read here
  std::uint64_t messages = 0;           // as the recording says
};

struct BagMessage {
  HostTime recorded;  // nanoseconds of the recording's own clock
  std::span<const std::uint8_t> bytes;
};

/// What of a recording could not be used.
struct BagDamage {
  std::uint64_t places = 0;     // chunks, records or messages, and
  std::uint64_t bytes = 0;      // bytes of the file, as far as known
  std::string first;            // "FILE: byte N: REASON"; empty: nothing
};

/// The messages of one topic in the order of the recording. One thread.
class BagCursor {
 public:
  virtual ~BagCursor() = default;
  /// Valid until the next call; null at the end.
  virtual const BagMessage* next() = 0;
  virtual BagDamage damage() const = 0;
  /// Share of the recording read so far, 0..1.
  virtual double progress() const = 0;
};

class Bag {
 public:
  virtual ~Bag() = default;
  virtual const std::vector<Topic>& topics() const = 0;
  /// Of topics()[topic]. The cursor keeps alive what it needs.
  virtual std::unique_ptr<BagCursor> read(std::size_t topic) const = 0;
  /// "ROS 1 bag", ...
  virtual const char* form() const = 0;
};

/// A bag, or why there is none: "FILE: [byte N: ]REASON".
using OpenedBag = std::variant<std::unique_ptr<Bag>, std::string>;

/// path  a ROS 1 bag, a ROS 2 bag (.db3, .mcap or their folder) or an MCAP file, by its content and not its name
OpenedBag open_bag(const std::string& path);

/// Whether path looks like one of these: the first bytes of a file, metadata.yaml in a folder.
bool is_bag(const std::string& path);

/// "sensor_msgs/msg/Imu" to "sensor_msgs/Imu".
std::string plain_type(std::string type);

/// "FILE: byte N: REASON".
std::string fault_at(const std::string& path, std::uint64_t byte, const std::string& reason);

}  // namespace slamd::replay
