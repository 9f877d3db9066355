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
constexpr float kLateralJitter_px = 2.0f;  // where along the image a depth value really comes from, at most

/// Sum of four uniform numbers, scaled to variance 1: normal enough, bounded by 3.5, and cheap.
float roughlyNormal(std::uint64_t bits) {
  const auto sum = static_cast<float>((bits & 0xffff) + (bits >> 16 & 0xffff) + (bits >> 32 & 0xffff) + (bits >> 48));
  return (sum * 0x1p-16f - 2.0f) * 1.7320508f;
}

// The sensor matches windows of its pattern, not pixels: neighbours err together, edges waver, gaps are patches. These
// are the sizes of what errs together; gaps stay where they are on the image for a moment.
constexpr int kNoise_px = 3, kEdge_px = 5, kGap_px = 9;
constexpr std::int64_t kGapFrames = 3;

std::uint64_t pixelHash(std::uint64_t stream, int u, int v) {
  return mixed(stream ^
               (static_cast<std::uint64_t>(static_cast<std::uint32_t>(v)) << 32 | static_cast<std::uint32_t>(u)));
}

/// Weights and corners of a pixel between the points of a lattice.
struct LatticePlace {
  int column, row;
  float weights[4];

  LatticePlace(int u, int v, int cell_px) : column(u / cell_px), row(v / cell_px) {
    const float right = static_cast<float>(u % cell_px) / static_cast<float>(cell_px);
    const float down = static_cast<float>(v % cell_px) / static_cast<float>(cell_px);
    weights[0] = (1 - right) * (1 - down);
    weights[1] = right * (1 - down);
    weights[2] = (1 - right) * down;
    weights[3] = right * down;
  }
  [[nodiscard]] std::uint64_t hash(std::uint64_t stream, int corner) const {
    return pixelHash(stream, column + corner % 2, row + corner / 2);
  }
};

/// A field over the image of mean 0 and variance 1 at every pixel, smooth over `cell_px`.
float smoothNormal(std::uint64_t stream, int u, int v, int cell_px) {
  const LatticePlace at(u, v, cell_px);
  float sum = 0.0f, squares = 0.0f;
  for (int corner = 0; corner < 4; ++corner) {
    sum += at.weights[corner] * roughlyNormal(at.hash(stream, corner));
    squares += at.weights[corner] * at.weights[corner];
  }
  return sum / std::sqrt(squares);
}

/// A shift in the image, smooth over `cell_px`, of at most 1 along u and v.
Eigen::Vector2f smoothShift(std::uint64_t stream, int u, int v, int cell_px) {
  const LatticePlace at(u, v, cell_px);
  Eigen::Vector2f sum = Eigen::Vector2f::Zero();
  for (int corner = 0; corner < 4; ++corner) {
    const std::uint64_t bits = at.hash(stream, corner);
    sum += at.weights[corner] * Eigen::Vector2f(static_cast<float>(bits & 0xffff) * 0x1p-15f - 1.0f,
                                                static_cast<float>(bits >> 16 & 0xffff) * 0x1p-15f - 1.0f);
  }
  return sum;
}

/// Where a normal variable lies in its distribution, 0..1, to within 0.01: the logistic curve.
float shareBelow(float normal) {
  return 1.0f / (1.0f + std::exp(-1.702f * normal));
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
  visitor.number("view_share", view_share, {0.1, 10.0}, "",
                 "share of the colour image's width and height that it sees");
  visitor.number("view_right_px", view_right_px, {-1e4, 1e4}, "px",
                 "by which its view lies to the right of the middle");
  visitor.number("view_down_px", view_down_px, {-1e4, 1e4}, "px", "by which its view lies below the middle");
  visitor.number("camera_left_m", camera_left_m, {-10.0, 10.0}, "m",
                 "by which it stands to the left of the colour camera");
}

SensorNoise::SensorNoise(std::uint64_t seed, const Config& config) : seed_(seed), config_(config) {
  requireValid(config);
}

