#include "tools/slamctl/commands.hpp"

#include <unistd.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <thread>

#include "daemon/server/protocol/protocol.hpp"
#include "tools/slamctl/daemon_findings.hpp"
#include "tools/slamctl/metrics.hpp"
#include "tools/slamctl/text.hpp"
#include "tools/slamctl/top.hpp"

namespace slamd::slamctl {
namespace {

using nlohmann::json;
namespace method = protocol::method;

/// A line on stderr that is written over; nothing where stderr is no terminal.
class ProgressLine {
 public:
  explicit ProgressLine(bool wanted) : wanted_{wanted && ::isatty(STDERR_FILENO) == 1} {}
  ~ProgressLine() {
    if (wanted_) std::fputs("\r\033[K", stderr);
  }
  ProgressLine(const ProgressLine&) = delete;
  ProgressLine& operator=(const ProgressLine&) = delete;

  void show(const std::string& what, double share) const {
    constexpr int kWidth = 30;
    if (!wanted_) return;
    const std::string bar(static_cast<std::size_t>(share * kWidth), '#');
    std::fprintf(stderr, "\r\033[K%-8s [%-*s] %3.0f %%", what.c_str(), kWidth, bar.c_str(), share * 100.0);
  }

 private:
  bool wanted_;
};

int print_saved(const Options& options, json result, const std::string& what) {
  result.erase(protocol::kFdField);
  result["file"] = options.file;
  std::cout << (options.json ? result.dump() : options.file + ": " + what) << '\n';
  return kOk;
}

void copy_to_file(const client::Answer& answer, const Options& options, const ProgressLine& progress) {
  const double total = std::max(1.0, answer.result.value("bytes", 1.0));
  client::save_fd(answer.fd.get(), options.file, [&](std::size_t bytes) {
    progress.show("saving", std::min(1.0, static_cast<double>(bytes) / total));
  });
}

/// What the daemon says of itself, or that it says nothing.
doctor::Findings ask_daemon(const Options& options) {
  try {
    return daemon_findings(connect(options).call(method::kGetStatus).result);
  } catch (const client::ClientError& error) {
    return {{doctor::Verdict::kWrong, "daemon", error.what(),
             "systemctl start slamd; journalctl -u slamd says why it ended; adduser USER slamd permits to ask it"}};
  }
}

}  // namespace

client::Connection connect(const Options& options) {
  return client::Connection{options.socket_path,
                            std::chrono::milliseconds{static_cast<std::int64_t>(options.timeout_s * 1e3)}};
}

int show_status(client::Connection& daemon, const Options& options) {
  const char* const begin = options.watch && !options.json && ::isatty(STDOUT_FILENO) == 1 ? "\033[H\033[2J" : "";
  for (std::uint64_t shown = 1;; ++shown) {
    const json status = daemon.call(method::kGetStatus).result;
    std::cout << begin << (options.json ? status.dump() + '\n' : status_text(status)) << std::flush;
    const bool is_last = !options.watch || shown == options.count || !std::cout;
    if (is_last) return status.at("pose").at("status") == "TRACKING" ? kOk : kNotTracking;
    std::this_thread::sleep_for(std::chrono::duration<double>{options.interval_s});
  }
}

int show_metrics(client::Connection& daemon, const Options&) {
  std::cout << metrics_text(daemon.call(method::kGetStatus).result);
  return kOk;
}

int show_top(client::Connection& daemon, const Options& options) {
  const char* const begin = ::isatty(STDOUT_FILENO) == 1 && !options.once ? "\033[H\033[2J" : "";
  json before = daemon.call(method::kGetStatus).result;
  do {
    std::this_thread::sleep_for(std::chrono::duration<double>{options.interval_s});
    json status = daemon.call(method::kGetStatus).result;
    const json figures = top_figures(before, status);
    if (options.json) {
      std::cout << json{{"status", status}, {"figures", figures}}.dump() << std::endl;
    } else {
      std::cout << begin << top_text(status, figures) << std::endl;
    }
    before = std::move(status);
  } while (!options.once && std::cout);
  return kOk;
}

int show_pose(client::Connection& daemon, const Options& options) {
  const auto print = [&options](const json& pose) {
    std::cout << (options.json ? pose.dump() : pose_text(pose)) << std::endl;
  };
  if (!options.follow) {
    print(daemon.call(method::kGetPose).result);
    return kOk;
  }
  daemon.subscribe("pose", options.rate_hz);
  for (std::uint64_t shown = 0; options.count == 0 || shown < options.count;) {
    const client::Notification notification = daemon.next();
    if (notification.topic != protocol::notification::kPose) continue;
    print(notification.params);
    if (!std::cout) return kOk;  // whoever read us has gone
    ++shown;
  }
  return kOk;
}

int inject(client::Connection& daemon, const Options& options) {
  const std::string sensor = options.sensor == "gps" ? "gnss" : options.sensor;
  const json played =
      daemon.call(method::kInject, {{"sensor", sensor}, {"verb", options.verb}, {"for_s", options.for_s}}).result;
  std::cout << (options.json ? played.dump() : options.sensor + " " + options.verb) << '\n';
  return kOk;
}

int save_map(client::Connection& daemon, const Options& options) {
  json params = {{"voxel_size_m", options.voxel_size_m},
                 {"format", options.file.ends_with(".ply") ? "ply" : "pcd"},
                 {"progress", true}};
  if (!options.box.empty()) {
    const auto& b = options.box;
    params["box"] = {{"min_m", {b[0], b[1], b[2]}}, {"max_m", {b[3], b[4], b[5]}}};
  }
  const ProgressLine progress{!options.json};
  progress.show("placing", 0.0);
  const client::Answer answer = daemon.call(method::kGetMap, params, [&progress](const json& told) {
    progress.show(told.value("stage", ""), told.value("share", 0.0));
  });
  copy_to_file(answer, options, progress);
  return print_saved(options, answer.result, std::to_string(answer.result.value("points", 0)) + " points");
}

/// The picture, and beside it the YAML that map_server reads first.
int save_grid(client::Connection& daemon, const Options& options) {
  const std::filesystem::path picture{options.file};
  const ProgressLine progress{!options.json};
  client::Answer answer = daemon.call(method::kGetGrid, {{"format", "pgm"}, {"name", picture.filename().string()}});
  const std::string yaml = std::filesystem::path{picture}.replace_extension(".yaml").string();
  std::ofstream text{yaml};
  text << answer.result.at("yaml").get<std::string>() << std::flush;
  if (!text) throw client::ClientError{client::ClientError::kSystem, yaml + ": cannot be written"};
  copy_to_file(answer, options, progress);
  answer.result.erase("yaml");
  answer.result["yaml_file"] = yaml;
  const auto cells = [&](const char* side) { return std::to_string(answer.result.at(side).get<int>()); };
  return print_saved(options, answer.result, cells("width") + " x " + cells("height") + " squares, " + yaml);
}

int save_trajectory(client::Connection& daemon, const Options& options) {
  const ProgressLine progress{!options.json};
  const client::Answer answer = daemon.call(method::kGetTrajectory, {{"format", "tum"}});
  copy_to_file(answer, options, progress);
  return print_saved(options, answer.result, std::to_string(answer.result.value("poses", 0)) + " poses");
}

int dump(client::Connection& daemon, const Options& options) {
  json params = json::object();
  if (!options.file.empty()) params["name"] = options.file;
  const json result = daemon.call(method::kDump, params).result;
  std::cout << (options.json ? result.dump() : result.value("path", "")) << '\n';
  return kOk;
}

int start_recording(client::Connection& daemon, const Options& options) {
  const json params = {{"name", options.file}, {"max_s", options.max_s}, {"max_bytes", options.max_mb * 1e6}};
  const json result = daemon.call(method::kStartRecording, params).result;
  std::cout << (options.json ? result.dump() : result.value("path", "")) << '\n';
  return kOk;
}

int stop_recording(client::Connection& daemon, const Options& options) {
  const json result = daemon.call(method::kStopRecording).result;
  const std::string text = result.value("path", "") + ": " + std::to_string(result.value("messages", std::uint64_t{0})) + " messages, " +
                           std::to_string(result.value("bytes", std::uint64_t{0})) + " bytes";
  std::cout << (options.json ? result.dump() : text) << '\n';
  return kOk;
}

int show_doctor(const Options& options) {
  doctor::Wanted wanted;
  wanted.lidar_address = options.lidar_address;
  doctor::Findings findings = doctor::check_machine_and_daemons(doctor::HostFiles{}, wanted);
  for (doctor::Finding& finding : ask_daemon(options)) findings.push_back(std::move(finding));
  std::cout << (options.json ? findings_json(findings).dump() + '\n' : doctor::text(findings));
  return doctor::all_right(findings) ? kOk : kFailed;
}

}  // namespace slamd::slamctl
