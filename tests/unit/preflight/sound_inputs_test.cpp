#include <filesystem>

#include <gtest/gtest.h>

#include "saccade/preflight/preflight.hpp"

namespace saccade {
namespace {

class SlowSoundRecordings : public ::testing::TestWithParam<const char*> {};

TEST_P(SlowSoundRecordings, GetACleanBill) {
  const std::filesystem::path data = SACCADE_TEST_DATA_DIR;
  if (!std::filesystem::exists(data / GetParam())) GTEST_SKIP() << "no " << GetParam();
  const PreflightReport report = preflight((data / GetParam()).string());
  EXPECT_FALSE(report.wouldFail());
  for (const PreflightFinding& finding : report.findings)
    EXPECT_EQ(finding.severity, FindingSeverity::kNote) << finding.text;
  ASSERT_TRUE(report.depth_scale);
  EXPECT_FALSE(report.depth_scale->contradicts);
  EXPECT_NE(report.command.find(GetParam()), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Real, SlowSoundRecordings, ::testing::Values("kitchen", "tum_fr1_rpy"));

TEST(Preflight, EstimatesTheCostAndGivesTheCommandForASimulatedScene) {
  const PreflightReport report = preflight("sim:plain?frames=6");
  ASSERT_TRUE(report.source);
  EXPECT_EQ(report.source->total_frames, 6);
  EXPECT_GT(report.expected_seconds, 0.0);
  EXPECT_GT(report.expected_memory_mib, 0.0);
  EXPECT_EQ(report.command, "saccade explore 'sim:plain?frames=6' -o sim_plain.saccade");
}

}  // namespace
}  // namespace saccade
