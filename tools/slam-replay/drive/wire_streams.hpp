#pragma once
// Recorded bytes of a device through the driver's own parser: what comes out is what came out live, to the last bit. It is not
// for tables of values: those are in table_streams.hpp.

#include <deque>
#include <memory>
#include <utility>

#include "drivers/gnss/nmea_parser.hpp"
#include "drivers/imu/imu_frame_parser.hpp"
#include "drivers/lidar/spinning_lidar.hpp"
#include "drivers/robosense/airy_imu_parser.hpp"
#include "drivers/rplidar/rplidar_parser.hpp"
#include "drivers/wheel/wheel_parser.hpp"
#include "tools/slam-replay/drive/read_source.hpp"
#include "tools/slam-replay/drive/sensors.hpp"

namespace slamd::replay {

/// What the parsers say of themselves, as a stream says it.
void tell(const ImuFrameParser& parser, StreamReport& report);
void tell(const NmeaParser& parser, StreamReport& report);
void tell(const RplidarParser& parser, StreamReport& report);
void tell(const AiryImuParser& parser, StreamReport& report);
void tell(const WheelParser& parser, StreamReport& report);

/// A serial port, or datagrams that each are a read. Parser: one with feed(bytes, arrival, sink) and a tell() above. Item: what it makes.
template <class Parser, class Item>
class WireStream : public Stream<Item> {
 public:
  WireStream(std::unique_ptr<ReadSource> reads, const typename Parser::Config& config) : reads_{std::move(reads)}, parser_{config} {}

  const Item* next() override {
    if (!items_.empty()) items_.pop_front();
    while (items_.empty()) {
      const UdpPacket* read = reads_->next();
      if (read == nullptr) return nullptr;
      parser_.feed(read->payload, read->arrival, [this](const Item& item) { items_.push_back(item); });
    }
    ++given_;
    return &items_.front();
  }

  StreamReport report() const override {
    StreamReport report;
    report.items = given_;
    tell(parser_, report);
    reads_->tell(report);
    return report;
  }
  double progress() const override { return reads_->progress(); }

 private:
  std::unique_ptr<ReadSource> reads_;
  Parser parser_;
  std::deque<Item> items_;  // the front one has been handed out
  std::uint64_t given_ = 0;
};

using ImuWireStream = WireStream<ImuFrameParser, ImuSample>;
using GnssWireStream = WireStream<NmeaParser, GnssFix>;
using WheelWireStream = WireStream<WheelParser, WheelOdometry>;
using RplidarWireStream = WireStream<RplidarParser, LaserScan>;
using AiryImuStream = WireStream<AiryImuParser, ImuSample>;

/// Datagrams of a spinning LiDAR.
class SpinningStream : public Stream<LidarPacket> {
 public:
  /// Datagrams to other ports than the setup's are left alone; those without a port are data packets.
  SpinningStream(std::unique_ptr<ReadSource> reads, const LidarSetup& setup)
      : reads_{std::move(reads)}, lidar_{setup.model, setup.decoder}, ports_{setup.ports} {}

  const LidarPacket* next() override;
  StreamReport report() const override;
  double progress() const override { return reads_->progress(); }

 private:
  std::unique_ptr<ReadSource> reads_;
  SpinningLidar lidar_;
  LidarPorts ports_;
};

}  // namespace slamd::replay
