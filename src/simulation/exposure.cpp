#include "simulation/exposure.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>
#include <tbb/parallel_for.h>

#include "simulation/random_hash.hpp"

namespace saccade {
namespace {

constexpr int kBlock = 16;
constexpr double kShortestOpen = 0.2, kLongestOpen = 0.7;  // shares of the time between frames: 1/150 to 1/43 s
constexpr double kLongestBlur_px = 12.0;
constexpr double kBrightnessDrift = 0.07, kTintDrift = 0.025;
// Cameras differ: in how soft their lens is and how steep their curve, which burns highlights out and drowns shadows.
constexpr double kSharpest_px = 0.5, kSoftest_px = 0.9;
constexpr double kSteepest = 1.7, kMiddleGrey = 115.0;

}  // namespace

Exposure::Exposure(std::uint64_t seed, double strength, const PinholeCamera& camera)
    : strength_(strength), camera_(camera) {
  RandomStream random(seed ^ 0x6578706f73757265u);
  for (double& phase : phase_) phase = random.between(0, 2 * std::numbers::pi);
  open_share_ = random.between(kShortestOpen, kLongestOpen);
  lens_sigma_px_ = random.between(kSharpest_px, kSoftest_px);
  contrast_ = random.between(1.0, kSteepest);
}

// A block moves as its middle does; taps are spread evenly over the way.
void Exposure::blurBlock(const cv::Rect& block, const cv::Mat1f& depth_m, const Pose& T_NC, cv::Mat3b& color) const {
  const int u = block.x + block.width / 2, v = block.y + block.height / 2;
  const double z = depth_m(v, u) > 0 ? static_cast<double>(depth_m(v, u)) : 2.0;
  const Eigen::Vector3d p_N = T_NC * camera_.unproject(u, v, z);
  if (!(p_N.z() > 0)) return;
  Eigen::Vector2d way = strength_ * open_share_ * (camera_.project(p_N) - Eigen::Vector2d(u, v));
  const double length = way.norm();
  if (length < 0.7) return;
  way *= std::min(1.0, kLongestBlur_px / length);
  const int taps = 1 + static_cast<int>(std::ceil(way.norm()));
  cv::Point offsets[2 + static_cast<int>(kLongestBlur_px)];
  for (int tap = 0; tap < taps; ++tap) {
    const double share = taps > 1 ? static_cast<double>(tap) / (taps - 1) - 0.5 : 0.0;
    offsets[tap] = {static_cast<int>(std::lrint(share * way.x())), static_cast<int>(std::lrint(share * way.y()))};
  }
  for (int row = block.y; row < block.br().y; ++row) {
    for (int column = block.x; column < block.br().x; ++column) {
      int sum[3] = {0, 0, 0};
      for (int tap = 0; tap < taps; ++tap) {
        const cv::Vec3b& from = sharp_(std::clamp(row + offsets[tap].y, 0, sharp_.rows - 1),
                                       std::clamp(column + offsets[tap].x, 0, sharp_.cols - 1));
        for (int channel = 0; channel < 3; ++channel) sum[channel] += from[channel];
      }
      for (int channel = 0; channel < 3; ++channel) {
        color(row, column)[channel] = static_cast<uchar>((sum[channel] + taps / 2) / taps);
      }
    }
  }
}

void Exposure::apply(std::int64_t frame, const cv::Mat1f& depth_m, const Pose& T_NC, cv::Mat3b& color) {
  if (strength_ <= 0) return;
  cv::GaussianBlur(color, sharp_, cv::Size(5, 5), lens_sigma_px_);
  sharp_.copyTo(color);
  const cv::Rect image(cv::Point(0, 0), color.size());
  tbb::parallel_for(0, (color.rows + kBlock - 1) / kBlock, [&](int row) {
    for (int column = 0; column < color.cols; column += kBlock) {
      blurBlock(cv::Rect(column, row * kBlock, kBlock, kBlock) & image, depth_m, T_NC, color);
    }
  });

  const auto wave = [&](double period_frames, double phase) {
    return std::sin(2 * std::numbers::pi * static_cast<double>(frame) / period_frames + phase);
  };
  const double drift = std::min(strength_, 2.0);
  const double gain = 1.0 + drift * kBrightnessDrift * (0.7 * wave(240, phase_[0]) + 0.3 * wave(61, phase_[1]));
  const double warmth = drift * kTintDrift * wave(410, phase_[2]);
  cv::Mat3b curves(1, 256);
  for (int level = 0; level < 256; ++level) {
    const double grey = kMiddleGrey + contrast_ * (level - kMiddleGrey);
    curves(level) =
        cv::Vec3b(cv::saturate_cast<uchar>(grey * gain * (1 - warmth)), cv::saturate_cast<uchar>(grey * gain),
                  cv::saturate_cast<uchar>(grey * gain * (1 + warmth)));
  }
  cv::LUT(color, curves, color);
}

}  // namespace saccade
