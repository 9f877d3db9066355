#include <fstream>

#include <gtest/gtest.h>
#include <opencv2/core.hpp>

#include "saccade/preflight/preflight.hpp"
#include "saccade/sources/recording.hpp"
#include "support/tiny_folders.hpp"

namespace saccade {
namespace {

using test::TinyFolder;

constexpr double kRecordedUnits = 5000.0;

/// The simulated desk as a TUM folder, of which the tests damage copies.
class WrongGeometry : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    desk_ = new TinyFolder;
    const auto source = openSensorSource("sim:desk?frames=40");
    const auto writer = openRecording(*desk_ / "tum", RecordingKind::kTumFolder, *source, WhenRecordingExists::kRefuse);
    SensorFrame frame;
    while (source->read(frame) == ReadStatus::kFrame) writer->write(frame);
    writer->finish();
  }
  static void TearDownTestSuite() {
    delete desk_;
    desk_ = nullptr;
  }
  void SetUp() override {
    std::filesystem::copy(*desk_ / "tum", folder_.path(), std::filesystem::copy_options::recursive);
  }

  [[nodiscard]] PreflightReport judge() const { return preflight(folder_.path().string()); }

  void setIntrinsics(double focal_factor, double units_per_metre) const {
    const double f = 525.0 * focal_factor;
    std::ofstream(folder_ / "camera.yaml")
        << "{fx: " << f << ", fy: " << f
        << ", cx: 319.5, cy: 239.5, width: 640, height: 480, depth_units_per_metre: " << units_per_metre << "}\n";
  }
  /// Stores depth in other units than it was recorded with.
  void storeDepthIn(double units_per_metre) const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "depth")) {
      cv::Mat raw = cv::imread(entry.path().string(), cv::IMREAD_ANYDEPTH), scaled;
      raw.convertTo(scaled, CV_16U, units_per_metre / kRecordedUnits);
      cv::imwrite(entry.path().string(), scaled);
    }
  }
  void turnColor(int flip) const {
    for (const auto& entry : std::filesystem::directory_iterator(folder_ / "rgb")) {
      cv::Mat color = cv::imread(entry.path().string()), turned;
      cv::flip(color, turned, flip);
      cv::imwrite(entry.path().string(), turned);
    }
  }

  TinyFolder folder_;

 private:
  static TinyFolder* desk_;
};

TinyFolder* WrongGeometry::desk_ = nullptr;

// The label "slow" goes by the name.
using SlowPreflight = WrongGeometry;

TEST_F(SlowPreflight, FindsNothingWrongWithASoundFolder) {
  const PreflightReport report = judge();
  for (const PreflightFinding& finding : report.findings)
    EXPECT_EQ(finding.severity, FindingSeverity::kNote) << finding.text;
  ASSERT_TRUE(report.focal_factor);
  constexpr double kParabola = 0.05;  // three factors 10 % apart stand for the whole curve
  EXPECT_NEAR(*report.focal_factor, 1.0, kParabola);
}

TEST_F(SlowPreflight, GuessesEveryDepthScaleInUse) {
  for (const double units : {5000.0, 1000.0, 256.0, 4000.0, 6553.5, 1.0}) {
    std::filesystem::remove_all(folder_.path());
    SetUp();
    storeDepthIn(units);
    setIntrinsics(1.0, units == 1000.0 ? 5000.0 : 1000.0);
    const PreflightReport report = judge();
    ASSERT_TRUE(report.depth_scale) << units;
    EXPECT_EQ(report.depth_scale->units_per_metre, units) << report.depth_scale->reason;
    EXPECT_TRUE(report.has("depth-scale")) << units;
    EXPECT_TRUE(report.wouldFail()) << units;
  }
}

TEST_F(SlowPreflight, NamesDepthScaledByFiveWithoutPosesToo) {
  std::filesystem::remove(folder_ / "groundtruth.txt");
  setIntrinsics(1.0, 1000.0);
  const PreflightReport report = judge();
  EXPECT_TRUE(report.has("depth-scale"));
  ASSERT_TRUE(report.depth_scale);
  EXPECT_GE(report.depth_scale->units_per_metre, 4000.0) << "4000 and 5000 cannot be told apart without poses";
}

TEST_F(SlowPreflight, NamesIntrinsicsThatAreTwentyPercentOff) {
  for (const double factor : {1.2, 0.8}) {
    setIntrinsics(factor, kRecordedUnits);
    const PreflightReport report = judge();
    EXPECT_TRUE(report.has("intrinsics")) << factor;
    EXPECT_TRUE(report.wouldFail()) << factor;
    ASSERT_TRUE(report.focal_factor) << factor;
    constexpr double kRoughly = 0.08;  // the parabola again, farther from its lowest point
    EXPECT_NEAR(*report.focal_factor, 1.0 / factor, kRoughly);
  }
}

TEST_F(SlowPreflight, NamesColourThatIsTurnedOrMirrored) {
  turnColor(-1);
  const PreflightReport report = judge();
  ASSERT_TRUE(report.has("rotated-images"));
  turnColor(0);  // and so mirrored
  EXPECT_TRUE(judge().has("rotated-images"));
}

}  // namespace
}  // namespace saccade
