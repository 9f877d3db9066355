#include "saccade/simulation/simulated_source.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "saccade/core/errors.hpp"
#include "saccade/simulation/scene_renderer.hpp"
#include "saccade/simulation/sensor_noise.hpp"

namespace saccade {
namespace {

RgbdFrame readOnly(const std::string& uri, std::int64_t index) {
  const auto source = openSource(uri, FrameRange{index, index + 1, 1});
  RgbdFrame frame;
  EXPECT_EQ(source->read(frame), ReadStatus::kFrame);
  RgbdFrame rest;
  EXPECT_EQ(source->read(rest), ReadStatus::kEnd);
  return frame;
}

bool sameBytes(const cv::Mat& a, const cv::Mat& b) {
  return a.size() == b.size() && a.type() == b.type() && std::equal(a.datastart, a.dataend, b.datastart, b.dataend);
}

TEST(SimulatedSource, OneFramesDepthFallsOnTheOthers) {
  const RgbdFrame a = readOnly("sim:desk?noise=0&seed=2", 10), b = readOnly("sim:desk?noise=0&seed=2", 35);
  const PinholeCamera camera = simulatedCamera();
  const Pose T_BA = b.T_WC->inverse() * *a.T_WC;
  // Neighbouring pixels differ by the slope of the surface; planes are exact between pixels in inverse depth.
  constexpr double kTolerance_m = 2e-5;
  // Curved surfaces bend by less than this between neighbours.
  constexpr double kBend_m = 1e-3;
  int agree = 0, hidden = 0, wrong = 0;
  for (int v = 0; v < camera.height; v += 2) {
    for (int u = 0; u < camera.width; u += 2) {
      const Eigen::Vector3d p_B = T_BA * camera.unproject(u, v, a.depth_m(v, u));
      const Eigen::Vector2d q = camera.project(p_B);
      const int x = static_cast<int>(std::floor(q.x())), y = static_cast<int>(std::floor(q.y()));
      if (x < 0 || y < 0 || x + 1 >= camera.width || y + 1 >= camera.height) continue;
      const double s = q.x() - x, t = q.y() - y;
      const double w00 = 1 / b.depth_m(y, x), w10 = 1 / b.depth_m(y, x + 1), w01 = 1 / b.depth_m(y + 1, x),
                   w11 = 1 / b.depth_m(y + 1, x + 1);
      const auto [low, high] = std::minmax({w00, w10, w01, w11});
      if (std::abs(w00 + w11 - w10 - w01) > 1e-6 || high - low > 0.004) continue;  // an edge or a curved surface
      const double expected = 1 / ((1 - t) * ((1 - s) * w00 + s * w10) + t * ((1 - s) * w01 + s * w11));
      if (std::abs(p_B.z() - expected) < kTolerance_m) {
        ++agree;
      } else if (p_B.z() > expected + kBend_m) {
        ++hidden;  // something stands before it in the other view
      } else if (p_B.z() < expected - kBend_m) {
        ++wrong;  // it would float in the free space that the other frame saw
      }
    }
  }
  EXPECT_GT(agree, 20000);
  EXPECT_LT(hidden, agree / 5);
  EXPECT_LT(wrong, agree / 1000) << "beyond the steps that are lower than kBend_m suggests, such as a poster's rim";
}

TEST(SimulatedSource, GivesTheSameBytesForTheSameSeedWhateverTheRange) {
  const auto all = openSource("sim:desk?seed=5&frames=4");
  RgbdFrame frame;
  for (int i = 0; i < 4; ++i) {
    ASSERT_EQ(all->read(frame), ReadStatus::kFrame);
    const RgbdFrame alone = readOnly("sim:desk?seed=5", i);
    EXPECT_EQ(frame.name, alone.name);
    EXPECT_EQ(frame.index, alone.index);
    EXPECT_TRUE(sameBytes(frame.color, alone.color));
    EXPECT_TRUE(sameBytes(frame.depth_m, alone.depth_m));
    EXPECT_TRUE(sameBytes(frame.label, alone.label));
    EXPECT_EQ(frame.T_WC->matrix(), alone.T_WC->matrix());
  }
  EXPECT_EQ(all->read(frame), ReadStatus::kEnd);
  const RgbdFrame other = readOnly("sim:desk?seed=6", 0), same = readOnly("sim:desk?seed=5", 0);
  EXPECT_FALSE(sameBytes(other.color, same.color));
  EXPECT_FALSE(sameBytes(other.label, same.label)) << "the objects stand elsewhere";
}

TEST(SimulatedSource, DescribesItself) {
  const auto source = openSource("sim:desk?frames=50&noise=0", FrameRange::parse("10:40:7"));
  const SourceDescription& description = source->description();
  EXPECT_EQ(description.kind, "simulated scene");
  EXPECT_EQ(description.frames, 5);
  EXPECT_EQ(description.total_frames, 50);
  EXPECT_EQ(description.camera.width, 640);
  EXPECT_TRUE(description.has_depth && description.has_poses && description.has_labels);
  RgbdFrame frame;
  ASSERT_EQ(source->read(frame), ReadStatus::kFrame);
  EXPECT_EQ(frame.name, "desk-000010");
  EXPECT_DOUBLE_EQ(frame.stamp_s, 0.333333);  // whole microseconds
  int frames = 1;
  while (source->read(frame) == ReadStatus::kFrame) ++frames;
  EXPECT_EQ(frames, 5);
}

TEST(SimulatedSource, RefusesWhatItDoesNotKnow) {
  for (const char* bad :
       {"sim:", "sim:moon", "sim:desk?speed=3", "sim:desk?frames=0", "sim:desk?frames=ten", "sim:desk?noise=-1",
        "sim:desk?noise=nan", "sim:desk?seed=", "sim:desk?seed", "sim:desk?seed=-1"}) {
    EXPECT_THROW((void)openSource(bad), IoError) << bad;
  }
  EXPECT_THROW((void)openSource("sim:desk?frames=5", FrameRange::parse("5:")), IoError);
  EXPECT_THROW((void)openSource("sim:desk", {}, "labels"), IoError);
  EXPECT_EQ(openSource("sim:desk?seed=18446744073709551615&frames=1&noise=0.5")->description().frames, 1);
}

TEST(SimulatedSource, AnObjectThatSomebodyMovedIsElsewhereAndTheOthersAreNot) {
  const RgbdFrame before = readOnly("sim:desk?noise=0", 0), after = readOnly("sim:desk?noise=0&moved=6&dx=0.1", 0);
  const auto pixelsOf = [](const RgbdFrame& frame, int id) { return cv::Mat1b(frame.label == id); };
  ASSERT_GT(cv::countNonZero(pixelsOf(before, 6)), 0);
  EXPECT_FALSE(sameBytes(pixelsOf(before, 6), pixelsOf(after, 6)));
  int others_moved = 0;
  for (int v = 0; v < before.label.rows; ++v) {
    for (int u = 0; u < before.label.cols; ++u) {
      const int a = before.label(v, u), b = after.label(v, u);
      others_moved += a != b && a != 6 && b != 6 ? 1 : 0;
    }
  }
  EXPECT_EQ(others_moved, 0);
  EXPECT_THROW(readOnly("sim:desk?moved=1000", 0), IoError);
  EXPECT_THROW(readOnly("sim:desk?moved=1&dx=nan", 0), IoError);
}

TEST(SimulatedSource, TakesTheScenesOwnNumberOfFrames) {
  EXPECT_EQ(SimulationRequest::parse("sim:desk").frames, 120);
  EXPECT_EQ(SimulationRequest::parse("sim:coffee?seed=2").frames, 436);
  EXPECT_EQ(SimulationRequest::parse("sim:flat").frames, 6000);
  EXPECT_EQ(SimulationRequest::parse("sim:flat?frames=7").frames, 7);
}

TEST(SimulatedSource, HasCamerasWhoseDepthCoversTheImageAndOthersWhereItDoesNot) {
  int full = 0, narrow = 0;
  for (int seed = 0; seed < 8; ++seed) {
    const RgbdFrame frame = readOnly("sim:desk?seed=" + std::to_string(seed), 0);
    const cv::Mat measured = frame.depth_m > 0;
    // Along some border of a narrow view nothing at all is measured.
    const cv::Mat borders[] = {measured.col(0), measured.col(measured.cols - 1), measured.row(0),
                               measured.row(measured.rows - 1)};
    const bool strip =
        std::any_of(std::begin(borders), std::end(borders), [](const cv::Mat& b) { return cv::countNonZero(b) == 0; });
    ++(strip ? narrow : full);
    EXPECT_GT(cv::countNonZero(measured), 0.6 * static_cast<double>(measured.total())) << seed;
  }
  EXPECT_GE(full, 1);
  EXPECT_GE(narrow, 4);
}

TEST(SimulatedSource, GivesTheSameBytesWithOneThread) {
  const RgbdFrame many = readOnly("sim:desk?seed=3", 7);
  const tbb::global_control single(tbb::global_control::max_allowed_parallelism, 1);
  const RgbdFrame one = readOnly("sim:desk?seed=3", 7);
  EXPECT_TRUE(sameBytes(many.color, one.color));
  EXPECT_TRUE(sameBytes(many.depth_m, one.depth_m));
  EXPECT_TRUE(sameBytes(many.label, one.label));
}

/// Images of a wall that faces the camera.
SceneImages wallAt(float z_m, float cosine) {
  SceneImages images;
  images.color = cv::Mat3b(240, 320, cv::Vec3b(100, 100, 100));
  images.depth_m = cv::Mat1f(240, 320, z_m);
  images.cosine = cv::Mat1f(240, 320, cosine);
  images.echo = cv::Mat1f(240, 320, 1.0f);
  images.label = cv::Mat1w(240, 320, static_cast<ushort>(0));
  return images;
}

TEST(SensorNoise, GrowsWithTheSquareOfTheDistance) {
  SensorNoise noise(1);
  for (const float z : {0.8f, 1.5f, 3.0f}) {
    SceneImages images = wallAt(z, 1.0f);
    noise.apply(0, images);
    cv::Scalar mean, deviation;
    cv::meanStdDev(images.depth_m, mean, deviation);
    const double sigma = 0.0012 + 0.0019 * (z - 0.4) * (z - 0.4);
    EXPECT_NEAR(deviation[0], sigma, 0.15 * sigma) << z;  // the disparity step makes up for part of it
    EXPECT_NEAR(mean[0], z, 0.1 * sigma) << z;
    EXPECT_EQ(cv::countNonZero(images.depth_m), 240 * 320);
  }
}

TEST(SensorNoise, QuantisesDisparity) {
  SensorNoise noise(1);
  SceneImages images = wallAt(3.0f, 1.0f);
  noise.apply(0, images);
  for (const float z : images.depth_m) {
    const double steps = 570 * 0.075 * 8 / z;
    ASSERT_NEAR(steps, std::round(steps), 1e-3);
  }
}

TEST(SensorNoise, DropsGrazingSurfacesEdgesAndWhatIsOutOfRange) {
  SensorNoise noise(1);
  SceneImages grazing = wallAt(1.0f, 0.05f), near = wallAt(0.3f, 1.0f), far = wallAt(7.0f, 1.0f);
  SceneImages edge = wallAt(2.0f, 1.0f);
  edge.depth_m.colRange(0, 160) = 1.0f;
  for (SceneImages* images : {&grazing, &near, &far, &edge}) noise.apply(0, *images);
  EXPECT_LT(cv::countNonZero(grazing.depth_m), 240 * 320 / 2);
  EXPECT_EQ(cv::countNonZero(near.depth_m), 0);
  EXPECT_EQ(cv::countNonZero(far.depth_m), 0);
  const int lost = 240 * 320 - cv::countNonZero(edge.depth_m);
  EXPECT_GT(lost, 20);
  EXPECT_LT(lost, 2 * 240) << "only along the edge";
}

TEST(SensorNoise, LeavesTheProjectorsShadowEmpty) {
  SensorNoise noise(1);
  SceneImages images = wallAt(2.0f, 1.0f);
  images.depth_m.colRange(160, 320) = 1.0f;
  noise.apply(0, images);
  const int width_px = 21;  // 570 px * 0.075 m * (1/1 m - 1/2 m)
  for (int v = 0; v < 240; ++v) {
    for (int u = 160 - width_px + 1; u < 158; ++u) ASSERT_EQ(images.depth_m(v, u), 0.0f) << u << ", " << v;
    ASSERT_GT(images.depth_m(v, 160 - width_px - 2), 0.0f);
  }
}

TEST(SensorNoise, FindsNothingWhereItsDepthCameraDoesNotLook) {
  SensorNoise noise(1, {.view_share = 0.9, .view_right_px = 4.0, .view_down_px = -2.0, .camera_left_m = 0.02});
  for (const float z : {1.0f, 2.0f}) {
    SceneImages images = wallAt(z, 1.0f);
    noise.apply(0, images);
    const double parallax_px = 570 * 0.02 / static_cast<double>(z);
    const int left = static_cast<int>(std::lrint(16 + 4 - parallax_px)), top = 12 - 2;  // a tenth is outside
    const cv::Rect view(left, top, 288, 216);
    EXPECT_EQ(cv::countNonZero(images.depth_m(view)), view.area());
    EXPECT_EQ(cv::countNonZero(images.depth_m), view.area());
  }
}

TEST(SensorNoise, FindsNothingWhereNoEchoComesBack) {
  SensorNoise noise(1);
  SceneImages images = wallAt(1.0f, 1.0f);
  images.echo.colRange(0, 100) = 0.0f;
  images.echo.colRange(100, 200) = 0.5f;
  noise.apply(0, images);
  EXPECT_EQ(cv::countNonZero(images.depth_m.colRange(0, 100)), 0);
  const double half = cv::countNonZero(images.depth_m.colRange(100, 200)) / (240.0 * 100);
  EXPECT_NEAR(half, 0.5, 0.1) << "patches come and go";
  EXPECT_EQ(cv::countNonZero(images.depth_m.colRange(200, 320)), 240 * 120);
}

TEST(SensorNoise, OfStrengthZeroChangesNothing) {
  SensorNoise noise(1, {.strength = 0.0});
  SceneImages images = wallAt(7.0f, 0.01f);
  noise.apply(3, images);
  EXPECT_TRUE(sameBytes(images.depth_m, wallAt(7.0f, 0).depth_m));
  EXPECT_TRUE(sameBytes(images.color, wallAt(7.0f, 0).color));
}

}  // namespace
}  // namespace saccade
