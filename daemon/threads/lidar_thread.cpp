#include "daemon/threads/lidar_thread.hpp"

#include "daemon/threads/rplidar_thread.hpp"
#include "daemon/threads/spinning_lidar_thread.hpp"

namespace slamd {
namespace {

LidarModel model_of(const LidarThreadConfig& config) { return lidar_model(config.model).value_or(LidarModel::kVlp16); }

}  // namespace

Result<std::unique_ptr<LidarThread>> LidarThread::open(const LidarThreadConfig& config, const LidarDecoderConfig& decoder,
                                                       Streams& streams) {
  const LidarModel model = model_of(config);
  if (model == LidarModel::kRplidarA2) return std::unique_ptr<LidarThread>{std::make_unique<RplidarThread>(config, decoder, streams)};
  UdpSourceConfig source{config.bind_address, config.port, config.source_address, config.source_port,
                         config.receive_buffer_bytes};
  Result<UdpSource> packets = UdpSource::open(source);
  if (!packets) return Error{packets.reason()};
  source.port = config.position_port;
  source.source_port = config.position_source_port;
  Result<UdpSource> positions = UdpSource::open(source);
  if (!positions) return Error{positions.reason()};
  return std::unique_ptr<LidarThread>{std::make_unique<SpinningLidarThread>(
      std::move(packets).value(), std::move(positions).value(), SpinningLidar{model, decoder}, streams)};
}

const char* recorded_file(const LidarThreadConfig& config) {
  return model_of(config) == LidarModel::kRplidarA2 ? "rplidar.pcap" : "lidar.pcap";
}

std::string device_name(const LidarThreadConfig& config) {
  if (model_of(config) == LidarModel::kRplidarA2) return config.serial.path;
  return "udp:" + config.bind_address + ":" + std::to_string(config.port);
}

}  // namespace slamd
