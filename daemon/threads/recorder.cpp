#include "daemon/threads/recorder.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <utility>

#include "daemon/threads/pause.hpp"

namespace slamd {
namespace {

constexpr Duration kPollPeriod = std::chrono::milliseconds{20};

bool write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file{path};
  file << text;
  return file.flush().good();
}

}  // namespace

void WireTap::take(const UdpPacket& read) {
  for (std::size_t from = 0; from < read.payload.size();) {
    RecordedRead* slot = ring_.claim();
    if (slot == nullptr) return;
    slot->read = read;
    slot->size = std::min(slot->bytes.size(), read.payload.size() - from);
    std::copy_n(read.payload.begin() + static_cast<std::ptrdiff_t>(from), slot->size, slot->bytes.begin());
    from += slot->size;
    ring_.commit();
  }
}

bool WireTap::drain(PcapSink& file) {
  bool any = false;
  for (; RecordedRead* slot = ring_.front(); ring_.pop()) {
    slot->read.payload = {slot->bytes.data(), slot->size};
    file.write(slot->read);
    any = true;
  }
  return any;
}

Result<std::unique_ptr<Recorder>> Recorder::open(const std::string& folder, const std::string& config_yaml) {
  const std::filesystem::path path{folder};
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return Error{"the folder of the recording cannot be made"};
  for (const char* name : {"lidar.pcap", "imu.pcap", "gps.pcap"}) {
    if (std::filesystem::exists(path / name, error)) return Error{"there is a recording in that folder already"};
  }
  Result<PcapSink> lidar = PcapSink::open((path / "lidar.pcap").c_str());
  Result<PcapSink> imu = PcapSink::open((path / "imu.pcap").c_str());
  Result<PcapSink> gnss = PcapSink::open((path / "gps.pcap").c_str());
  std::ofstream shares{path / "scan_shares.csv"};
  shares << std::setprecision(17) << "scan_end_ns,share\n" << std::flush;
  if (!lidar || !imu || !gnss || !shares || !write_text(path / "slamd.yaml", config_yaml)) {
    return Error{"the files of the recording cannot be made"};
  }
  return std::unique_ptr<Recorder>{
      new Recorder{{std::move(lidar).value(), std::move(imu).value(), std::move(gnss).value(), std::move(shares)}}};
}

void Recorder::run(const std::stop_token& stop) {
  while (!stop.stop_requested() && drain()) pause_for(kPollPeriod);
  if (!failed()) drain();
}

bool Recorder::drain_shares() {
  for (; const LimitedScan* scan = limited_.front(); limited_.pop()) {
    files_.shares << to_ns(scan->end) << ',' << scan->share << std::endl;
  }
  return files_.shares.good();
}

/// False when the disk did not take it.
bool Recorder::drain() {
  const auto write = [](WireTap& tap, PcapSink& file) { return !tap.drain(file) || static_cast<bool>(file.flush()); };
  const bool written = write(lidar_, files_.lidar) && write(imu_, files_.imu) && write(gnss_, files_.gnss) &&
                       drain_shares();
  if (!written) failed_.store(true, std::memory_order_relaxed);
  return written;
}

}  // namespace slamd
