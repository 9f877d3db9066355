#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "saccade/core/config_fields.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/ior_law.hpp"
#include "saccade/map/leaf_key.hpp"
#include "saccade/map/map_cursor.hpp"

namespace saccade {

class IorOcTree;
class FrameIntegrator;
class LeafAttention;

/// Settings of the map: leaf, sensor model (OctoMap's defaults) and the IOR law.
struct IorMapConfig {
  double leaf_size_m = 0.01;
  double min_range_m = 0.3;  ///< depth along the optical axis; nearer measurements are ignored
  double max_range_m = 4.0;  ///< farther measurements are ignored, for occupied and for free space
  double hit_probability = 0.7;
  double miss_probability = 0.4;
  double lowest_probability = 0.1192;  ///< clamping
  double highest_probability = 0.971;  ///< clamping
  IorParameters ior;
  bool attend_blocks = true;  ///< see IorMap::attend()

  void describe(ConfigVisitor& v) {
    v.number("leaf_size_m", leaf_size_m, {0.001, 1.0}, "m", "edge of the finest leaves");
    v.number("min_range_m", min_range_m, {0.0, 100.0}, "m", "depth below which measurements are ignored");
    v.number("max_range_m", max_range_m, {0.01, 100.0}, "m", "depth above which measurements are ignored");
    v.number("hit_probability", hit_probability, {0.5001, 0.9999}, "", "occupancy that one hit says");
    v.number("miss_probability", miss_probability, {0.0001, 0.4999}, "", "occupancy that one miss says");
    v.number("lowest_probability", lowest_probability, {0.0001, 0.4999}, "", "occupancy is clamped below here");
    v.number("highest_probability", highest_probability, {0.5001, 0.9999}, "", "occupancy is clamped above here");
    v.section("ior", ior, "inhibition of return");
    v.flag("attend_blocks", attend_blocks, "a leaf that is attended takes the others of its block of 2x2x2 with it");
  }
};

/// What integrating one frame did.
struct IntegrationReport {
  int points = 0;                  ///< measured pixels within range
  int dropped_points = 0;          ///< of these, outside the key space: ignored
  int hit_leaves = 0;              ///< different leaves that hold a point
  std::vector<LeafKey> forgotten;  ///< leaves that turned free while they still had IOR weight
};

/// What attending did in one tick.
struct AttentionReport {
  Tick tick;                      ///< the tick that was closed
  int attended = 0;               ///< different occupied leaves attended
  int missing = 0;                ///< different keys where the map holds no occupied leaf: nothing to remember there
  std::vector<LeafKey> flags_on;  ///< leaves whose IOR flag went on, in Morton order
};

/// One leaf as a value, for iteration.
struct MapLeaf {
  NodeKey key;  ///< coarse leaves have depth < 16
  bool occupied = false;
  float log_odds = 0.0f;
  IorState ior;
  LeafSurface surface;
};

/// The map: an octree of occupancy whose occupied leaves remember attention (paper, "3D IOR map").
///
/// Owns the tree, the sensor model and the tick. Leaves to others: which leaves a mask covers (the renderer's key
/// image), the log of attention (AttendLog), files (map_tiles.hpp and session), and the surface volume for tracking.
///
/// Thread rule: one writer (integrate, attend, restore), or any number of readers. Same input, same tree.
class IorMap {
 public:
  using Config = IorMapConfig;

  /// An empty map at tick 0. Throws std::invalid_argument for a config out of range.
  explicit IorMap(const Config& config = {});
  ~IorMap();
  IorMap(IorMap&&) noexcept;
  IorMap& operator=(IorMap&&) noexcept;

  /// Adds what one frame saw: leaves that hold a point become more occupied, leaves that a measured ray passes before
  /// its own leaf become more free, each at most once, occupied first (as OctoMap's discretised `insertPointCloud`).
  ///
  /// `depth.depth_m` is used between the ranges of the config, 0 and NaN are no measurement; `depth.normals` and
  /// `color` (both of the camera's size, or empty) go into the surface of the leaves hit. Does not close the tick.
  /// Cost: about the visible surface, not the volume. Throws std::invalid_argument for sizes that differ or a pose that
  /// is not finite.
  IntegrationReport integrate(const DepthMaps& depth, const cv::Mat3b& color, const Pose& T_WC);

  /// Attends each of `keys` once, whatever their order (Morton order is fastest) and repetition, and closes the tick:
  /// now() is one later (paper, "3D IOR map update"). Free and unknown leaves are left alone. An empty list lets a tick
  /// pass.
  ///
  /// With `attend_blocks` the occupied leaves of each block of 2x2x2 are attended together. A measured surface is a
  /// shell some leaves thick, of which every pose sees others; attended one by one, none of them would be looked at
  /// long enough to be inhibited.
  AttentionReport attend(std::span<const LeafKey> keys);

  [[nodiscard]] Tick now() const;
  [[nodiscard]] const Config& config() const { return config_; }

  /// The leaf that covers the point, if the map knows it. Points outside the key space are unknown.
  [[nodiscard]] std::optional<MapLeaf> findLeaf(const Eigen::Vector3d& p_W) const;
  [[nodiscard]] std::optional<MapLeaf> findLeaf(LeafKey key) const;
  /// Key of the finest leaf that holds the point; none outside the key space.
  [[nodiscard]] std::optional<LeafKey> keyAt(const Eigen::Vector3d& p_W) const;
  /// Centre of a finest leaf.
  [[nodiscard]] Eigen::Vector3d centre(LeafKey key) const;

  /// Calls `visit` for every leaf in Morton order. Cost: every node.
  void forEachLeaf(const std::function<void(const MapLeaf&)>& visit) const;
  /// Leaves, coarse ones counted once. Cost: every node.
  [[nodiscard]] std::size_t leafCount() const;
  /// Occupied leaves. Cost: every node.
  [[nodiscard]] std::size_t occupiedLeafCount() const;
  /// Nodes, inner ones included. Cheap.
  [[nodiscard]] std::size_t nodeCount() const;
  /// Bytes of memory held by the nodes.
  [[nodiscard]] std::size_t memoryBytes() const;
  /// Bytes of these that nodes take; the rest is free for new ones.
  [[nodiscard]] std::size_t usedBytes() const;

  /// For traversal without OctoMap; valid until the map changes.
  [[nodiscard]] MapTree view() const;
  /// The tree itself, for those who include ior_octree.hpp.
  [[nodiscard]] const IorOcTree& tree() const { return *tree_; }
  [[nodiscard]] IorOcTree& tree() { return *tree_; }
  /// Sets the tick, for restoring a saved map.
  void setNow(Tick now);

 private:
  Config config_;
  std::unique_ptr<IorOcTree> tree_;
  std::unique_ptr<FrameIntegrator> integrator_;
  std::unique_ptr<LeafAttention> attention_;
};

}  // namespace saccade
