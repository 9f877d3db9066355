#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "map/working_depth.hpp"
#include "saccade/core/camera.hpp"
#include "saccade/map/morton_code.hpp"

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

/// The different leaves that one frame's points fall into, in Morton order, with what was seen there.
class EndpointLeaves {
 public:
  /// One leaf: its Morton code from the cube's base, and what its pixels say together.
  struct Endpoint {
    std::uint64_t code;
    std::array<float, 3> normal_C;              ///< of the leaf's first pixel; (0, 0, 0) = none
    std::uint8_t blue = 0, green = 0, red = 0;  ///< mean
  };
  /// Centres of the leaves from the cube's base, in leaves, by axis, in the order of the leaves.
  using Centres = std::array<std::vector<float>, 3>;

  /// Collects the frame's leaves. `depth` is in leaves; `normals_C` and `color` may be empty. Cost: one pass and one
  /// sort.
  void collect(const WorkingDepth& depth, const PinholeCamera& camera, const Eigen::Matrix3d& R_WC,
               const FrameCube& cube, const cv::Mat3f& normals_C, const cv::Mat3b& color);

  [[nodiscard]] std::span<const Endpoint> endpoints() const { return endpoints_; }
  [[nodiscard]] const Centres& centres() const { return centres_; }
  [[nodiscard]] int points() const { return points_; }
  [[nodiscard]] int droppedPoints() const { return dropped_; }

 private:
  /// What was seen of a leaf in pixels that follow each other closely; a leaf may have several.
  struct Seen {
    std::uint32_t blue = 0, green = 0, red = 0;  // sums over `pixels`
    std::uint32_t pixels = 0;
    std::array<float, 3> normal_C{};
    std::uint64_t place = 0;  // x | y << 21 | z << 42 from the cube's base
  };
  struct Cached {
    std::uint64_t place = ~std::uint64_t{0};
    std::uint32_t seen = 0;
  };
  static constexpr std::size_t kCacheSize = 4096;

  void addRow(int width, const cv::Vec3f* normals_C, const cv::Vec3b* color);
  Seen* find(std::uint64_t place, const cv::Vec3f* normal_C);
  void merge();
  void append(std::uint64_t code, const Seen& seen);

  FrameCube cube_;
  std::vector<MortonCoded> codes_, sorted_;
  std::vector<Seen> seen_;
  std::vector<Cached> cache_;
  std::vector<std::uint64_t> places_;  // one row
  std::vector<Endpoint> endpoints_;
  Centres centres_;
  int points_ = 0, dropped_ = 0;
};

}  // namespace saccade
