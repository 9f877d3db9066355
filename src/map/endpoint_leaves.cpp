#include "map/endpoint_leaves.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr std::int64_t kKeySpace = 65536;

/// Leaves of one row's points: floor(origin + depth * (start + u * step)) per axis. Points lie inside the cube, so
/// that the numbers are positive and truncation is floor.
SACCADE_MULTIVERSION void placeRow(const float* depth, int width, const float* origin, const float* start,
                                   const float* step, std::int32_t* x, std::int32_t* y, std::int32_t* z) {
  for (int u = 0; u < width; ++u) {
    const float d = depth[u];
    const auto fu = static_cast<float>(u);
    x[u] = static_cast<std::int32_t>(origin[0] + d * (start[0] + fu * step[0]));
    y[u] = static_cast<std::int32_t>(origin[1] + d * (start[1] + fu * step[1]));
    z[u] = static_cast<std::int32_t>(origin[2] + d * (start[2] + fu * step[2]));
  }
}

std::uint64_t spread(std::uint64_t x) {
  x &= 0x1FFFFF;
  x = (x | x << 32) & 0x1F00000000FFFF;
  x = (x | x << 16) & 0x1F0000FF0000FF;
  x = (x | x << 8) & 0x100F00F00F00F00F;
  x = (x | x << 4) & 0x10C30C30C30C30C3;
  return (x | x << 2) & 0x1249249249249249;
}

}  // namespace

std::uint64_t mortonCode(std::uint32_t x, std::uint32_t y, std::uint32_t z) {
  return spread(x) | spread(y) << 1 | spread(z) << 2;
}

FrameCube FrameCube::around(const Eigen::Vector3d& position_m, double reach_m, double leaf_size_m) {
  FrameCube cube;
  const auto reach = static_cast<std::int64_t>(std::ceil(reach_m / leaf_size_m)) + 2;
  cube.block_bits = 1;
  while (cube.block_bits < 16 && (std::int64_t{1} << cube.block_bits) < 2 * reach + 1) ++cube.block_bits;
  for (int axis = 0; axis < 3; ++axis) {
    // Far outside the key space every point is dropped, wherever exactly it is.
    const double leaves = std::clamp(position_m[axis] / leaf_size_m + 32768.0, -1e9, 1e9);
    const std::int64_t lowest = static_cast<std::int64_t>(std::floor(leaves)) - reach;
    cube.base[axis] = (lowest >> cube.block_bits) << cube.block_bits;
    cube.camera_leaves[axis] = static_cast<float>(leaves - static_cast<double>(cube.base[axis]));
  }
  return cube;
}

void EndpointLeaves::collect(const WorkingDepth& depth, const PinholeCamera& camera, const Eigen::Matrix3d& R_WC,
                             const FrameCube& cube, const cv::Mat3b& color) {
  cube_ = cube;
  hits_.clear();
  seen_.clear();
  points_ = dropped_ = 0;
  cache_.assign(kCacheSize, Cached{});
  const int width = depth.width();
  x_.resize(static_cast<std::size_t>(width));
  y_.resize(x_.size());
  z_.resize(x_.size());
  const Eigen::Vector3f step = (R_WC.col(0) / camera.fx).cast<float>();
  for (int v = 0; v < depth.height(); ++v) {
    const Eigen::Vector3f start = (R_WC * camera.unproject(0.0, v, 1.0)).cast<float>();
    placeRow(depth.row(v), width, cube.camera_leaves.data(), start.data(), step.data(), x_.data(), y_.data(),
             z_.data());
    addRow(v, depth.row(v), width, color.empty() ? nullptr : color[v]);
  }
  sortAndMerge(3 * (cube.block_bits + 1));
}

void EndpointLeaves::addRow(int v, const float* depth, int width, const cv::Vec3b* color) {
  std::uint64_t last_place = ~std::uint64_t{0};
  Seen* last = nullptr;
  for (int u = 0; u < width; ++u) {
    if (depth[u] == 0.0f) continue;
    ++points_;
    const auto x = static_cast<std::uint32_t>(x_[static_cast<std::size_t>(u)]);
    const auto y = static_cast<std::uint32_t>(y_[static_cast<std::size_t>(u)]);
    const auto z = static_cast<std::uint32_t>(z_[static_cast<std::size_t>(u)]);
    const std::uint64_t place =
        static_cast<std::uint64_t>(x) | static_cast<std::uint64_t>(y) << 21 | static_cast<std::uint64_t>(z) << 42;
    if (place != last_place) {
      last_place = place;
      const std::int64_t key[3] = {cube_.base[0] + x, cube_.base[1] + y, cube_.base[2] + z};
      if (std::any_of(key, key + 3, [](std::int64_t k) { return k < 0 || k >= kKeySpace; })) {
        last = nullptr;
      } else {
        Cached& cached = cache_[(x * 73u + y * 1031u + z * 16411u) % kCacheSize];
        if (cached.place != place) {  // seen for the first time, or so long ago that the merge must find it
          cached = {place, static_cast<std::uint32_t>(seen_.size())};
          hits_.push_back({mortonCode(x, y, z), cached.seen});
          seen_.push_back({0, 0, 0, 0, static_cast<std::uint32_t>(v * width + u), x, y, z});
        }
        last = &seen_[cached.seen];
      }
    }
    if (last == nullptr) {
      ++dropped_;
      continue;
    }
    ++last->pixels;
    if (color != nullptr) {
      last->blue += color[u][0];
      last->green += color[u][1];
      last->red += color[u][2];
    }
  }
}

void EndpointLeaves::sortAndMerge(int bits) {
  // Radix sort, least digit first: stable, so that equal codes stay in raster order and the merge is deterministic.
  constexpr int kDigitBits = 12;
  constexpr std::size_t kDigits = std::size_t{1} << kDigitBits;
  sorted_.resize(hits_.size());
  for (int shift = 0; shift < bits; shift += kDigitBits) {
    std::array<std::uint32_t, kDigits> start{};
    for (const Hit& hit : hits_) ++start[hit.code >> shift & (kDigits - 1)];
    std::uint32_t sum = 0;
    for (std::uint32_t& s : start) {
      const std::uint32_t n = s;
      s = sum;
      sum += n;
    }
    for (const Hit& hit : hits_) sorted_[start[hit.code >> shift & (kDigits - 1)]++] = hit;
    std::swap(hits_, sorted_);
  }
  std::size_t kept = 0;
  for (const Hit& hit : hits_) {
    if (kept > 0 && hits_[kept - 1].code == hit.code) {
      Seen& into = seen_[hits_[kept - 1].seen];
      const Seen& from = seen_[hit.seen];
      into.blue += from.blue;
      into.green += from.green;
      into.red += from.red;
      into.pixels += from.pixels;
    } else {
      hits_[kept++] = hit;
    }
  }
  hits_.resize(kept);
}

}  // namespace saccade
