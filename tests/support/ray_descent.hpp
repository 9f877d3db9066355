#pragma once

#include <algorithm>
#include <array>
#include <optional>
#include <vector>

#include <Eigen/Core>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/map_cursor.hpp"

namespace saccade::test {

/// Part of a ray, as depths along the optical axis in metres; empty if `exit` <= `entry`.
struct RayInterval {
  double entry = 0.0, exit = 0.0;
  [[nodiscard]] double length() const { return exit - entry; }
};

/// The slow twin of the renderer: one ray, in double, by plain recursive descent of the octree.
class RayDescent {
 public:
  struct Hit {
    LeafKey key;
    double depth_m = 0.0;
    IorState ior;
  };

  RayDescent(const MapTree& map, const PinholeCamera& camera, const Pose& T_WC, double near_m, double far_m)
      : map_(map), camera_(camera), T_WC_(T_WC), near_m_(near_m), far_m_(far_m) {}

  /// First occupied leaf on the ray of pixel (u, v) between near and far.
  [[nodiscard]] std::optional<Hit> cast(double u, double v) const {
    if (!map_.root) return std::nullopt;
    return descend(map_.root, {0, 0, 0}, 0, direction(u, v));
  }
  /// Where the ray of pixel (u, v) is inside of a finest leaf, cut to near and far.
  [[nodiscard]] RayInterval inside(const LeafKey& key, double u, double v) const {
    return clip({key.x, key.y, key.z}, 1, direction(u, v));
  }

 private:
  using Corner = std::array<int, 3>;

  [[nodiscard]] Eigen::Vector3d direction(double u, double v) const {
    return T_WC_.linear() * camera_.unproject(u, v, 1.0);
  }

  [[nodiscard]] RayInterval clip(const Corner& corner, int size, const Eigen::Vector3d& direction) const {
    RayInterval interval{near_m_, far_m_};
    for (int axis = 0; axis < 3; ++axis) {
      const double origin = T_WC_.translation()[axis];
      const int key = corner[static_cast<std::size_t>(axis)] - MapTree::kCentreKey;
      const double low = key * map_.leaf_size_m - origin, high = (key + size) * map_.leaf_size_m - origin;
      if (direction[axis] == 0.0) {
        if (low > 0.0 || high <= 0.0) return {0.0, 0.0};
        continue;
      }
      const double first = low / direction[axis], second = high / direction[axis];
      interval.entry = std::max(interval.entry, std::min(first, second));
      interval.exit = std::min(interval.exit, std::max(first, second));
    }
    return interval;
  }

  [[nodiscard]] std::optional<Hit> descend(MapNode node, const Corner& corner, int depth,
                                           const Eigen::Vector3d& direction) const {
    if (node.logOdds() < map_.occupied_log_odds) return std::nullopt;
    const int size = 1 << (MapTree::kDepth - depth);
    const RayInterval interval = clip(corner, size, direction);
    if (interval.length() <= 0.0) return std::nullopt;
    if (depth == MapTree::kDepth) {
      const auto part = [&](std::size_t axis) { return static_cast<std::uint16_t>(corner[axis]); };
      return Hit{{part(0), part(1), part(2)}, interval.entry, node.ior()};
    }
    // The children on the ray, nearest first: sorted by where the ray enters them.
    struct Entered {
      double entry, exit;
      unsigned child;
    };
    std::vector<Entered> entered;
    for (unsigned i = 0; i < 8; ++i) {
      if (!node.isLeaf() && (node.childMask() >> i & 1u) == 0) continue;
      const RayInterval part = clip(childCorner(corner, size / 2, i), size / 2, direction);
      if (part.length() > 0.0) entered.push_back({part.entry, part.exit, i});
    }
    std::sort(entered.begin(), entered.end(),
              [](const Entered& a, const Entered& b) { return a.entry + a.exit < b.entry + b.exit; });
    for (const auto& [entry, exit, child] : entered) {
      const auto hit =
          descend(node.isLeaf() ? node : node.child(child), childCorner(corner, size / 2, child), depth + 1, direction);
      if (hit) return hit;
    }
    return std::nullopt;
  }

  [[nodiscard]] static Corner childCorner(const Corner& corner, int half, unsigned child) {
    return {corner[0] + ((child & 1u) != 0 ? half : 0), corner[1] + ((child & 2u) != 0 ? half : 0),
            corner[2] + ((child & 4u) != 0 ? half : 0)};
  }

  MapTree map_;
  PinholeCamera camera_;
  Pose T_WC_;
  double near_m_, far_m_;
};

}  // namespace saccade::test
