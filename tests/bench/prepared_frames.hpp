#pragma once

#include <vector>

#include "bench/kitchen_frames.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/surface_volume.hpp"

namespace saccade::bench {

/// A kitchen frame as the map branch sees it, at the dataset's pose.
struct PreparedFrame {
  DepthMaps depth;
  cv::Mat3b color;
  Pose T_WC;
};

/// The frames of kitchenFrames(), prepared once.
[[nodiscard]] const std::vector<PreparedFrame>& preparedFrames();

/// The surface volume, and the map, after all of preparedFrames().
[[nodiscard]] SurfaceVolume surfaceOfKitchen();
[[nodiscard]] IorMap mapOfKitchen();

}  // namespace saccade::bench
