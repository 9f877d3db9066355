#pragma once

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"

namespace saccade {

/// The surface of a model as a camera at the pose `T_WM` sees it; frame M is that camera. Holes have depth 0 and
/// normal (0, 0, 0). The surface point behind pixel (u, v) is `camera.unproject(u, v, depth_m(v, u))`, in frame M.
struct ModelView {
  PinholeCamera camera;
  Pose T_WM = Pose::Identity();
  cv::Mat1f depth_m;  ///< along the optical axis
  cv::Mat3f normals;  ///< unit length, frame M, turned towards the camera
};

}  // namespace saccade
