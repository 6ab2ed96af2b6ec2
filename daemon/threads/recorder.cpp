#include "daemon/threads/recorder.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <nlohmann/json.hpp>
#include <utility>

#include "daemon/server/host_clock.hpp"
#include "daemon/store/file_name.hpp"
#include "daemon/threads/pause.hpp"
#include "daemon/threads/state_directory.hpp"

namespace slamd {
namespace {

constexpr Duration kPollPeriod = std::chrono::milliseconds{20};
constexpr const char* kSharesName = "scan_shares.csv";

bool write_text(const std::filesystem::path& path, const std::string& text) {
  std::ofstream file{path};
  file << text;
  return file.flush().good();
}

std::ofstream begin_shares(const std::string& path) {
  std::ofstream shares{path};
  shares << std::setprecision(17) << "scan_end_ns,share\n" << std::flush;
  return shares;
}

std::ostream& write_share(std::ostream& shares, const LimitedScan& scan) {
  return shares << to_ns(scan.end) << ',' << scan.share << std::endl;
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

std::string FlightRecorderConfig::dump_folder() const {
  if (!folder.empty()) return folder;
  const std::string state = state_directory();
  return state.empty() ? state : state + "/dumps";
}

Recorder::Recorder(const std::string& config_yaml, const FlightRecorderConfig& flight, const char* lidar_file)
    : config_yaml_{config_yaml},
      flight_{flight},
      lidar_{lidar_file, WireTap{4096}, FlightRing{flight.span, flight.byte_budget - 3 * (flight.byte_budget / 32)}, RecordedWire::kLidar, {}},  // tap: 5 s
      imu_{"imu.pcap", WireTap{2048}, FlightRing{flight.span, flight.byte_budget / 32}, RecordedWire::kImu, {}},                           // 10 s
      gnss_{"gps.pcap", WireTap{512}, FlightRing{flight.span, flight.byte_budget / 32}, RecordedWire::kGnss, {}},
      wheel_{"wheel.pcap", WireTap{256}, FlightRing{flight.span, flight.byte_budget / 32}, RecordedWire::kWheel, {}} {}

Result<std::unique_ptr<Recorder>> Recorder::open(const std::string& folder, const std::string& config_yaml,
                                                 const FlightRecorderConfig& flight, const char* lidar_file) {
  std::unique_ptr<Recorder> recorder{new Recorder{config_yaml, flight, lidar_file}};
  const Result<void> recording = folder.empty() || folder.ends_with(".mcap") ? Result<void>{} : recorder->record_to(folder);
  if (!recording) return Error{recording.reason()};
  return recorder;
}

Result<void> Recorder::allow_mcap(std::unique_ptr<McapRecorder> mcap, const std::string& target) {
  mcap_ = std::move(mcap);
  if (!target.ends_with(".mcap")) return {};
  const Result<std::string> begun = mcap_->start_at(target, {});
  return begun ? Result<void>{} : Error{begun.reason()};
}

Result<void> Recorder::record_to(const std::string& folder) {
  const std::filesystem::path path{folder};
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) return Error{"the folder of the recording cannot be made"};
  for (const Wire* wire : wires()) {
    if (std::filesystem::exists(path / wire->file_name, error)) return Error{"there is a recording in that folder already"};
  }
  for (Wire* wire : wires()) {
    Result<PcapSink> file = PcapSink::open((path / wire->file_name).c_str());
    if (!file) return Error{"the files of the recording cannot be made"};
    wire->file.emplace(std::move(file).value());
  }
  shares_ = begin_shares(path / kSharesName);
  if (!*shares_ || !write_text(path / "slamd.yaml", config_yaml_)) return Error{"the files of the recording cannot be made"};
  return {};
}

void Recorder::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    drain();
    if (mcap_) mcap_->settle(host_now());
    take_request();
    pause_for(kPollPeriod);
  }
  drain();
  if (mcap_) mcap_->finish();
  take_request();
}

void Recorder::drain() {
  bool written = true;
  for (Wire* wire : wires()) written = drain(*wire) && written;
  written = drain_shares() && written;
  if (written) return;
  failed_.store(true, std::memory_order_relaxed);
  for (Wire* wire : wires()) wire->file.reset();
  shares_.reset();
}

