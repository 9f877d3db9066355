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

#include "saccade/core/multiversion.hpp"
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

/// A pixel of the halved image; its place is kept with its index, which would cost a division to take apart.
struct Pixel {
  int index = 0;
  int u = 0, v = 0;
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

SACCADE_MULTIVERSION void markWaiting(const int* labels, const float* inverse_depth, int columns, char* waiting) {
  for (int x = 0; x < columns; ++x) {
    waiting[x] = static_cast<char>((labels[x] == kFree) & (inverse_depth[x] > 0.0F));
  }
}

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
        least_pixels(std::max(1, config.min_size / 4)),
        least_size(config.min_size) {}

  void sortSeeds();
  void growPatches(float most_curvature);
  int growPatch(Pixel seed, int label);
  void takeNeighbours(Pixel pixel, int label);
  void refit(Pixel seed);
  void queueRim();
  void absorbRest();
  void assignPixels(const cv::Mat1f& depth_m, cv::Mat1i& out);
  [[nodiscard]] int patchOf(const std::array<int, 4>& blocks, float q, float u, float v) const;
  int numberPatches(cv::Mat1i& out);

  // Depth tolerances at 1 m are tolerances of inverse depth, in 1/m, at any depth.
  float max_distance, max_step, least_cosine;
  int least_pixels;  ///< of the halved image
  int least_size;    ///< px

  SurfaceFits fits;
  int width = 0, height = 0;
  std::vector<int> labels;     ///< patch per pixel, kFree = none
  std::vector<int> seeds;      ///< pixels with a normal, by rising curvature
  std::vector<int> positions;  ///< scratch of sorting the seeds, and final numbers of patches
  std::vector<Pixel> queue;    ///< pixels of the patch that grows, in the order taken
  std::vector<Pixel> refused;  ///< pixels of the patch with neighbours that did not fit when met
  std::vector<Pixel> again;    ///< those while they are tried again
  std::vector<char> waiting;   ///< measured pixels in no patch, with a margin of a pixel
  std::vector<Plane> planes;   ///< per patch
  std::vector<int> sizes;      ///< full-size pixels of no patch, then per patch
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
    if (growPatch({seed, seed % width, seed / width}, label) >= least_pixels) {
      planes.push_back(plane);
      continue;
    }
    for (const Pixel& pixel : queue) {  // later patches may take these points
      labels[static_cast<std::size_t>(pixel.index)] = kFree;
      hopeless[static_cast<std::size_t>(pixel.index)] = 1;
    }
  }
}

/// Grows a patch from its seed; returns its pixels, which are in `queue`.
int SurfaceSegmenter::Scratch::growPatch(Pixel seed, int label) {
  const std::size_t s = static_cast<std::size_t>(seed.index);
  const auto u = static_cast<float>(seed.u), v = static_cast<float>(seed.v);
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
      const Pixel pixel = queue[next];
      sums.add(pixel.u - seed.u, pixel.v - seed.v,
               static_cast<double>(fits.inverseDepth()[static_cast<std::size_t>(pixel.index)]));
      if (next + 1 == refit_at) {
        refit(seed);
        refit_at *= 2;
      }
      takeNeighbours(pixel, label);
    }
    // With the last plane some points fit that did not fit an earlier one.
    refit(seed);
    const std::size_t before = queue.size();
    again.swap(refused);
    refused.clear();
    for (const Pixel& pixel : again) {
      takeNeighbours(pixel, label);
    }
    if (queue.size() == before) {
      break;
    }
  }
  return static_cast<int>(queue.size());
}

void SurfaceSegmenter::Scratch::refit(Pixel seed) {
  Eigen::Vector3d fitted;
  if (sums.n < 16.0 || !sums.fit(fitted)) {
    return;
  }
  const double u = seed.u, v = seed.v;
  const double c = fitted[2] - fitted[0] * u - fitted[1] * v;
  plane = {static_cast<float>(fitted[0]), static_cast<float>(fitted[1]), static_cast<float>(c)};
  const PinholeCamera& camera = fits.camera();
  const Eigen::Vector3d n =
      Eigen::Vector3d(fitted[0] * camera.fx, fitted[1] * camera.fy, c + fitted[0] * camera.cx + fitted[1] * camera.cy)
          .normalized();
  normal = {static_cast<float>(n.x()), static_cast<float>(n.y()), static_cast<float>(n.z())};
}

void SurfaceSegmenter::Scratch::takeNeighbours(Pixel pixel, int label) {
  const int u = pixel.u, v = pixel.v;
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
      queue.push_back({other, x, y});
    } else {
      any_refused = true;
    }
  }
  if (any_refused) {
    refused.push_back(pixel);
  }
}

