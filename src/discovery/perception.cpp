#include "saccade/discovery/perception.hpp"

namespace saccade {

void Perception::makeTables(const cv::Mat3b& image, const DepthMaps* depth, const SupportPlaneConfig& config) {
  has_depth = depth != nullptr;
  if (depth != nullptr) {
    camera = depth->camera;
  } else {
    surface.labels.create(image.size());
    surface.labels.setTo(-1);
    surface.count = 0;
  }
  SegmentTable::build(color_segments, color, surface_segments, surface, saliency, image, depth);
  overlap.build(color_segments.runs(), surface_segments.runs());
  planes.build(surface_segments, camera, config);
}

}  // namespace saccade
