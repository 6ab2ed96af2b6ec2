#pragma once
// One topic of a bag as whole messages of one type, with the count of those that are none. Makes no items of them.

#include <memory>
#include <optional>
#include <string>
#include <utility>

#include "drivers/ros/messages.hpp"
#include "tools/slam-replay/bag/bag.hpp"
#include "tools/slam-replay/bag/topic_clock.hpp"
#include "tools/slam-replay/drive/stream.hpp"

namespace slamd::replay {

/// A topic opened for reading, and how its times are to be read.
struct TopicSource {
  std::unique_ptr<BagCursor> cursor;
  RosEncoding encoding = RosEncoding::kCdr;
  TopicClock clock;
  std::string sensor;  // group of its rejections: "lidar", "imu", ...
};

template <class Message>
class TopicReader {
 public:
  explicit TopicReader(TopicSource source) : source_{std::move(source)} {}

  /// The next message that is one; null at the end. What it borrows lives until the next call.
  const Message* next() {
    while (const BagMessage* found = source_.cursor->next()) {
      recorded_ = found->recorded;
      message_ = read_message<Message>(found->bytes, source_.encoding);
      if (message_) return &*message_;
      ++unreadable_;
    }
    return nullptr;
  }

  /// Of a stamp in the newest message.
  HostTime time(std::int64_t stamp_ns) const { return source_.clock.time(stamp_ns, recorded_); }
  double progress() const { return source_.cursor->progress(); }

  void tell(StreamReport& report) const {
    const BagDamage damage = source_.cursor->damage();
    report.rejections.push_back({source_.sensor, "unreadable_messages", unreadable_});
    report.rejections.push_back({source_.sensor, "damaged_places", damage.places});
    report.rejections.push_back({source_.sensor, "damaged_bytes", damage.bytes});
    report.complaint = damage.first;
  }

 private:
  TopicSource source_;
  std::optional<Message> message_;
  HostTime recorded_;
  std::uint64_t unreadable_ = 0;
};

}  // namespace slamd::replay
