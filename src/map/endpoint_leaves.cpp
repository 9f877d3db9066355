#include "map/endpoint_leaves.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr std::int64_t kKeySpace = 65536;

/// A pixel without a point, in the place of a place.
constexpr std::uint64_t kNoPlace = ~std::uint64_t{0};

/// So many leaves ahead the merge fetches what was seen of one, which lies somewhere else.
constexpr std::size_t kPrefetched = 16;

std::uint32_t xOf(std::uint64_t place) {
  return static_cast<std::uint32_t>(place & 0x1FFFFF);
}
std::uint32_t yOf(std::uint64_t place) {
  return static_cast<std::uint32_t>(place >> 21 & 0x1FFFFF);
}
std::uint32_t zOf(std::uint64_t place) {
  return static_cast<std::uint32_t>(place >> 42);
}

/// Leaves of one row's points, floor(origin + depth * (start + u * step)) per axis, as x | y << 21 | z << 42. Points
/// lie inside the cube, so that the numbers are positive and truncation is floor.
SACCADE_MULTIVERSION void placeRow(const float* depth, int width, const float* origin, const float* start,
                                   const float* step, std::uint64_t* place) {
  const float ox = origin[0], oy = origin[1], oz = origin[2];
  const float ax = start[0], ay = start[1], az = start[2];
  const float bx = step[0], by = step[1], bz = step[2];
  for (int u = 0; u < width; ++u) {
    const float d = depth[u];
    const auto fu = static_cast<float>(u);
    const auto x = static_cast<std::uint32_t>(static_cast<std::int32_t>(ox + d * (ax + fu * bx)));
    const auto y = static_cast<std::uint32_t>(static_cast<std::int32_t>(oy + d * (ay + fu * by)));
    const auto z = static_cast<std::uint32_t>(static_cast<std::int32_t>(oz + d * (az + fu * bz)));
    const std::uint64_t p =
        static_cast<std::uint64_t>(x) | static_cast<std::uint64_t>(y) << 21 | static_cast<std::uint64_t>(z) << 42;
    place[u] = d > 0.0f ? p : kNoPlace;
  }
}

}  // namespace

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
                             const FrameCube& cube, const cv::Mat3f& normals_C, const cv::Mat3b& color) {
  cube_ = cube;
  codes_.clear();
  seen_.clear();
  points_ = dropped_ = 0;
  cache_.assign(kCacheSize, Cached{});
  const int width = depth.width();
  places_.resize(static_cast<std::size_t>(width) + 1);
  places_.back() = kNoPlace;  // ends the last run of every row
  const Eigen::Vector3f step = (R_WC.col(0) / camera.fx).cast<float>();
  for (int v = 0; v < depth.height(); ++v) {
    const Eigen::Vector3f start = (R_WC * camera.unproject(0.0, v, 1.0)).cast<float>();
    placeRow(depth.row(v), width, cube.camera_leaves.data(), start.data(), step.data(), places_.data());
    addRow(width, normals_C.empty() ? nullptr : normals_C[v], color.empty() ? nullptr : color[v]);
  }
  sortByMortonCode(codes_, sorted_, 3 * (cube.block_bits + 1));
  merge();
}

void EndpointLeaves::addRow(int width, const cv::Vec3f* normals_C, const cv::Vec3b* color) {
  for (int u = 0; u < width;) {
    const std::uint64_t place = places_[static_cast<std::size_t>(u)];
    const int first = u;
    while (places_[static_cast<std::size_t>(++u)] == place && u < width) {
    }
    if (place == kNoPlace) continue;
    const auto pixels = static_cast<std::uint32_t>(u - first);
    points_ += u - first;
    Seen* seen = find(place, normals_C == nullptr ? nullptr : normals_C + first);
    if (seen == nullptr) {
      dropped_ += u - first;
      continue;
    }
    seen->pixels += pixels;
    for (int c = first; color != nullptr && c < u; ++c) {
      seen->blue += color[c][0];
      seen->green += color[c][1];
      seen->red += color[c][2];
    }
  }
}

EndpointLeaves::Seen* EndpointLeaves::find(std::uint64_t place, const cv::Vec3f* normal_C) {
  const auto x = xOf(place), y = yOf(place), z = zOf(place);
  Cached& cached = cache_[(x * 73u + y * 1031u + z * 16411u) % kCacheSize];
  if (cached.place != place) {  // new, or so long ago that the merge must find it
    for (const std::int64_t k : {cube_.base[0] + x, cube_.base[1] + y, cube_.base[2] + z}) {
      if (k < 0 || k >= kKeySpace) return nullptr;
    }
    cached = {place, static_cast<std::uint32_t>(seen_.size())};
    codes_.push_back({mortonCode(x, y, z), cached.seen});
    Seen& fresh = seen_.emplace_back();
    fresh.place = place;
    if (normal_C != nullptr) fresh.normal_C = {(*normal_C)[0], (*normal_C)[1], (*normal_C)[2]};
  }
  return &seen_[cached.seen];
}

/// Brings what was seen into the order of the codes, one endpoint for all that have the same.
void EndpointLeaves::merge() {
  endpoints_.clear();
  for (std::vector<float>& centres : centres_) centres.clear();
  for (std::size_t i = 0; i < codes_.size();) {
    if (i + kPrefetched < codes_.size()) __builtin_prefetch(&seen_[codes_[i + kPrefetched].index]);
    const std::uint64_t code = codes_[i].code;
    Seen& together = seen_[codes_[i].index];
    for (++i; i < codes_.size() && codes_[i].code == code; ++i) {
      const Seen& more = seen_[codes_[i].index];
      together.blue += more.blue;
      together.green += more.green;
      together.red += more.red;
      together.pixels += more.pixels;
    }
    append(code, together);
  }
}

void EndpointLeaves::append(std::uint64_t code, const Seen& seen) {
  const auto mean = [&](std::uint32_t sum) { return static_cast<std::uint8_t>((sum + seen.pixels / 2) / seen.pixels); };
  endpoints_.push_back({code, seen.normal_C, mean(seen.blue), mean(seen.green), mean(seen.red)});
  centres_[0].push_back(static_cast<float>(xOf(seen.place)) + 0.5f);
  centres_[1].push_back(static_cast<float>(yOf(seen.place)) + 0.5f);
  centres_[2].push_back(static_cast<float>(zOf(seen.place)) + 0.5f);
}

}  // namespace saccade