bool Recorder::drain_shares() {
  bool good = true;
  for (; const LimitedScan* scan = limited_.front(); limited_.pop()) {
    if (shares_) good = static_cast<bool>(write_share(*shares_, *scan));
    if (mcap_) mcap_->take(*scan);
    const std::lock_guard lock{mutex_};
    std::erase_if(kept_shares_, [&](const LimitedScan& kept) { return scan->end - kept.end > flight_.span; });
    kept_shares_.push_back(*scan);
  }
  return good;
}

/// False when the disk did not take it.
bool Recorder::drain(Wire& wire) {
  const bool any = wire.tap.drain([&](const UdpPacket& read) {
    if (wire.file) wire.file->write(read);
    if (mcap_) mcap_->take(wire.wire, read);
    if (flight_.span > Duration{}) wire.kept.add(read);
  });
  return !any || !wire.file || static_cast<bool>(wire.file->flush());
}

void Recorder::request_dump(const std::string& name, const std::string& reason) {
  const std::lock_guard lock{mutex_};
  request_ = Request{name, reason};
}

void Recorder::take_request() {
  std::optional<Request> request;
  {
    const std::lock_guard lock{mutex_};
    request = std::exchange(request_, std::nullopt);
  }
  if (request) static_cast<void>(write_dump(*request, true));
}

Result<std::string> Recorder::dump(const std::string& name, const std::string& reason) {
  return write_dump({name, reason}, false);
}

Result<std::string> Recorder::write_dump(const Request& request, bool draining) {
  const auto fail = [this](const char* reason) {
    failed_dumps_.fetch_add(1, std::memory_order_relaxed);
    return Error{reason};
  };
  const std::filesystem::path folder{flight_.dump_folder()};
  if (folder.empty()) return fail("no folder for dumps is configured (flight_recorder.folder)");
  if (flight_.span == Duration{}) return fail("nothing is kept (flight_recorder.span_s is 0)");
  if (!is_plain_file_name(request.name)) return fail("the name must be a plain file name");
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  const auto here = std::filesystem::directory_iterator{folder, error};
  if (error) return fail("the folder of dumps cannot be made");
  if (std::distance(here, {}) >= flight_.max_dumps) return fail("there are flight_recorder.max_dumps dumps already");
  const std::filesystem::path path = folder / request.name;
  if (!std::filesystem::create_directory(path, error) || error) return fail("there is a dump of that name, or it cannot be made");
  std::filesystem::permissions(path, std::filesystem::perms{0750}, error);
  if (const Result<void> written = write_wires(path, request.reason, draining); !written) return fail(written.reason());
  dumps_.fetch_add(1, std::memory_order_relaxed);
  return path.string();
}

/// draining: on the recorder's thread, whose rings must not overflow while the disk works.
Result<void> Recorder::write_wires(const std::string& folder, const std::string& reason, bool draining) {
  const std::array<FlightRing::Snapshot, 4> kept{lidar_.kept.snapshot(), imu_.kept.snapshot(), gnss_.kept.snapshot(),
                                                 wheel_.kept.snapshot()};
  for (std::size_t i = 0; i < kept.size(); ++i) {
    Result<PcapSink> opened = PcapSink::open((folder + '/' + wires()[i]->file_name).c_str());
    if (!opened) return Error{"the files of the dump cannot be made"};
    PcapSink file = std::move(opened).value();
    for (const auto& chunk : kept[i]) {
      FlightRing::write(*chunk, file);
      if (draining) drain();
    }
    if (!file.flush()) return Error{"the files of the dump cannot be written (disk full?)"};
  }
  std::ofstream shares = begin_shares(folder + '/' + kSharesName);
  {
    const std::lock_guard lock{mutex_};
    for (const LimitedScan& scan : kept_shares_) write_share(shares, scan);
  }
  if (!shares) return Error{"the files of the dump cannot be written (disk full?)"};
  const nlohmann::json about = {{"reason", reason}, {"span_s", to_seconds(flight_.span)}};
  if (!write_text(folder + "/slamd.yaml", config_yaml_) || !write_text(folder + "/dump.json", about.dump() + '\n')) {
    return Error{"the files of the dump cannot be written (disk full?)"};
  }
  return {};
}

std::size_t Recorder::kept_bytes() const { return lidar_.kept.bytes() + imu_.kept.bytes() + gnss_.kept.bytes() + wheel_.kept.bytes(); }

}  // namespace slamd
