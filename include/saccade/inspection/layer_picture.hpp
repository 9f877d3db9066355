#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>
#include <opencv2/core.hpp>

#include "saccade/map/map_cursor.hpp"
#include "saccade/rendering/ior_view.hpp"

namespace saccade {

/// What of a rendered view a picture shows.
enum class PictureLayer { kColor, kDepth, kNormal, kOccupancy, kHeight, kIorWeight, kIorFlag };

/// The layer called `name`: color, depth, normal, occupancy, height, weight or flag. Throws std::invalid_argument that
/// lists them for any other name.
[[nodiscard]] PictureLayer pictureLayer(std::string_view name);
/// The names that pictureLayer() knows.
[[nodiscard]] const std::vector<std::string>& pictureLayerNames();

/// Range of the values that a layer stretches over its colours.
struct LayerRange {
  double lowest = 0.0;
  double highest = 1.0;
};

/// The range that `layer` takes in `view`, without the outermost 1 % at either end where the layer is measured in
/// metres, so that a single stray leaf does not flatten the picture. To share one range over the pictures of a video.
[[nodiscard]] LayerRange rangeOf(const SurfaceView& view, PictureLayer layer, const MapTree& map,
                                 const Eigen::Vector3d& up_W);

/// The view as a picture of its camera's size, BGR; holes are `background`.
///
/// Depth, occupancy and height are painted in viridis from dark (low) to yellow (high); the IOR weight over a grey
/// picture of the scene from black (forgotten) over red to yellow; the flag as the paper's 2D IOR map, white where
/// inhibited, over a dimmed scene. Colour and normals are what the leaves remember.
[[nodiscard]] cv::Mat3b paintLayer(const SurfaceView& view, PictureLayer layer, const MapTree& map,
                                   const Eigen::Vector3d& up_W, const LayerRange& range,
                                   const cv::Vec3b& background = {32, 26, 24});

}  // namespace saccade
