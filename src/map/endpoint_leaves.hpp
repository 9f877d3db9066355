#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "map/working_depth.hpp"
#include "saccade/core/camera.hpp"

namespace saccade {

/// Cube of leaves around the camera that holds all that one frame can change.
///
/// It is made of 2 x 2 x 2 blocks, each a node of the tree with an edge of 2^block_bits leaves. Positions inside are
/// counted in leaves from `base`, as numbers of block_bits + 1 bits, small enough for exact floats and short keys.
struct FrameCube {
  std::int64_t base[3] = {};  ///< key of the lowest corner; may lie outside the key space
  int block_bits = 0;
  Eigen::Vector3f camera_leaves = Eigen::Vector3f::Zero();  ///< camera position from `base`

  /// Cube for a camera at `position_m` that sees no farther than `reach_m` (along the ray).
  static FrameCube around(const Eigen::Vector3d& position_m, double reach_m, double leaf_size_m);
};

/// Interleaves the low 21 bits of x, y and z, x lowest: sorting by it is the order of OctoMap's children.
[[nodiscard]] std::uint64_t mortonCode(std::uint32_t x, std::uint32_t y, std::uint32_t z);

/// The different leaves that one frame's points fall into, in Morton order, with what was seen there.
class EndpointLeaves {
 public:
  /// What the pixels of one leaf say together.
  struct Seen {
    std::uint32_t blue = 0, green = 0, red = 0;  ///< sums over `pixels`
    std::uint32_t pixels = 0;
    std::uint32_t first_pixel = 0;      ///< v * width + u of the first pixel, whose normal speaks for the leaf
    std::uint32_t x = 0, y = 0, z = 0;  ///< the leaf, from the cube's base

    /// Centre of the leaf from the cube's base, in leaves.
    [[nodiscard]] Eigen::Vector3f centre() const {
      return {static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f, static_cast<float>(z) + 0.5f};
    }
  };
  /// Morton code from the cube's base, and which `seen` belongs to it.
  struct Hit {
    std::uint64_t code;
    std::uint32_t seen;
  };

  /// Collects the frame's leaves. `depth` is in leaves; `color` may be empty. Cost: one pass and one sort.
  void collect(const WorkingDepth& depth, const PinholeCamera& camera, const Eigen::Matrix3d& R_WC,
               const FrameCube& cube, const cv::Mat3b& color);

  [[nodiscard]] std::span<const Hit> hits() const { return hits_; }
  [[nodiscard]] const Seen& seen(const Hit& hit) const { return seen_[hit.seen]; }
  [[nodiscard]] int points() const { return points_; }
  [[nodiscard]] int droppedPoints() const { return dropped_; }

 private:
  void addRow(int v, int width, const cv::Vec3b* color);
  Seen* find(std::uint64_t place, std::uint32_t pixel);
  void sortAndMerge(int bits);

  struct Cached {
    std::uint64_t place = ~std::uint64_t{0};  // x | y << 21 | z << 42
    std::uint32_t seen = 0;
  };
  static constexpr std::size_t kCacheSize = 4096;

  FrameCube cube_;
  std::vector<Hit> hits_, sorted_;
  std::vector<Seen> seen_;
  std::vector<Cached> cache_;
  std::vector<std::uint64_t> places_;  // one row
  int points_ = 0, dropped_ = 0;
};

}  // namespace saccade