/// Queues the pixels of patches that have measured neighbours in none, in row order.
void SurfaceSegmenter::Scratch::queueRim() {
  const std::vector<float>& inverse_depth = fits.inverseDepth();
  const std::ptrdiff_t stride = width + 2;
  waiting.assign(static_cast<std::size_t>(stride * (height + 2)), 0);
  for (std::ptrdiff_t v = 0; v < height; ++v) {
    char* row = waiting.data() + (v + 1) * stride + 1;
    markWaiting(labels.data() + v * width, inverse_depth.data() + v * width, width, row);
  }
  queue.clear();
  for (int v = 0; v < height; ++v) {
    const char* row = waiting.data() + (v + 1) * stride + 1;
    const int* row_labels = labels.data() + static_cast<std::ptrdiff_t>(v) * width;
    for (int u = 0; u < width; ++u) {
      if ((row[u - 1] | row[u + 1] | row[u - stride] | row[u + stride]) != 0 && row_labels[u] != kFree) {
        queue.push_back({v * width + u, u, v});
      }
    }
  }
}

/// Gives points without a normal, or with one blurred across a crease, to the neighbouring patch whose plane they fit
/// best.
void SurfaceSegmenter::Scratch::absorbRest() {
  const std::vector<float>& inverse_depth = fits.inverseDepth();
  queueRim();
  for (std::size_t next = 0; next < queue.size(); ++next) {
    const int u = queue[next].u, v = queue[next].v;
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
        queue.push_back({other, x, y});
      }
    }
  }
}

/// Back to full size: a pixel takes the patch of its block, or of the block beside it, if it lies in the plane.
void SurfaceSegmenter::Scratch::assignPixels(const cv::Mat1f& depth_m, cv::Mat1i& out) {
  out.create(depth_m.size());
  sizes.assign(planes.size() + 1, 0);  // the first counts the pixels of no patch
  for (int y = 0; y < depth_m.rows; ++y) {
    const float* row = depth_m[y];
    int* row_out = out[y];
    const int v = y / 2, v_beside = std::clamp(v + (y % 2 == 0 ? -1 : 1), 0, height - 1);
    const auto plane_v = static_cast<float>(0.5 * y - 0.25);
    int run_label = kFree, run = 0;  // counted run by run: a count cannot be read again as soon as it is written
    for (int x = 0; x < depth_m.cols; ++x) {
      int label = kFree;
      if (row[x] > 0.0F) {
        const int u = x / 2, u_beside = std::clamp(u + (x % 2 == 0 ? -1 : 1), 0, width - 1);
        label = patchOf({v * width + u, v * width + u_beside, v_beside * width + u, v_beside * width + u_beside},
                        1.0F / row[x], static_cast<float>(0.5 * x - 0.25), plane_v);
      }
      row_out[x] = label;
      if (label != run_label) {
        sizes[static_cast<std::size_t>(run_label + 1)] += run;
        run_label = label;
        run = 0;
      }
      ++run;
    }
    sizes[static_cast<std::size_t>(run_label + 1)] += run;
  }
}

/// The patch of the first of some blocks in whose plane a pixel of inverse depth q lies.
int SurfaceSegmenter::Scratch::patchOf(const std::array<int, 4>& blocks, float q, float u, float v) const {
  for (const int block : blocks) {
    const int label = labels[static_cast<std::size_t>(block)];
    if (label != kFree && std::abs(q - planes[static_cast<std::size_t>(label)].at(u, v)) <= 1.5F * max_distance) {
      return label;
    }
  }
  return kFree;
}

/// Numbers the patches by first pixel, without those that are too small; returns their number.
int SurfaceSegmenter::Scratch::numberPatches(cv::Mat1i& out) {
  constexpr int kUnnumbered = -2;
  positions.assign(planes.size() + 1, kUnnumbered);
  positions[0] = kFree;
  for (std::size_t label = 0; label < planes.size(); ++label) {
    if (sizes[label + 1] < least_size) {
      positions[label + 1] = kFree;
    }
  }
  int count = 0;
  for (int y = 0; y < out.rows; ++y) {
    int* row = out[y];
    for (int x = 0; x < out.cols; ++x) {
      int& number = positions[static_cast<std::size_t>(row[x] + 1)];
      if (number == kUnnumbered) {
        number = count++;
      }
      row[x] = number;
    }
  }
  return count;
}

SurfaceSegmenter::SurfaceSegmenter(SurfaceSegmentsConfig config) : config_(config) {
  requireValid(config_);
  scratch_ = std::make_unique<Scratch>(config_);
}

SurfaceSegmenter::~SurfaceSegmenter() = default;
SurfaceSegmenter::SurfaceSegmenter(SurfaceSegmenter&&) noexcept = default;
SurfaceSegmenter& SurfaceSegmenter::operator=(SurfaceSegmenter&&) noexcept = default;

const Segmentation& SurfaceSegmenter::segment(const DepthMaps& depth) {
  segment(depth, segmentation_);
  return segmentation_;
}

void SurfaceSegmenter::segment(const DepthMaps& depth, Segmentation& segmentation) {
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

  s.assignPixels(depth_m, segmentation.labels);
  segmentation.count = s.numberPatches(segmentation.labels);
}

}  // namespace saccade
