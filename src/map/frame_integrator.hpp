#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "map/endpoint_leaves.hpp"
#include "map/ray_pyramid.hpp"
#include "map/sibling_bounds.hpp"
#include "map/working_depth.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/ior_octree.hpp"

namespace saccade {

/// Adds frames to the tree in one descent that touches each node once (DESIGN, "Integration").
///
/// Occupied: the leaves of the points, sorted in the order of the descent. Free: a node in front of every measured
/// surface in its footprint is freed as it is, one behind every surface or outside the view is skipped, one that
/// straddles is opened; a finest leaf without points is free if a ray to the centre of a leaf with points crosses it.
/// Owns scratch memory only.
class FrameIntegrator {
 public:
  explicit FrameIntegrator(const IorMapConfig& config) : config_(config) {}

  /// See IorMap::integrate, which checks the arguments.
  IntegrationReport integrate(IorOcTree& tree, const DepthMaps& depth, const cv::Mat3b& color, const Pose& T_WC);

 private:
  using Hits = std::span<const EndpointLeaves::Endpoint>;
  /// A node on the way down: its lowest corner from the cube's base and its centre in the camera frame, in leaves.
  struct Place {
    int depth;
    std::uint32_t x, y, z;
    float cx, cy, cz;
  };

  void prepare(const DepthMaps& depth, const Pose& T_WC);
  void prepareSiblings(const PinholeCamera& camera);
  void updateBlock(unsigned block);
  bool updateFromRoot(IorOcTreeNode* node, int depth, const std::array<std::uint32_t, 3>& block_key, const Place& place,
                      Hits hits);
  bool updateChildren(IorOcTreeNode* node, const Place& place, Hits hits);
  bool freeChild(IorOcTreeNode* node, unsigned i, const Place& place);
  bool updateInnerChild(IorOcTreeNode* node, unsigned i, const Place& place, Hits hits);
  bool updateFinestFamily(IorOcTreeNode* node, unsigned i, const Place& place, Hits hits, const SiblingBounds& bounds);
  bool applyToFinest(IorOcTreeNode* node, const Place& place, Hits hits, unsigned missed);
  bool freeSubtree(IorOcTreeNode* node, const Place& place);
  void refresh(IorOcTreeNode* node);

  [[nodiscard]] unsigned settledChildren(const IorOcTreeNode* node) const;
  [[nodiscard]] unsigned passedLeaves(const SiblingBounds& bounds, unsigned i, const Place& family,
                                      unsigned wanted) const;
  [[nodiscard]] Place childPlace(const Place& place, unsigned i) const;

  void hit(IorOcTreeNode* leaf, const EndpointLeaves::Endpoint& endpoint);
  void miss(IorOcTreeNode* leaf, const Place& place);
  void reportForgotten(const Place& place);

  IorMapConfig config_;
  WorkingDepth depth_;
  EndpointLeaves endpoints_;
  RayPyramid rays_;

  // Of the frame in work:
  IorOcTree* tree_ = nullptr;
  bool has_color_ = false, has_normals_ = false;
  Eigen::Matrix3f R_WC_, R_CW_;
  FrameCube cube_;
  ProjectionConstants projection_;
  std::array<SiblingFrame, 17> siblings_{};  // by depth of the sibling
  float hit_ = 0, miss_ = 0, lowest_ = 0, highest_ = 0, occupied_ = 0;
  IntegrationReport report_;
};

}  // namespace saccade
