#include "daemon/config/config.hpp"

#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace slamd {
namespace {

std::string read_file(const std::string& path) {
  std::ifstream file{path};
  return {std::istreambuf_iterator<char>{file}, {}};
}

std::string default_text() {
  const Config config;
  return print_config(config);
}

/// The faults of a slamd.yaml with this text, the file's name being "f.yaml".
ConfigFaults faults_of(const std::string& text) {
  Config config;
  return read_yaml_text("f.yaml", text, config_fields(config));
}

void expect_fault(const std::string& text, const std::string& fault) {
  const ConfigFaults faults = faults_of(text);
  ASSERT_EQ(faults.size(), 1U) << text;
  EXPECT_EQ(faults[0], fault);
}

TEST(Config, TheShippedFileIsTheDocumentationOfTheDefaults) {
  EXPECT_EQ(read_file(SLAMD_SOURCE_DIR "/config/slamd.yaml"), default_text());
}

TEST(Config, FilesOfOtherLidarsLoadAndNameTheirModel) {
  const auto airy = load_config(SLAMD_SOURCE_DIR "/config/airy.yaml");
  EXPECT_EQ(airy.faults, ConfigFaults{});
  EXPECT_EQ(airy.value.lidar.model, "airy");
  EXPECT_EQ(airy.value.lidar.port, ports_of(LidarModel::kAiry).points);
  EXPECT_EQ(airy.value.lidar.position_port, ports_of(LidarModel::kAiry).side);
  const auto rplidar = load_config(SLAMD_SOURCE_DIR "/config/rplidar_a2.yaml");
  EXPECT_EQ(rplidar.faults, ConfigFaults{});
  EXPECT_EQ(rplidar.value.lidar.model, "rplidar_a2");
  EXPECT_FALSE(load_config("", {"lidar.model=hdl64"}).faults.empty());
  EXPECT_FALSE(load_config("", {"lidar.model=rplidar_a2"}).faults.empty());
}

TEST(Config, TheShippedFileReadsBackToTheDefaults) {
  const auto loaded = load_config(SLAMD_SOURCE_DIR "/config/slamd.yaml");
  EXPECT_EQ(loaded.faults, ConfigFaults{});
  EXPECT_EQ(print_config(loaded.value), default_text());
}

TEST(Config, EveryKeyHasItsSentenceAndADefaultInsideItsRange) {
  Config config;
  for (const Field& field : config_fields(config)) {
    EXPECT_FALSE(field.doc.empty()) << field.key;
    EXPECT_EQ(read_override(field.key + "=" + value_text(field), {field}), ConfigFaults{});
  }
}

TEST(Config, EveryKeyThatIsChangedPrintsAndReadsBackChanged) {
  Config config;
  for (const Field& field : config_fields(config)) {
    Config changed;
    for (const Field& other : config_fields(changed)) {
      if (other.key != field.key) continue;
      if (auto* slot = std::get_if<double*>(&other.slot)) **slot = (field.range.min + field.range.max) / 3;
      if (auto* slot = std::get_if<bool*>(&other.slot)) **slot = !**slot;
      if (auto* slot = std::get_if<int*>(&other.slot)) **slot = static_cast<int>(field.range.max);
    }
    Config read;
    EXPECT_EQ(read_yaml_text("f", print_config(changed), config_fields(read)), ConfigFaults{}) << field.key;
    EXPECT_EQ(print_config(read), print_config(changed)) << field.key;
  }
}

TEST(Config, AnEmptyFileGivesTheDefaults) {
  EXPECT_EQ(faults_of(""), ConfigFaults{});
  EXPECT_EQ(faults_of("# only a comment\nreal_time:\n"), ConfigFaults{});
}

TEST(Config, FaultsNameFileLineKeyAndReason) {
  expect_fault("\nreal_time:\n  speed: 3\n", "f.yaml:3: real_time.speed: unknown key");
  expect_fault("speling: {a: 1}\n", "f.yaml:1: speling: unknown key");
  expect_fault("real_time:\n  imu_priority: fast\n", "f.yaml:2: real_time.imu_priority: not a whole number: 'fast'");
  expect_fault("real_time:\n  imu_priority: 1.5\n", "f.yaml:2: real_time.imu_priority: not a whole number: '1.5'");
  expect_fault("real_time:\n  imu_priority: 100\n", "f.yaml:2: real_time.imu_priority: must be in 0 .. 99");
  expect_fault("real_time:\n  imu_priority: [1]\n", "f.yaml:2: real_time.imu_priority: must be one value");
  expect_fault("real_time:\n  imu_priority:\n", "f.yaml:2: real_time.imu_priority: must be one value");
  expect_fault("real_time:\n  lock_memory: 1\n", "f.yaml:2: real_time.lock_memory: not true or false: '1'");
  expect_fault("real_time: 3\n", "f.yaml:1: real_time: is a section, not a value");
  expect_fault("vehicle:\n  p_base_antenna: [1, 2]\n", "f.yaml:2: vehicle.p_base_antenna: must be a list of 3 numbers");
  expect_fault("vehicle:\n  p_base_antenna: [1, 2, .nan]\n", "f.yaml:2: vehicle.p_base_antenna: not a number: '.nan'");
  expect_fault("vehicle:\n  p_base_antenna: [1, 2, nan]\n", "f.yaml:2: vehicle.p_base_antenna: not a number: 'nan'");
  expect_fault("vehicle:\n  T_base_imu:\n    rotation_quat_xyzw: [0, 0, 0, 0.9]\n",
               "f.yaml:3: vehicle.T_base_imu.rotation_quat_xyzw: not a unit quaternion [x, y, z, w]");
  expect_fault("real_time: {imu_priority: 1}\nreal_time: {imu_priority: 2}\n", "f.yaml:2: real_time: given twice");
  expect_fault("- 1\n", "f.yaml:1: (top): must be a list of 'key: value' lines");
}

TEST(Config, BadSyntaxIsAFaultWithItsLine) {
  const ConfigFaults faults = faults_of("real_time:\n  imu_priority: [1\n");
  ASSERT_EQ(faults.size(), 1U);
  EXPECT_TRUE(faults[0].starts_with("f.yaml:3: (syntax): ")) << faults[0];
}

TEST(Config, EveryFaultIsReportedNotOnlyTheFirst) {
  EXPECT_EQ(faults_of("a: 1\nb: 2\nreal_time:\n  imu_priority: x\n").size(), 3U);
}

TEST(Config, AFaultyValueLeavesTheDefault) {
  Config config;
  EXPECT_FALSE(read_yaml_text("f", "real_time: {imu_priority: 1000}", config_fields(config)).empty());
  EXPECT_EQ(config.real_time.imu_priority, RealTimeConfig{}.imu_priority);
}

TEST(Config, OverridesWinOverTheFile) {
  const auto loaded = load_config(SLAMD_SOURCE_DIR "/config/slamd.yaml", {"real_time.imu_priority=7"});
  EXPECT_EQ(loaded.faults, ConfigFaults{});
  EXPECT_EQ(loaded.value.real_time.imu_priority, 7);
}

TEST(Config, AWrongOverrideSaysWhich) {
  EXPECT_EQ(load_config("", {"real_time.x=7"}).faults, ConfigFaults{"--set real_time.x=7:1: real_time.x: unknown key"});
  EXPECT_EQ(load_config("", {"imu"}).faults, ConfigFaults{"--set imu:1: (syntax): must be key=value"});
  EXPECT_EQ(load_config("", {"real_time.lock_memory="}).faults.size(), 1U);
  EXPECT_EQ(load_config("", {"real_time.lock_memory=[1"}).faults.size(), 1U);
}

TEST(Config, KeysThatContradictEachOtherAreFaults) {
  EXPECT_EQ(load_config("", {"lidar.min_range_m=50", "lidar.max_range_m=20"}).faults,
            ConfigFaults{"(configuration):0: lidar.min_range_m: must be below lidar.max_range_m"});
  EXPECT_EQ(load_config("", {"lidar.port=8308"}).faults.size(), 1U);
  EXPECT_EQ(load_config("", {"imu.device=/dev/x", "gnss.device=/dev/x"}).faults.size(), 1U);
  EXPECT_EQ(load_config("", {"imu.device=", "gnss.device="}).faults, ConfigFaults{});
}

TEST(Config, AMissingFileIsAFault) {
  const auto loaded = load_config("/nonexistent/slamd.yaml");
  EXPECT_EQ(loaded.faults, ConfigFaults{"/nonexistent/slamd.yaml:0: (file): No such file or directory"});
}

TEST(Config, ChangesAreToldApartByWhatARunningDaemonCanTakeOver) {
  Config running;
  Config wanted;
  EXPECT_TRUE(changes(running, wanted).live.empty());
  EXPECT_TRUE(changes(running, wanted).fixed.empty());
  wanted.server.limits.max_clients = 3;
  wanted.log.repeat_period = std::chrono::seconds{60};
  wanted.lidar.port = 2400;
  const ConfigChanges found = changes(running, wanted);
  EXPECT_EQ(found.live, (std::vector<std::string>{"server.max_clients", "log.repeat_period_s"}));
  EXPECT_EQ(found.fixed, std::vector<std::string>{"lidar.port"});
}

TEST(Config, TheLidarOfADriveFolderIsOneOfFour) {
  const std::string path = testing::TempDir() + "lidar_model_" + std::to_string(::getpid()) + ".yaml";
  std::ofstream{path} << "lidar_model: laser_scan\n";
  EXPECT_EQ(load_drive_vehicle(path).faults, ConfigFaults{});
  EXPECT_EQ(load_drive_vehicle(path).value.lidar_model, "laser_scan");
  std::ofstream{path} << "lidar_model: sonar\n";
  ASSERT_EQ(load_drive_vehicle(path).faults.size(), 1U);
  EXPECT_NE(load_drive_vehicle(path).faults[0].find(path + ":0: lidar_model: must be"), std::string::npos);
  std::filesystem::remove(path);
}

TEST(Config, ADriveFoldersVehicleFileIsRead) {
  const std::string path = SLAMD_SHARED_DATA "/drive_sample/vehicle.yaml";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is absent";
  const auto loaded = load_drive_vehicle(path);
  EXPECT_EQ(loaded.faults, ConfigFaults{});
  EXPECT_FALSE(loaded.value.lidar_vertical_offsets);
  EXPECT_EQ(loaded.value.geometry.p_base_antenna, Eigen::Vector3d(-0.60, 0.35, 1.74));
  EXPECT_NEAR(loaded.value.geometry.T_base_lidar.rotation.y(), 0.095845752520, 1e-12);
  EXPECT_NEAR(loaded.value.geometry.T_base_imu.rotation.w(), 0.699404695268, 1e-12);
}

}  // namespace
}  // namespace slamd
