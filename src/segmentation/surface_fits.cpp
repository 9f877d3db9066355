#include "segmentation/surface_fits.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kLeastRadius = 2;  // 5 x 5 pixels of the halved image; less gives noise
constexpr int kMostRadius = 6;

/// Window in which noise tilts a normal by a few degrees: the tilt grows with depth and falls with the window's area.
int wantedRadius(float inverse_depth) {
  return std::clamp(static_cast<int>(2.0F + 1.2F / inverse_depth), kLeastRadius + 1, kMostRadius);
}

/// Mean inverse depth of 2 x 2 depths, of those within `max_difference` of the nearest one; 0 if none is measured.
SACCADE_MULTIVERSION void halveRows(const float* upper, const float* lower, float max_difference, int columns,
                                    float* out) {
  for (int x = 0; x < columns; ++x) {
    const float a = upper[2 * x], b = upper[2 * x + 1], c = lower[2 * x], d = lower[2 * x + 1];
    const float qa = a > 0.0F ? 1.0F / a : 0.0F, qb = b > 0.0F ? 1.0F / b : 0.0F;
    const float qc = c > 0.0F ? 1.0F / c : 0.0F, qd = d > 0.0F ? 1.0F / d : 0.0F;
    const float ab = qa > qb ? qa : qb, cd = qc > qd ? qc : qd;
    const float nearest = ab > cd ? ab : cd;
    const float least = nearest - max_difference > 1e-6F ? nearest - max_difference : 1e-6F;
    const float na = qa >= least ? 1.0F : 0.0F, nb = qb >= least ? 1.0F : 0.0F;
    const float nc = qc >= least ? 1.0F : 0.0F, nd = qd >= least ? 1.0F : 0.0F;
    const float count = na + nb + nc + nd;
    out[x] = count > 0.0F ? (na * qa + nb * qb + nc * qc + nd * qd) / count : 0.0F;
  }
}

SACCADE_MULTIVERSION void limitAtHoles(const float* q, int columns, std::int8_t whole, std::int8_t* radii) {
  for (int x = 1; x + 1 < columns; ++x) {
    radii[x] = q[x] > 0.0F ? whole : std::int8_t{-1};
  }
}

/// Marks where the surface breaks between a pixel and the next along `stride`: a difference unlike those on both sides.
/// On a steep surface neighbours differ as much, but evenly.
SACCADE_MULTIVERSION void markBreaks(const float* q, std::ptrdiff_t stride, float max_step, int first, int end,
                                     std::int8_t* breaks) {
  const float *q0 = q - stride, *q1 = q, *q2 = q + stride, *q3 = q + 2 * stride;
  for (int x = first; x < end; ++x) {
    const float step = q2[x] - q1[x];
    const float bend = std::abs(step - (q1[x] - q0[x])), next_bend = std::abs(step - (q3[x] - q2[x]));
    const float least = bend < next_bend ? bend : next_bend;
    breaks[x] = least > max_step ? std::int8_t{1} : std::int8_t{0};
  }
}

/// Windows end at breaks, on both sides; `radii` are -1 at holes and stay so.
SACCADE_MULTIVERSION void limitAtBreaks(const std::int8_t* breaks, int first, int end, std::int8_t* radii,
                                        std::int8_t* next_radii) {
  for (int x = first; x < end; ++x) {
    radii[x] = breaks[x] != 0 && radii[x] > 0 ? std::int8_t{0} : radii[x];
  }
  for (int x = first; x < end; ++x) {
    next_radii[x] = breaks[x] != 0 && next_radii[x] > 0 ? std::int8_t{0} : next_radii[x];
  }
}

}  // namespace

