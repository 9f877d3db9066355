#include "saccade/discovery/candidate_box.hpp"

#include <limits>

#include "saccade/discovery/candidate_mask.hpp"

namespace saccade {
namespace {

/// Grows boxes by runs of points that it takes from the camera to the world.
class PointBounds {
 public:
  explicit PointBounds(const Pose& T_WC) {
    for (int i = 0; i < 3; ++i) axes_[i].head<3>() = T_WC.linear().col(i).cast<float>().array();
    origin_.head<3>() = T_WC.translation().cast<float>().array();
  }

  void extend(WorldBox& box, const cv::Vec3f* row, int begin_u, int end_u) const {
    Eigen::Array4f low = Eigen::Array4f::Constant(std::numeric_limits<float>::max()), high = -low;
    for (int u = begin_u; u < end_u; ++u) {
      if (!(row[u][2] > 0.0F)) continue;
      const Eigen::Array4f point = axes_[0] * row[u][0] + axes_[1] * row[u][1] + axes_[2] * row[u][2] + origin_;
      low = low.min(point);
      high = high.max(point);
    }
    box.min() = box.min().cwiseMin(low.head<3>().matrix());
    box.max() = box.max().cwiseMax(high.head<3>().matrix());
  }

 private:
  Eigen::Array4f axes_[3] = {Eigen::Array4f::Zero(), Eigen::Array4f::Zero(), Eigen::Array4f::Zero()};
  Eigen::Array4f origin_ = Eigen::Array4f::Zero();
};

void boundSegments(const Segmentation& segmentation, const cv::Mat3f& vertices, const PointBounds& bounds,
                   std::vector<WorldBox>& boxes) {
  boxes.assign(static_cast<std::size_t>(segmentation.count), WorldBox());
  if (segmentation.count == 0) return;
  for (int v = 0; v < segmentation.labels.rows; ++v) {
    const int* labels = segmentation.labels[v];
    for (int u = 0; u < segmentation.labels.cols;) {
      const int begin = u, label = labels[u];
      while (u < segmentation.labels.cols && labels[u] == label) ++u;
      if (label >= 0) bounds.extend(boxes[static_cast<std::size_t>(label)], vertices[v], begin, u);
    }
  }
}

}  // namespace

std::optional<WorldBox> candidateBox(const Candidate& candidate, const FrameSegments& seen, const DepthMaps& depth,
                                     const Pose& T_WC) {
  const PointBounds bounds(T_WC);
  WorldBox box;
  forEachMaskRun(candidate, seen,
                 [&](int v, int begin, int end) { bounds.extend(box, depth.vertices[v], begin, end); });
  if (box.isEmpty()) return std::nullopt;
  return box;
}

void CandidateBoxes::begin(const FrameSegments& seen, const cv::Mat3f& vertices, const Pose& T_WC) {
  const PointBounds bounds(T_WC);
  boundSegments(seen.color, vertices, bounds, color_);
  boundSegments(seen.surface, vertices, bounds, surface_);
  has_depth_ = true;
}

std::optional<WorldBox> CandidateBoxes::box(const Candidate& candidate) const {
  if (!has_depth_) return std::nullopt;
  const std::vector<WorldBox>& boxes = candidate.source == CandidateSource::kColor ? color_ : surface_;
  WorldBox box;
  for (const std::int32_t segment : candidate.segments) box.extend(boxes[static_cast<std::size_t>(segment)]);
  if (box.isEmpty()) return std::nullopt;
  return box;
}

}  // namespace saccade
