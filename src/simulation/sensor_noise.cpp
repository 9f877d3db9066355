#include "saccade/simulation/sensor_noise.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <tbb/parallel_for.h>

#include "simulation/random_hash.hpp"

namespace saccade {
namespace {

constexpr float kGrazingCosine = 0.26f;    // 75 degrees: below, measurements begin to drop out
constexpr float kEdgeStep = 0.03f;         // relative step of depth that makes an edge
constexpr float kEdgeDropout = 0.35f;      // share of edge pixels without measurement
constexpr float kLateralJitter_px = 1.0f;  // where along the image a depth value really comes from

/// Sum of four uniform numbers, scaled to variance 1: normal enough, bounded by 3.5, and cheap.
float roughlyNormal(std::uint64_t bits) {
  const auto sum = static_cast<float>((bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48));
  return (sum * 0x1p-16f - 2.0f) * 1.7320508f;
}

// Places without an echo are patches, not single pixels, and stay where they are on the image for a moment.
constexpr int kPatch_px = 5;
constexpr std::int64_t kPatchFrames = 3;

std::uint64_t pixelHash(std::uint64_t stream, int u, int v) {
  return mixed(stream ^
               (static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)) << 32 | static_cast<std::uint32_t>(u)));
}

}  // namespace

void SensorNoiseConfig::describe(ConfigVisitor& visitor) {
  visitor.number("strength", strength, {0.0, 10.0}, "", "factor on all noise, 0 for an ideal sensor");
  visitor.number("focal_px", focal_px, {1.0, 1e5}, "px", "focal length of the simulated depth sensor");
  visitor.number("baseline_m", baseline_m, {1e-4, 10.0}, "m", "distance of its projector and camera");
  visitor.number("disparity_step_px", disparity_step_px, {1e-6, 10.0}, "px", "smallest step of its disparity");
  visitor.number("nearest_m", nearest_m, {0.0, 100.0}, "m", "no depth below");
  visitor.number("farthest_m", farthest_m, {0.0, 1000.0}, "m", "no depth beyond");
  visitor.number("color_sigma", color_sigma, {0.0, 100.0}, "grey levels", "standard deviation of colour noise");
}

SensorNoise::SensorNoise(std::uint64_t seed, const Config& config) : seed_(seed), config_(config) {
  requireValid(config);
}

void SensorNoise::apply(std::int64_t frame, SceneImages& images) {
  if (config_.strength <= 0) return;
  const std::uint64_t stream = mixed(mixed(seed_) ^ static_cast<std::uint64_t>(frame));
  applyToDepth(stream, mixed(seed_ ^ 0x9d1full) + static_cast<std::uint64_t>(frame / kPatchFrames), images);
  applyToColor(mixed(stream), images.color);
}

// The projector stands to the right of the camera. Seen from it, a pixel lies `disparity` columns further left; going
// from right to left, a pixel is hidden if something already seen reaches over its column.
void SensorNoise::markShadows(int row, std::vector<bool>& in_shadow) const {
  const float* z = exact_[row];
  const auto disparity_at_1m = static_cast<float>(config_.focal_px * config_.baseline_m);
  float leftmost = std::numeric_limits<float>::infinity();
  for (int u = exact_.cols - 1; u >= 0; --u) {
    const float column = static_cast<float>(u) - (z[u] > 0 ? disparity_at_1m / z[u] : 0.0f);
    in_shadow[static_cast<std::size_t>(u)] = column > leftmost + 0.5f;
    leftmost = std::min(leftmost, column);
  }
}

void SensorNoise::applyToDepth(std::uint64_t stream, std::uint64_t patches, SceneImages& images) {
  images.depth_m.copyTo(exact_);
  tbb::parallel_for(0, exact_.rows, [&](int row) {
    std::vector<bool> in_shadow(static_cast<std::size_t>(exact_.cols));
    markShadows(row, in_shadow);
    for (int u = 0; u < exact_.cols; ++u) {
      images.depth_m(row, u) =
          in_shadow[static_cast<std::size_t>(u)] ? 0.0f : measured(stream, patches, u, row, images);
    }
  });
}

// What the sensor reads at a pixel that its projector reaches; 0 = nothing.
float SensorNoise::measured(std::uint64_t stream, std::uint64_t patches, int u, int v,
                            const SceneImages& images) const {
  const auto strength = static_cast<float>(config_.strength);
  const auto steps = static_cast<float>(config_.focal_px * config_.baseline_m /
                                        (config_.disparity_step_px * std::min(config_.strength, 1.0)));
  const float jitter = kLateralJitter_px * std::min(strength, 2.0f);
  const std::uint64_t bits = pixelHash(stream, u, v), more = mixed(bits);
  const float sideways = static_cast<float>(more & 0xffff) * 0x1p-15f - 1.0f;
  const float upwards = static_cast<float>(more >> 16 & 0xffff) * 0x1p-15f - 1.0f;
  const int from_u = std::clamp(u + static_cast<int>(std::lrint(jitter * sideways)), 0, exact_.cols - 1);
  const int from_v = std::clamp(v + static_cast<int>(std::lrint(jitter * upwards)), 0, exact_.rows - 1);
  const float here = exact_(v, u), there = exact_(from_v, from_u);
  // Off the edges the jitter would only roughen slanted surfaces, which the axial noise already stands for.
  const bool edge = std::abs(here - there) > kEdgeStep * std::min(here, there);
  float z = edge ? there : here;
  const float chance = static_cast<float>(more >> 32 & 0xffff) * 0x1p-16f;
  const float grazing = std::max(0.0f, 1.0f - images.cosine(v, u) / kGrazingCosine);
  const float dropout = std::max(strength * grazing, edge ? kEdgeDropout : 0.0f);
  if (chance < dropout || z < static_cast<float>(config_.nearest_m) || z > static_cast<float>(config_.farthest_m)) {
    return 0.0f;
  }
  if (const float echo = images.echo(v, u); echo < 1.0f) {
    const float patch = static_cast<float>(pixelHash(patches, u / kPatch_px, v / kPatch_px) >> 48) * 0x1p-16f;
    if (0.8f * patch + 0.2f * chance < strength * (1.0f - echo)) return 0.0f;
  }
  const float sigma_m = 0.0012f + 0.0019f * (z - 0.4f) * (z - 0.4f);
  // The model's sigma holds the quantisation too; what the steps below add is taken off.
  const float step_m = z * z / steps;
  const float rest_m = std::sqrt(std::max(sigma_m * sigma_m - step_m * step_m / 12.0f, 0.0f));
  z += strength * rest_m * roughlyNormal(bits);
  return steps / std::max(std::round(steps / z), 1.0f);
}

void SensorNoise::applyToColor(std::uint64_t stream, cv::Mat3b& color) const {
  const auto sigma = static_cast<float>(config_.strength * config_.color_sigma);
  tbb::parallel_for(0, color.rows, [&](int v) {
    for (int u = 0; u < color.cols; ++u) {
      // A common part for brightness and a small one per channel.
      const std::uint64_t bits = pixelHash(stream, u, v);
      const float common = sigma * roughlyNormal(bits);
      cv::Vec3b& pixel = color(v, u);
      for (int channel = 0; channel < 3; ++channel) {
        const float own = sigma * (static_cast<float>(bits >> (20 * channel) & 0xff) * 0x1p-7f - 1.0f);
        pixel[channel] = cv::saturate_cast<uchar>(static_cast<float>(pixel[channel]) + 0.8f * common + 0.6f * own);
      }
    }
  });
}

}  // namespace saccade
