#include "saccade/core/depth_maps.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

// Zeros around the inverse depth image: the largest radius of a window, so that no loop needs to ask for the border.
constexpr int kMargin = 8;
// Surfaces seen at a flatter angle than this give slopes that are mostly noise.
constexpr float kSmallestCosine = 0.08F;

// Row of the measured depth: invalid values become 0; and its inverse.
SACCADE_MULTIVERSION
void limitRow(const float* raw, int width, float lowest, float highest, float* depth, float* inverse) {
  for (int u = 0; u < width; ++u) {
    const bool good = raw[u] >= lowest && raw[u] <= highest;  // false for NaN
    const float z = good ? raw[u] : 0.0F;
    depth[u] = z;
    inverse[u] = good ? 1.0F / raw[u] : 0.0F;
  }
}

// Bilateral mean of `centre[u + k * step]`, |k| <= radius, over pairs (+k, -k), each weighted by how well it lies on a
// line with the centre: a slanted plane, whose inverse depth is linear, is left as it is, at its borders too. A pair
// with a pixel that is not measured (0) bends by more than the tolerance and has no weight.
SACCADE_MULTIVERSION
void smoothRow(const float* centre, std::ptrdiff_t step, int radius, int width, float tolerance, float* out) {
  constexpr int kBlock = 64;
  const float scale = 1.0F / (tolerance * tolerance);
  for (int first = 0; first < width; first += kBlock) {
    const int count = std::min(kBlock, width - first);
    const float* c = centre + first;
    float sum[kBlock];
    float weight[kBlock];
    for (int i = 0; i < count; ++i) {
      sum[i] = 0.0F;  // offsets from the centre keep the float sums exact enough
      weight[i] = 1.0F;
    }
    for (int k = 1; k <= radius; ++k) {
      const float* a = c + k * step;
      const float* b = c - k * step;
      for (int i = 0; i < count; ++i) {
        const float bend = a[i] + b[i] - 2.0F * c[i];
        const float near = std::max(0.0F, 1.0F - bend * bend * scale);
        const float share = near * near;
        sum[i] += share * bend;
        weight[i] += 2.0F * share;
      }
    }
    for (int i = 0; i < count; ++i) out[first + i] = c[i] + sum[i] / weight[i];
  }
}

// Least squares slope of the inverse depth through the centre, over those pairs of pixels (+k, -k) that lie on a
// line with it; `support` is the sum of 2 k^2 over the pairs used.
SACCADE_MULTIVERSION
void slopeRow(const float* centre, std::ptrdiff_t step, int radius, int width, float tolerance, float* slope,
              float* support) {
  for (int u = 0; u < width; ++u) {
    slope[u] = 0.0F;
    support[u] = 0.0F;
  }
  for (int k = 1; k <= radius; ++k) {
    const float* ahead = centre + k * step;
    const float* behind = centre - k * step;
    const auto distance = static_cast<float>(k);
    for (int u = 0; u < width; ++u) {
      const float bend = std::abs(ahead[u] + behind[u] - 2.0F * centre[u]);
      const bool good = (bend < tolerance) & (ahead[u] > 0.0F) & (behind[u] > 0.0F);
      slope[u] += good ? distance * (ahead[u] - behind[u]) : 0.0F;
      support[u] += good ? 2.0F * distance * distance : 0.0F;
    }
  }
}

struct Slopes {
  const float* u;
  const float* u_support;
  const float* v;
  const float* v_support;
};

// On the plane n . p = d the inverse depth is (n / d) . ((u - cx) / fx, (v - cy) / fy, 1): the slopes are n / d.
SACCADE_MULTIVERSION
void geometryRow(const float* inverse, const Slopes& slopes, int width, float v, const float* intrinsics,
                 float needed_support, float* vertices, float* normals) {
  const float fx = intrinsics[0];
  const float fy = intrinsics[1];
  const float cx = intrinsics[2];
  const float dv = v - intrinsics[3];
  for (int u = 0; u < width; ++u) {
    const float q = inverse[u];
    const bool measured = q > 0.0F;
    const float z = measured ? 1.0F / q : 0.0F;
    const float du = static_cast<float>(u) - cx;
    const float x = du / fx * z;
    const float y = dv / fy * z;
    const bool supported = measured & (slopes.u_support[u] >= needed_support) & (slopes.v_support[u] >= needed_support);
    const float a = supported ? slopes.u[u] / slopes.u_support[u] : 0.0F;
    const float b = supported ? slopes.v[u] / slopes.v_support[u] : 0.0F;
    const float nx = a * fx;
    const float ny = b * fy;
    const float nz = q - a * du - b * dv;
    // n . p = 1 by construction, so the cosine between normal and ray is 1 / (|n| |p|), and -n faces the camera.
    const float n_square = nx * nx + ny * ny + nz * nz;
    const float p_square = x * x + y * y + z * z;
    const bool facing = supported & (n_square * p_square * (kSmallestCosine * kSmallestCosine) < 1.0F);
    const float scale = facing ? -1.0F / std::sqrt(n_square) : 0.0F;
    vertices[3 * u] = x;
    vertices[3 * u + 1] = y;
    vertices[3 * u + 2] = z;
    normals[3 * u] = nx * scale;
    normals[3 * u + 1] = ny * scale;
    normals[3 * u + 2] = nz * scale;
  }
}

