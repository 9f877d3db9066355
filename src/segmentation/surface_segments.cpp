#include "saccade/segmentation/surface_segments.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include <Eigen/Dense>

#include "segmentation/surface_fits.hpp"

namespace saccade {
namespace {

constexpr int kFree = -1;
constexpr int kCurvatureSteps = 512;
/// Curvatures, 1 - cos, up to which pixels start patches: 20° first; when what fits those patches is taken, 60°.
/// Otherwise the band along a crease, where windows blur two normals into one, would make patches of its own.
constexpr std::array<float, 2> kSeedCurvatures = {0.06F, 0.5F};

/// A plane as inverse depth over pixels of the halved image: q = a u + b v + c, in 1/m.
struct Plane {
  float a = 0.0F, b = 0.0F, c = 0.0F;
  [[nodiscard]] float at(float u, float v) const { return a * u + b * v + c; }
};

/// Sums of a growing patch about its seed, from which its plane is fitted.
struct PatchSums {
  double n = 0, u = 0, v = 0, uu = 0, uv = 0, vv = 0, q = 0, uq = 0, vq = 0;

  void add(double du, double dv, double value) {
    n += 1.0;
    u += du;
    v += dv;
    uu += du * du;
    uv += du * dv;
    vv += dv * dv;
    q += value;
    uq += du * value;
    vq += dv * value;
  }

  /// Least squares plane relative to the seed; false if the pixels lie on a line.
  [[nodiscard]] bool fit(Eigen::Vector3d& plane) const {
    Eigen::Matrix3d moments;
    moments << uu, uv, u, uv, vv, v, u, v, n;
    const Eigen::LDLT<Eigen::Matrix3d> solver(moments);
    if (!(uu * vv - uv * uv > 1e-6 * n * n)) {
      return false;
    }
    plane = solver.solve(Eigen::Vector3d(uq, vq, q));
    return plane.allFinite();
  }
};

}  // namespace

void SurfaceSegmentsConfig::describe(ConfigVisitor& visitor) {
  visitor.number("max_normal_angle_deg", max_normal_angle_deg, {1.0, 80.0}, "deg",
                 "between a point's normal and its patch's");
  visitor.number("max_plane_distance_m", max_plane_distance_m, {1e-4, 0.2}, "m",
                 "of a point from its patch's plane at 1 m, grows with depth squared");
  visitor.number("max_depth_step_m", max_depth_step_m, {1e-4, 0.5}, "m",
                 "beyond the slope, where a surface still goes on, at 1 m, grows with depth squared");
  visitor.integer("min_size", min_size, {1, 1e9}, "px", "smaller patches are noise");
}

/// The work of one object; all images are of half the depth image's size.
struct SurfaceSegmenter::Scratch {
  explicit Scratch(const SurfaceSegmentsConfig& config)
      : max_distance(static_cast<float>(config.max_plane_distance_m)),
        max_step(static_cast<float>(config.max_depth_step_m)),
        least_cosine(static_cast<float>(std::cos(config.max_normal_angle_deg * std::numbers::pi / 180.0))),
        least_pixels(std::max(1, config.min_size / 4)) {}

  void sortSeeds();
  void growPatches(float most_curvature);
  int growPatch(int seed, int label);
  void takeNeighbours(int pixel, int label);
  void refit(int seed);
  void absorbRest();

  // Depth tolerances at 1 m are tolerances of inverse depth, in 1/m, at any depth.
  float max_distance, max_step, least_cosine;
  int least_pixels;

  SurfaceFits fits;
  int width = 0, height = 0;
  std::vector<int> labels;     ///< patch per pixel, kFree = none
  std::vector<int> seeds;      ///< pixels with a normal, by rising curvature
  std::vector<int> positions;  ///< scratch of sorting the seeds, and final numbers of patches
  std::vector<int> queue;      ///< pixels of the patch that grows, in the order taken
  std::vector<int> refused;    ///< neighbours of the patch that did not fit when met
  std::vector<Plane> planes;   ///< per patch
  std::vector<int> sizes;      ///< full-size pixels per patch
  std::vector<char> hopeless;  ///< tried as a seed or in a patch too small: starts no other

