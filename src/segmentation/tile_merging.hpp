#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <opencv2/core.hpp>

#include "segmentation/color_edges.hpp"
#include "segmentation/flat_partition.hpp"

namespace saccade {

/// Merges the components of a small part of an image, in the processor's nearest cache, exactly as they merge when the
/// edges of the whole image are taken by rising weight.
///
/// An edge's turn has come when all lighter edges of its two components have had theirs. So each component has a limit:
/// the lightest of its edges that lead out of the tile or were left for later. Edges from there on are left for later,
/// too, and limit the component on their other side.
///
/// The last edge of a triangle need not be looked at as long as no edge was refused: when its turn comes the other two
/// have joined its ends, or have limited the components of both. With the first refused edge the tile is left as it is.
/// In real images four of five merges are done this way, along a third of the edges, and few edges are refused.
class TileMerger {
 public:
  static constexpr int kWidth = 64;   ///< px of the largest tile
  static constexpr int kHeight = 32;  ///< px

  struct Component {
    float internal = 0.0F;    ///< Int(C), grey levels
    std::uint16_t area = 0;   ///< px
    std::uint16_t limit = 0;  ///< step from which on edges wait
  };

  explicit TileMerger(float k);

  /// Merges along the edges of less than `end_step` whose turn can be told.
  void merge(const ColorEdges& edges, const cv::Rect& tile, int end_step);

  /// Labels of the components in row `v` of the tile, one for each column. The label of a component is the index of one
  /// of its pixels, v * kWidth + u.
  [[nodiscard]] const std::uint16_t* labels(int v) const { return partition_.labels() + v * kWidth; }
  [[nodiscard]] const Component& component(std::size_t label) const { return components_[label]; }

 private:
  /// Step, pixel and direction in one word, by which edges sort.
  using PackedEdge = std::uint32_t;

  void limitAtBorder(const ColorEdges& edges, const cv::Rect& tile);
  void gather(const ColorEdges& edges, const cv::Rect& tile, int end_step);
  void sort();
  void mergeSorted();
  [[nodiscard]] bool mergeAlong(PackedEdge edge);

  float k_;
  const float* distances_;                ///< grey levels, by step
  std::vector<Component> single_pixels_;  ///< how components start
  FlatPartition<std::uint16_t> partition_;
  std::vector<Component> components_;  ///< by label
  std::vector<PackedEdge> edges_, sorted_;
  std::size_t edge_count_ = 0;
};

}  // namespace saccade