void createWithMargin(cv::Mat1f& image, int width, int height) {
  const cv::Size size(width + 2 * kMargin, height + 2 * kMargin);
  if (image.size() != size) image = cv::Mat1f::zeros(size);  // only the inside is ever written
}

}  // namespace

void DepthPreparationConfig::describe(ConfigVisitor& visitor) {
  visitor.number("min_range_m", min_range_m, {0.01, 100.0}, "m", "nearest depth that is used");
  visitor.number("max_range_m", max_range_m, {0.02, 100.0}, "m", "farthest depth that is used");
  visitor.number("smoothing_tolerance_per_m", smoothing_tolerance_per_m, {1e-6, 10.0}, "1/m",
                 "bend of the inverse depth at which smoothing stops");
  visitor.integer("smoothing_radius_px", smoothing_radius_px, {0.0, kMargin}, "px",
                  "radius of the edge-preserving smoothing, 0 for none");
  visitor.number("normal_tolerance_per_m", normal_tolerance_per_m, {1e-6, 10.0}, "1/m",
                 "bend of the inverse depth that counts as a discontinuity");
  visitor.integer("normal_radius_px", normal_radius_px, {1.0, kMargin}, "px", "radius of the window of a normal");
}

DepthPreparation::DepthPreparation(const Config& config) : config_(config) {
  requireValid(config_);
  if (config_.min_range_m >= config_.max_range_m) {
    throw std::invalid_argument("depth range is empty: min_range_m " + std::to_string(config_.min_range_m) +
                                ", max_range_m " + std::to_string(config_.max_range_m));
  }
}

void DepthPreparation::smooth(int width, int height) {
  // Never so wide that a pixel without measurement, 0, would count as a neighbour of the farthest measured one.
  const auto tolerance = static_cast<float>(std::min(config_.smoothing_tolerance_per_m, 1.0 / config_.max_range_m));
  const auto step = static_cast<std::ptrdiff_t>(inverse_depth_.step1());
  const int radius = config_.smoothing_radius_px;
  createWithMargin(smoothed_, width, height);
  for (int v = 0; v < height; ++v) {
    smoothRow(inverse_depth_[v + kMargin] + kMargin, 1, radius, width, tolerance, smoothed_[v + kMargin] + kMargin);
  }
  for (int v = 0; v < height; ++v) {
    smoothRow(smoothed_[v + kMargin] + kMargin, step, radius, width, tolerance, inverse_depth_[v + kMargin] + kMargin);
  }
}

void DepthPreparation::prepare(const cv::Mat1f& depth_m, const PinholeCamera& camera, DepthMaps& maps) {
  const int width = camera.width;
  const int height = camera.height;
  if (depth_m.cols != width || depth_m.rows != height) {
    throw std::invalid_argument("depth image is " + std::to_string(depth_m.cols) + "x" + std::to_string(depth_m.rows) +
                                ", its camera " + std::to_string(width) + "x" + std::to_string(height));
  }
  maps.camera = camera;
  maps.depth_m.create(height, width);
  maps.vertices.create(height, width);
  maps.normals.create(height, width);
  createWithMargin(inverse_depth_, width, height);

  for (int v = 0; v < height; ++v) {
    limitRow(depth_m[v], width, static_cast<float>(config_.min_range_m), static_cast<float>(config_.max_range_m),
             maps.depth_m[v], inverse_depth_[v + kMargin] + kMargin);
  }
  if (config_.smoothing_radius_px > 0) smooth(width, height);

  const auto step = static_cast<std::ptrdiff_t>(inverse_depth_.step1());
  const auto tolerance = static_cast<float>(config_.normal_tolerance_per_m);
  const int radius = config_.normal_radius_px;
  const float needed_support = radius == 1 ? 2.0F : 10.0F;  // at least the pairs at distance 1 and 2, or one further
  const float intrinsics[] = {static_cast<float>(camera.fx), static_cast<float>(camera.fy),
                              static_cast<float>(camera.cx), static_cast<float>(camera.cy)};
  scratch_.resize(4 * static_cast<std::size_t>(width));
  float* slope_u = scratch_.data();
  float* support_u = slope_u + width;
  float* slope_v = support_u + width;
  float* support_v = slope_v + width;
  for (int v = 0; v < height; ++v) {
    const float* centre = inverse_depth_[v + kMargin] + kMargin;
    slopeRow(centre, 1, radius, width, tolerance, slope_u, support_u);
    slopeRow(centre, step, radius, width, tolerance, slope_v, support_v);
    geometryRow(centre, {slope_u, support_u, slope_v, support_v}, width, static_cast<float>(v), intrinsics,
                needed_support, maps.vertices[v][0].val, maps.normals[v][0].val);
  }
}

DepthMaps prepareDepth(const cv::Mat1f& depth_m, const PinholeCamera& camera) {
  DepthMaps maps;
  DepthPreparation().prepare(depth_m, camera, maps);
  return maps;
}

}  // namespace saccade