void SurfaceFits::compute(const DepthMaps& depth, float max_step) {
  const int width = (depth.depth_m.cols + 1) / 2, height = (depth.depth_m.rows + 1) / 2;
  if (width != width_ || height != height_) {
    width_ = width;
    height_ = height;
    const std::size_t pixels = static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    inverse_depth_.resize(pixels);
    radii_.resize(pixels);
    sums_.assign(static_cast<std::size_t>(width + 1) * static_cast<std::size_t>(height + 1), Sums());
    normals_.resize(pixels);
    gradients_.resize(pixels);
    curvatures_.resize(pixels);
  }
  camera_ = depth.camera.reducedBy(2);
  halve(depth.depth_m, 1.5F * max_step);  // neighbours on a steep surface differ by more than its tolerance
  limitWindows(max_step);
  integrate();
  fitPlanes();
  measureCurvature();
}

void SurfaceFits::halve(const cv::Mat1f& depth_m, float max_difference) {
  for (int y = 0; y < height_; ++y) {
    const float* upper = depth_m[2 * y];
    const float* lower = depth_m[std::min(2 * y + 1, depth_m.rows - 1)];
    float* out = inverse_depth_.data() + static_cast<std::ptrdiff_t>(y) * width_;
    halveRows(upper, lower, max_difference, depth_m.cols / 2, out);
    if (depth_m.cols % 2 == 1) {
      const float pair_upper[2] = {upper[depth_m.cols - 1], upper[depth_m.cols - 1]};
      const float pair_lower[2] = {lower[depth_m.cols - 1], lower[depth_m.cols - 1]};
      halveRows(pair_upper, pair_lower, max_difference, 1, out + width_ - 1);
    }
  }
}

/// Distance (in rows or columns, whichever is more) to the nearest pixel beyond which the surface ends.
void SurfaceFits::limitWindows(float max_step) {
  const std::ptrdiff_t width = width_;
  std::fill(radii_.begin(), radii_.end(), std::int8_t{0});  // stays at the border
  breaks_.resize(radii_.size());
  for (std::ptrdiff_t y = 1; y + 1 < height_; ++y) {
    const float* q = inverse_depth_.data() + y * width;
    std::int8_t* row = radii_.data() + y * width;
    std::int8_t* breaks = breaks_.data() + y * width;
    limitAtHoles(q, width_, std::int8_t{kMostRadius + 1}, row);
    if (width_ > 4) {
      markBreaks(q, 1, max_step, 1, width_ - 2, breaks);
      limitAtBreaks(breaks, 1, width_ - 2, row, row + 1);
    }
    if (y > 1 && y + 2 < height_) {  // the break between the row above and this one
      markBreaks(q - width, width, max_step, 0, width_, breaks);
      limitAtBreaks(breaks, 0, width_, row - width, row);
    }
  }
  const auto closer = [](std::int8_t here, int other) {
    return static_cast<std::int8_t>(std::min<int>(here, other + 1));
  };
  for (std::ptrdiff_t y = 1; y < height_; ++y) {
    std::int8_t* row = radii_.data() + y * width;
    for (std::ptrdiff_t x = 1; x + 1 < width; ++x) {
      const std::int8_t* above = row - width + x;
      row[x] = closer(row[x], std::min(std::min(above[-1], above[0]), std::min(above[1], row[x - 1])));
    }
  }
  for (std::ptrdiff_t y = height_ - 2; y >= 0; --y) {
    std::int8_t* row = radii_.data() + y * width;
    for (std::ptrdiff_t x = width - 2; x > 0; --x) {
      const std::int8_t* below = row + width + x;
      row[x] = closer(row[x], std::min(std::min(below[-1], below[0]), std::min(below[1], row[x + 1])));
    }
  }
}

