// Every number that evo gave for the shared trajectories, equal to 1e-6.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tools/slam-eval/alignment.hpp"
#include "tools/slam-eval/association.hpp"
#include "tools/slam-eval/metrics.hpp"

namespace slamd::eval {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

const fs::path kFolder = fs::path(SLAMD_SHARED_DATA) / "evo";
constexpr double kTolerance = 1e-6;

PoseRelation relation_of(const std::string& key) {
  for (const auto r : {PoseRelation::kTranslationPart, PoseRelation::kRotationAngleDeg, PoseRelation::kFullTransformation}) {
    if (key.find(name(r)) != std::string::npos) return r;
  }
  throw std::runtime_error("unknown pose relation in " + key);
}

// "translation_part/delta=10.0 meters/all_pairs=True"
RpeOptions rpe_options_of(const std::string& key) {
  RpeOptions options;
  options.delta = std::stod(key.substr(key.find("delta=") + 6));
  options.unit = key.find("meters") != std::string::npos ? DeltaUnit::kMetres : DeltaUnit::kFrames;
  options.all_pairs = key.ends_with("True");
  return options;
}

void expect_equal(const Statistics& ours, const json& evo, const std::string& where) {
  SCOPED_TRACE(where);
  EXPECT_NEAR(ours.rmse, evo.at("rmse").get<double>(), kTolerance);
  EXPECT_NEAR(ours.mean, evo.at("mean").get<double>(), kTolerance);
  EXPECT_NEAR(ours.median, evo.at("median").get<double>(), kTolerance);
  EXPECT_NEAR(ours.std, evo.at("std").get<double>(), kTolerance);
  EXPECT_NEAR(ours.min, evo.at("min").get<double>(), kTolerance);
  EXPECT_NEAR(ours.max, evo.at("max").get<double>(), kTolerance);
  EXPECT_NEAR(ours.sse, evo.at("sse").get<double>(), kTolerance);
}

class EvoNumbers : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!fs::exists(kFolder / "expected.json")) GTEST_SKIP() << "shared data is absent: " << kFolder;
    expected_ = json::parse(std::ifstream(kFolder / "expected.json")).at(GetParam());
    const auto load = [&](const char* key) {
      return load_trajectory(kFolder / expected_.at(key).get<std::string>(), TrajectoryFormat::kTum);
    };
    matched_ = associate(load("truth"), load("estimate"), {.max_diff_s = expected_.at("max_diff_s").get<double>()});
  }

  json expected_;
  MatchedPoses matched_;
};

TEST_P(EvoNumbers, match_the_same_poses) { EXPECT_EQ(matched_.truth.size(), expected_.at("matched_poses")); }

TEST_P(EvoNumbers, ape_is_equal_to_1e_6) {
  ASSERT_FALSE(expected_.at("ape").empty());
  for (const auto& [key, evo] : expected_.at("ape").items()) {
    const auto alignment = key.starts_with("none/") ? Alignment::kNone : Alignment::kSe3Umeyama;
    const auto laid_over = aligned(fit(alignment, matched_.truth, matched_.estimate), matched_.estimate);
    expect_equal(statistics(ape(matched_.truth, laid_over, relation_of(key))), evo, key);
  }
}

TEST_P(EvoNumbers, rpe_is_equal_to_1e_6) {
  ASSERT_FALSE(expected_.at("rpe").empty());
  for (const auto& [key, evo] : expected_.at("rpe").items()) {
    const auto pairs = pose_pairs(matched_.estimate, rpe_options_of(key));
    if (evo.contains("error")) {
      EXPECT_TRUE(pairs.empty()) << key;
      continue;
    }
    EXPECT_EQ(pairs.size(), evo.at("pairs")) << key;
    expect_equal(statistics(rpe(matched_.truth, matched_.estimate, pairs, relation_of(key))), evo, key);
  }
}

INSTANTIATE_TEST_SUITE_P(Drives, EvoNumbers, testing::Values("drive_a", "drive_b", "short"));

}  // namespace
}  // namespace slamd::eval