  // The patch that grows.
  PatchSums sums;
  Plane plane;
  SurfaceNormal normal;
};

void SurfaceSegmenter::Scratch::sortSeeds() {
  const std::vector<float>& curvatures = fits.curvatures();
  const auto stepOf = [](float curvature) {
    // Finer steps for flat surfaces: by the angle, not its cosine.
    return std::min(kCurvatureSteps - 1, static_cast<int>(std::sqrt(std::max(0.0F, curvature)) * 700.0F));
  };
  positions.assign(kCurvatureSteps + 1, 0);
  for (const float curvature : curvatures) {
    if (curvature <= kSeedCurvatures.back()) {
      ++positions[static_cast<std::size_t>(stepOf(curvature)) + 1];
    }
  }
  for (std::size_t i = 1; i < positions.size(); ++i) {
    positions[i] += positions[i - 1];
  }
  seeds.resize(static_cast<std::size_t>(positions.back()));
  for (std::size_t i = 0; i < curvatures.size(); ++i) {
    if (curvatures[i] <= kSeedCurvatures.back()) {
      seeds[static_cast<std::size_t>(positions[static_cast<std::size_t>(stepOf(curvatures[i]))]++)] =
          static_cast<int>(i);
    }
  }
}

void SurfaceSegmenter::Scratch::growPatches(float most_curvature) {
  for (const int seed : seeds) {
    if (fits.curvatures()[static_cast<std::size_t>(seed)] > most_curvature) {
      return;
    }
    if (labels[static_cast<std::size_t>(seed)] != kFree || hopeless[static_cast<std::size_t>(seed)] != 0) {
      continue;
    }
    const int label = static_cast<int>(planes.size());
    if (growPatch(seed, label) >= least_pixels) {
      planes.push_back(plane);
      continue;
    }
    for (const int pixel : queue) {  // later patches may take these points
      labels[static_cast<std::size_t>(pixel)] = kFree;
      hopeless[static_cast<std::size_t>(pixel)] = 1;
    }
  }
}

/// Grows a patch from its seed; returns its pixels, which are in `queue`.
int SurfaceSegmenter::Scratch::growPatch(int seed, int label) {
  const std::size_t s = static_cast<std::size_t>(seed);
  const auto u = static_cast<float>(seed % width), v = static_cast<float>(seed / width);
  const cv::Vec2f gradient = fits.gradients()[s];
  normal = fits.normals()[s];
  plane = {gradient[0], gradient[1], fits.inverseDepth()[s] - gradient[0] * u - gradient[1] * v};
  sums = {};
  queue.assign(1, seed);
  refused.clear();
  labels[s] = label;
  std::size_t refit_at = 32;
  for (std::size_t next = 0;;) {
    for (; next < queue.size(); ++next) {
      const int pixel = queue[next];
      sums.add(pixel % width - seed % width, pixel / width - seed / width,
               static_cast<double>(fits.inverseDepth()[static_cast<std::size_t>(pixel)]));
      if (next + 1 == refit_at) {
        refit(seed);
        refit_at *= 2;
      }
      takeNeighbours(pixel, label);
    }
    // With the last plane some points fit that did not fit an earlier one.
    refit(seed);
    const std::size_t before = queue.size();
    std::vector<int> again;
    again.swap(refused);
    for (const int pixel : again) {
      takeNeighbours(pixel, label);
    }
    if (queue.size() == before) {
      break;
    }
  }
  return static_cast<int>(queue.size());
}

void SurfaceSegmenter::Scratch::refit(int seed) {
  Eigen::Vector3d fitted;
  if (sums.n < 16.0 || !sums.fit(fitted)) {
    return;
  }
  const double u = seed % width, v = seed / width;
  const double c = fitted[2] - fitted[0] * u - fitted[1] * v;
  plane = {static_cast<float>(fitted[0]), static_cast<float>(fitted[1]), static_cast<float>(c)};
  const PinholeCamera& camera = fits.camera();
  const Eigen::Vector3d n =
      Eigen::Vector3d(fitted[0] * camera.fx, fitted[1] * camera.fy, c + fitted[0] * camera.cx + fitted[1] * camera.cy)
          .normalized();
  normal = {static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z())};
}

void SurfaceSegmenter::Scratch::takeNeighbours(int pixel, int label) {
  const int u = pixel % width, v = pixel / width;
  const std::array<std::array<int, 2>, 4> around{{{u - 1, v}, {u + 1, v}, {u, v - 1}, {u, v + 1}}};
  bool any_refused = false;
  for (const auto& [x, y] : around) {
    if (x < 0 || y < 0 || x >= width || y >= height) {
      continue;
    }
    const int other = y * width + x;
    const std::size_t o = static_cast<std::size_t>(other);
    const SurfaceNormal& n = fits.normals()[o];
    if (labels[o] != kFree || n.z == 0.0F) {
      continue;
    }
    const float q = fits.inverseDepth()[o];
    const bool fits_plane = std::abs(q - plane.at(static_cast<float>(x), static_cast<float>(y))) <= max_distance &&
                            n.x * normal.x + n.y * normal.y + n.z * normal.z >= least_cosine;
    if (fits_plane) {
      labels[o] = label;
      queue.push_back(other);
    } else {
      any_refused = true;
    }
  }
  if (any_refused) {
    refused.push_back(pixel);
  }
}