void SurfaceFits::integrate() {
  for (int y = 0; y < height_; ++y) {
    const float* in = inverse_depth_.data() + static_cast<std::ptrdiff_t>(y) * width_;
    const Sums* above = sums_.data() + static_cast<std::ptrdiff_t>(y) * (width_ + 1) + 1;
    Sums* here = sums_.data() + static_cast<std::ptrdiff_t>(y + 1) * (width_ + 1) + 1;
    double q = 0.0, uq = 0.0;
    for (int x = 0; x < width_; ++x) {
      const double value = in[x];
      q += value;
      uq += x * value;
      here[x] = {above[x].q + q, above[x].uq + uq, above[x].vq + y * q};
    }
  }
}

/// Least squares over each pixel's window, which is full: sums over u and v are known beforehand.
void SurfaceFits::fitPlanes() {
  std::array<double, kMostRadius + 1> inverse_count{}, inverse_spread{};
  for (int r = 1; r <= kMostRadius; ++r) {
    const double n = 2 * r + 1;
    inverse_count[static_cast<std::size_t>(r)] = 1.0 / (n * n);
    inverse_spread[static_cast<std::size_t>(r)] = 3.0 / (n * n * r * (r + 1.0));
  }
  const auto fx = static_cast<float>(camera_.fx), fy = static_cast<float>(camera_.fy);
  const auto cx = static_cast<float>(camera_.cx), cy = static_cast<float>(camera_.cy);
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
      normals_[i] = {};
      if (radii_[i] < kLeastRadius) {
        continue;
      }
      const int r = std::min<int>(radii_[i], wantedRadius(inverse_depth_[i]));
      const Sums* top = sums_.data() + static_cast<std::ptrdiff_t>(y - r) * (width_ + 1) + x - r;
      const Sums* bottom = top + static_cast<std::ptrdiff_t>(2 * r + 1) * (width_ + 1);
      const int side = 2 * r + 1;
      const double q = (bottom[side].q - bottom[0].q) - (top[side].q - top[0].q);
      const double uq = (bottom[side].uq - bottom[0].uq) - (top[side].uq - top[0].uq);
      const double vq = (bottom[side].vq - bottom[0].vq) - (top[side].vq - top[0].vq);
      const double spread = inverse_spread[static_cast<std::size_t>(r)];
      const auto a = static_cast<float>((uq - x * q) * spread);
      const auto b = static_cast<float>((vq - y * q) * spread);
      const auto mean = static_cast<float>(q * inverse_count[static_cast<std::size_t>(r)]);
      const float nx = a * fx, ny = b * fy;
      const float nz = mean - a * (static_cast<float>(x) - cx) - b * (static_cast<float>(y) - cy);
      const float scale = 1.0F / std::sqrt(nx * nx + ny * ny + nz * nz);
      normals_[i] = {nx * scale, ny * scale, nz * scale == 0.0F ? 1e-9F : nz * scale};
      gradients_[i] = {a, b};
    }
  }
}

void SurfaceFits::measureCurvature() {
  constexpr float kNone = 2.0F;
  for (int y = 0; y < height_; ++y) {
    for (int x = 0; x < width_; ++x) {
      const std::size_t i =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) + static_cast<std::size_t>(x);
      curvatures_[i] = kNone;
      if (normals_[i].z == 0.0F) {
        continue;
      }
      const int r = std::min<int>(radii_[i], wantedRadius(inverse_depth_[i]));
      const std::ptrdiff_t across[2] = {r, static_cast<std::ptrdiff_t>(r) * width_};
      float curvature = 0.0F;
      for (const std::ptrdiff_t step : across) {
        const SurfaceNormal* here = normals_.data() + i;
        const SurfaceNormal& a = here[-step].z == 0.0F ? *here : here[-step];
        const SurfaceNormal& b = here[step].z == 0.0F ? *here : here[step];
        curvature = std::max(curvature, 1.0F - (a.x * b.x + a.y * b.y + a.z * b.z));
      }
      // Pixels at the end of a surface see one side only: they start a patch only where nothing better is left.
      curvatures_[i] = curvature + (radii_[i] < kLeastRadius + 1 ? 0.05F : 0.0F);
    }
  }
}

}  // namespace saccade
