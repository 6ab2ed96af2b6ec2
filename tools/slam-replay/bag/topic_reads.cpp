#include "tools/slam-replay/bag/topic_reads.hpp"

namespace slamd::replay {
namespace {

/// Unpack: bool operator()(const Message&, TopicReader<Message>&, UdpPacket&), the next read of the message; false: it has no more.
template <class Message, class Unpack>
class TopicReads : public ReadSource {
 public:
  explicit TopicReads(TopicSource topic) : reader_{std::move(topic)} {}

  const UdpPacket* next() override {
    while (message_ == nullptr || !unpack_(*message_, reader_, read_)) {
      message_ = reader_.next();
      if (message_ == nullptr) return nullptr;
      unpack_.begin();
    }
    read_.arrival = order_.next(read_.arrival);
    return &read_;
  }
  void tell(StreamReport& report) const override { reader_.tell(report); }
  double progress() const override { return reader_.progress(); }

 private:
  TopicReader<Message> reader_;
  const Message* message_ = nullptr;
  Unpack unpack_;
  ArrivalOrder order_;
  UdpPacket read_;
};

struct UnpackScan {
  void begin() { next = 0; }
  bool operator()(const VelodyneScanMessage& scan, const TopicReader<VelodyneScanMessage>& topic, UdpPacket& read) {
    if (next == scan.packets.size()) return false;
    const VelodyneScanMessage::Packet& packet = scan.packets[next++];
    read.payload = packet.payload;
    read.arrival = topic.time(packet.stamp_ns);
    return true;
  }
  std::size_t next = 0;
};

struct UnpackSentence {
  void begin() { given = false; }
  bool operator()(const SentenceMessage& message, const TopicReader<SentenceMessage>& topic, UdpPacket& read) {
    if (given) return false;
    given = true;
    line = message.sentence;
    while (line.ends_with('\n') || line.ends_with('\r')) line.pop_back();
    line += "\r\n";
    read.payload = {reinterpret_cast<const std::uint8_t*>(line.data()), line.size()};
    read.arrival = topic.time(message.stamp_ns);
    return true;
  }
  bool given = true;
  std::string line;
};

}  // namespace

std::unique_ptr<ReadSource> velodyne_reads(TopicSource topic) {
  return std::make_unique<TopicReads<VelodyneScanMessage, UnpackScan>>(std::move(topic));
}

std::unique_ptr<ReadSource> sentence_reads(TopicSource topic) {
  return std::make_unique<TopicReads<SentenceMessage, UnpackSentence>>(std::move(topic));
}

}  // namespace slamd::replay