/// Gives points without a normal, or with one blurred across a crease, to the neighbouring patch whose plane they fit
/// best.
void SurfaceSegmenter::Scratch::absorbRest() {
  const std::vector<float>& inverse_depth = fits.inverseDepth();
  queue.clear();
  for (int i = 0; i < static_cast<int>(labels.size()); ++i) {
    if (labels[static_cast<std::size_t>(i)] != kFree) {
      queue.push_back(i);
    }
  }
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const int pixel = queue[next];
    const int u = pixel % width, v = pixel / width;
    const std::array<std::array<int, 2>, 4> around{{{u - 1, v}, {u + 1, v}, {u, v - 1}, {u, v + 1}}};
    for (const auto& [x, y] : around) {
      if (x < 0 || y < 0 || x >= width || y >= height) {
        continue;
      }
      const int other = y * width + x;
      const float q = inverse_depth[static_cast<std::size_t>(other)];
      if (labels[static_cast<std::size_t>(other)] != kFree || !(q > 0.0F)) {
        continue;
      }
      const std::array<std::array<int, 2>, 4> beside{{{x - 1, y}, {x + 1, y}, {x, y - 1}, {x, y + 1}}};
      float best = max_distance;
      int best_label = kFree;
      for (const auto& [s, t] : beside) {
        if (s < 0 || t < 0 || s >= width || t >= height) {
          continue;
        }
        const int label = labels[static_cast<std::size_t>(t * width + s)];
        if (label == kFree) {
          continue;
        }
        const float distance =
            std::abs(q - planes[static_cast<std::size_t>(label)].at(static_cast<float>(x), static_cast<float>(y)));
        if (distance <= best) {
          best = distance;
          best_label = label;
        }
      }
      if (best_label != kFree) {
        labels[static_cast<std::size_t>(other)] = best_label;
        queue.push_back(other);
      }
    }
  }
}

SurfaceSegmenter::SurfaceSegmenter(SurfaceSegmentsConfig config) : config_(config) {
  requireValid(config_);
  scratch_ = std::make_unique<Scratch>(config_);
}

SurfaceSegmenter::~SurfaceSegmenter() = default;
SurfaceSegmenter::SurfaceSegmenter(SurfaceSegmenter&&) noexcept = default;
SurfaceSegmenter& SurfaceSegmenter::operator=(SurfaceSegmenter&&) noexcept = default;

const Segmentation& SurfaceSegmenter::segment(const DepthMaps& depth) {
  const cv::Mat1f& depth_m = depth.depth_m;
  if (depth_m.empty() || depth_m.cols != depth.camera.width || depth_m.rows != depth.camera.height) {
    throw std::invalid_argument("surface segments: expected depth of the camera's size " +
                                std::to_string(depth.camera.width) + " x " + std::to_string(depth.camera.height) +
                                ", found " + std::to_string(depth_m.cols) + " x " + std::to_string(depth_m.rows));
  }
  Scratch& s = *scratch_;
  s.fits.compute(depth, s.max_step);
  s.width = s.fits.width();
  s.height = s.fits.height();
  const std::size_t pixels = s.fits.inverseDepth().size();
  s.labels.assign(pixels, kFree);
  s.hopeless.assign(pixels, 0);
  s.sortSeeds();
  s.planes.clear();
  for (const float most_curvature : kSeedCurvatures) {
    s.growPatches(most_curvature);
    s.absorbRest();
  }

  // Back to full size: a pixel takes the patch of its block, or of the block beside it, if it lies in the plane.
  segmentation_.labels.create(depth_m.size());
  s.sizes.assign(s.planes.size(), 0);
  for (int y = 0; y < depth_m.rows; ++y) {
    const float* row = depth_m[y];
    int* out = segmentation_.labels[y];
    const int v = y / 2, v_beside = std::clamp(v + (y % 2 == 0 ? -1 : 1), 0, s.height - 1);
    const auto plane_v = static_cast<float>(0.5 * y - 0.25);
    for (int x = 0; x < depth_m.cols; ++x) {
      out[x] = kFree;
      if (!(row[x] > 0.0F)) {
        continue;
      }
      const float q = 1.0F / row[x], plane_u = static_cast<float>(0.5 * x - 0.25);
      const int u = x / 2, u_beside = std::clamp(u + (x % 2 == 0 ? -1 : 1), 0, s.width - 1);
      const std::array<int, 4> blocks{v * s.width + u, v * s.width + u_beside, v_beside * s.width + u,
                                      v_beside * s.width + u_beside};
      for (const int block : blocks) {
        const int label = s.labels[static_cast<std::size_t>(block)];
        if (label != kFree &&
            std::abs(q - s.planes[static_cast<std::size_t>(label)].at(plane_u, plane_v)) <= 1.5F * s.max_distance) {
          out[x] = label;
          ++s.sizes[static_cast<std::size_t>(label)];
          break;
        }
      }
    }
  }

  // Number by first pixel, without the patches that are too small.
  s.positions.assign(s.planes.size(), kFree);
  segmentation_.count = 0;
  for (int y = 0; y < depth_m.rows; ++y) {
    int* out = segmentation_.labels[y];
    for (int x = 0; x < depth_m.cols; ++x) {
      if (out[x] == kFree) {
        continue;
      }
      const std::size_t label = static_cast<std::size_t>(out[x]);
      if (s.sizes[label] < config_.min_size) {
        out[x] = kFree;
        continue;
      }
      if (s.positions[label] == kFree) {
        s.positions[label] = segmentation_.count++;
      }
      out[x] = s.positions[label];
    }
  }
  return segmentation_;
}

}  // namespace saccade
