#include "saccade/core/depth_maps.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>

#include "core/lanes.hpp"
#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

// Zeros around the inverse depth image: the largest radius of a window, so that no loop needs to ask for the border.
constexpr int kMargin = 8;
static_assert(kMargin >= kLanes);  // rows are read a little beyond their ends
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

// Stores the first `count` lanes, at most all of them.
SACCADE_INLINE void storeFirst(const FloatLanes& lanes, int count, float* to) {
  std::memcpy(to, &lanes, static_cast<std::size_t>(std::min(count, kLanes)) * sizeof(float));
}

// Bilateral mean of `centre[u + k * step]`, |k| <= radius, over pairs (+k, -k), each weighted by how well it lies on a
// line with the centre: a slanted plane, whose inverse depth is linear, is left as it is, at its borders too. A pair
// with a pixel that is not measured (0) bends by more than the tolerance and has no weight. Reads up to kLanes beyond.
SACCADE_MULTIVERSION
void smoothRow(const float* centre, std::ptrdiff_t step, int radius, int width, float tolerance, float* out) {
  const float scale = 1.0F / (tolerance * tolerance);
  const FloatLanes zero = {};
  for (int u = 0; u < width; u += kLanes) {
    const FloatLanes c = loadLanes(centre + u);
    FloatLanes sum = zero;  // offsets from the centre keep the float sums exact enough
    FloatLanes weight = allLanes(1.0F);
    for (int k = 1; k <= radius; ++k) {
      const FloatLanes bend = loadLanes(centre + u + k * step) + loadLanes(centre + u - k * step) - 2.0F * c;
      const FloatLanes near = most(zero, 1.0F - bend * bend * scale);
      const FloatLanes share = near * near;
      sum += share * bend;
      weight += 2.0F * share;
    }
    storeFirst(c + sum / weight, width - u, out + u);
  }
}

// Slope of the inverse depth at eight pixels along one direction, where it has `support`.
struct Slope {
  FloatLanes sum;
  FloatLanes support;
};

// Least squares slope of the inverse depth through the centre, over those pairs of pixels (+k, -k) that lie on a
// line with it: `sum` / `support`, which is the sum of 2 k^2 over the pairs used.
SACCADE_INLINE void fitSlope(const float* centre, std::ptrdiff_t step, int radius, float tolerance, Slope& slope) {
  const FloatLanes zero = {};
  const FloatLanes c = loadLanes(centre);
  slope = {zero, zero};
  for (int k = 1; k <= radius; ++k) {
    const FloatLanes ahead = loadLanes(centre + k * step), behind = loadLanes(centre - k * step);
    const auto distance = static_cast<float>(k);
    const IntLanes good = (magnitude(ahead + behind - 2.0F * c) < tolerance) & (ahead > zero) & (behind > zero);
    slope.sum += good ? distance * (ahead - behind) : zero;
    slope.support += good ? allLanes(2.0F * distance * distance) : zero;
  }
}

struct NormalWindow {
  std::ptrdiff_t row_step;
  int radius;
  float tolerance;
  float needed_support;
};

// Vertices and normals of one row. On the plane n . p = d the inverse depth is
// (n / d) . ((u - cx) / fx, (v - cy) / fy, 1): the slopes are n / d. Reads up to kLanes beyond.
SACCADE_MULTIVERSION
void geometryRow(const float* inverse, const NormalWindow& window, int width, float v, const float* intrinsics,
                 float* vertices, float* normals) {
  const float fx = intrinsics[0], fy = intrinsics[1], cx = intrinsics[2];
  const float dv = v - intrinsics[3];
  const FloatLanes zero = {};
  for (int u = 0; u < width; u += kLanes) {
    Slope along_u, along_v;
    fitSlope(inverse + u, 1, window.radius, window.tolerance, along_u);
    fitSlope(inverse + u, window.row_step, window.radius, window.tolerance, along_v);
    const FloatLanes q = loadLanes(inverse + u);
    const IntLanes measured = q > zero;
    const FloatLanes z = measured ? 1.0F / q : zero;
    const FloatLanes du = FloatLanes{0, 1, 2, 3, 4, 5, 6, 7} + (static_cast<float>(u) - cx);
    const FloatLanes x = du / fx * z, y = dv / fy * z;
    const IntLanes supported =
        measured & (along_u.support >= window.needed_support) & (along_v.support >= window.needed_support);
    const FloatLanes a = supported ? along_u.sum / along_u.support : zero;
    const FloatLanes b = supported ? along_v.sum / along_v.support : zero;
    const FloatLanes nx = a * fx, ny = b * fy, nz = q - a * du - b * dv;
    // n . p = 1 by construction, so the cosine between normal and ray is 1 / (|n| |p|), and -n faces the camera.
    const FloatLanes n_square = nx * nx + ny * ny + nz * nz;
    const FloatLanes p_square = x * x + y * y + z * z;
    const IntLanes facing = supported & (n_square * p_square * (kSmallestCosine * kSmallestCosine) < 1.0F);
    FloatLanes n_length = n_square;
    squareRoots(n_length);
    const FloatLanes scale = facing ? -1.0F / n_length : zero;
    alignas(32) float lanes[6][kLanes];
    storeLanes(x, lanes[0]);
    storeLanes(y, lanes[1]);
    storeLanes(z, lanes[2]);
    storeLanes(nx * scale, lanes[3]);
    storeLanes(ny * scale, lanes[4]);
    storeLanes(nz * scale, lanes[5]);
    for (int i = 0; i < std::min(kLanes, width - u); ++i) {
      for (int axis = 0; axis < 3; ++axis) {
        vertices[3 * (u + i) + axis] = lanes[axis][i];
        normals[3 * (u + i) + axis] = lanes[3 + axis][i];
      }
    }
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
  const NormalWindow window{step, radius, tolerance, needed_support};
  for (int v = 0; v < height; ++v) {
    geometryRow(inverse_depth_[v + kMargin] + kMargin, window, width, static_cast<float>(v), intrinsics,
                maps.vertices[v][0].val, maps.normals[v][0].val);
  }
}

DepthMaps prepareDepth(const cv::Mat1f& depth_m, const PinholeCamera& camera) {
  DepthMaps maps;
  DepthPreparation().prepare(depth_m, camera, maps);
  return maps;
}

}  // namespace saccade
