#pragma once

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"

namespace saccade {

/// Vertex and normal map of one depth image, in the camera frame C (Newcombe et al. 2011, "surface measurement").
///
/// All images have the camera's size. A pixel without measurement has depth 0 and vertex and normal (0, 0, 0); a
/// measured pixel whose neighbourhood is too broken for a normal has normal (0, 0, 0).
struct DepthMaps {
  PinholeCamera camera;
  cv::Mat1f depth_m;   ///< along the optical axis, limited to the working range
  cv::Mat3f vertices;  ///< metres, frame C
  cv::Mat3f normals;   ///< unit length, frame C, turned towards the camera: normal · vertex < 0
};

}  // namespace saccade