void SensorNoise::apply(std::int64_t frame, SceneImages& images) {
  if (config_.strength <= 0) return;
  const std::uint64_t stream = mixed(mixed(seed_) ^ static_cast<std::uint64_t>(frame));
  applyToDepth(stream, mixed(seed_ ^ 0x9d1full) + static_cast<std::uint64_t>(frame / kGapFrames), images);
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

void SensorNoise::applyToDepth(std::uint64_t stream, std::uint64_t gaps, SceneImages& images) {
  images.depth_m.copyTo(exact_);
  tbb::parallel_for(0, exact_.rows, [&](int row) {
    std::vector<bool> in_shadow(static_cast<std::size_t>(exact_.cols));
    markShadows(row, in_shadow);
    for (int u = 0; u < exact_.cols; ++u) {
      images.depth_m(row, u) = in_shadow[static_cast<std::size_t>(u)] ? 0.0f : measured(stream, gaps, u, row, images);
    }
  });
}

bool SensorNoise::isInView(int u, int v, float z) const {
  const double parallax_px = config_.focal_px * config_.camera_left_m / static_cast<double>(z);
  const double right_px = u + 0.5 - exact_.cols / 2.0 - config_.view_right_px + parallax_px;
  const double down_px = v + 0.5 - exact_.rows / 2.0 - config_.view_down_px;
  return 2 * std::abs(right_px) <= config_.view_share * exact_.cols &&
         2 * std::abs(down_px) <= config_.view_share * exact_.rows;
}

// What the sensor reads at a pixel that its projector reaches; 0 = nothing.
float SensorNoise::measured(std::uint64_t stream, std::uint64_t gaps, int u, int v, const SceneImages& images) const {
  const auto strength = static_cast<float>(config_.strength);
  const auto steps = static_cast<float>(config_.focal_px * config_.baseline_m /
                                        (config_.disparity_step_px * std::min(config_.strength, 1.0)));
  const Eigen::Vector2f shift =
      kLateralJitter_px * std::min(strength, 2.0f) * smoothShift(mixed(stream ^ 0x5e), u, v, kEdge_px);
  const int from_u = std::clamp(u + static_cast<int>(std::lrint(shift.x())), 0, exact_.cols - 1);
  const int from_v = std::clamp(v + static_cast<int>(std::lrint(shift.y())), 0, exact_.rows - 1);
  const float here = exact_(v, u), there = exact_(from_v, from_u);
  // Off the edges the shift would only roughen slanted surfaces, which the axial noise already stands for.
  const bool edge = std::abs(here - there) > kEdgeStep * std::min(here, there);
  float z = edge ? there : here;
  if (z < static_cast<float>(config_.nearest_m) || z > static_cast<float>(config_.farthest_m)) return 0.0f;
  if (!isInView(u, v, z)) return 0.0f;
  const float grazing = std::max(0.0f, 1.0f - images.cosine(v, u) / kGrazingCosine);
  // A window fails as a whole or not at all, so that weak losses hardly show.
  const float lost = std::clamp(2.0f * strength * std::max(grazing, 1.0f - images.echo(v, u)) - 0.5f, 0.0f, 1.0f);
  if (const float dropout = std::max(lost, edge ? kEdgeDropout : 0.0f); dropout > 0.0f) {
    const float large = smoothNormal(gaps, u, v, kGap_px), fine = smoothNormal(mixed(gaps), u, v, kNoise_px);
    if (dropout >= 1.0f || shareBelow(0.8f * large + 0.6f * fine) < dropout) return 0.0f;
  }
  const float sigma_m = 0.0012f + 0.0019f * (z - 0.4f) * (z - 0.4f);
  // The model's sigma holds the quantisation too; what the steps below add is taken off.
  const float step_m = z * z / steps;
  const float rest_m = std::sqrt(std::max(sigma_m * sigma_m - step_m * step_m / 12.0f, 0.0f));
  z += strength * rest_m * smoothNormal(stream, u, v, kNoise_px);
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
