#pragma once
// The recorded bytes of one serial port, read by read with their stamps, through the driver's parser. It is not for tables:
// those are imu_csv_reader and gps_csv_reader.

#include <deque>
#include <optional>
#include <utility>

#include "drivers/io/pcap_source.hpp"

namespace slamd::replay {

/// Parser: ImuFrameParser or NmeaParser. Item: what it makes.
template <class Parser, class Item>
class WireReader {
 public:
  WireReader(PcapSource reads, const typename Parser::Config& config) : reads_{std::move(reads)}, parser_{config} {}

  /// The next item, or nothing at the end. Exactly those that the driver's thread made of the same reads.
  std::optional<Item> next() {
    while (items_.empty()) {
      const UdpPacket* read = reads_.next();
      if (read == nullptr) return std::nullopt;
      parser_.feed(read->payload, read->arrival, [this](const Item& item) { items_.push_back(item); });
    }
    Item item = items_.front();
    items_.pop_front();
    return item;
  }

  const Parser& parser() const { return parser_; }

 private:
  PcapSource reads_;
  Parser parser_;
  std::deque<Item> items_;
};

}  // namespace slamd::replay
