#pragma once

#include <string>
#include <vector>

#include <Eigen/Core>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/inspection/scene_frame.hpp"

namespace saccade {

/// Pose of a camera at `eye_W` that looks at `target_W` with `up_W` upwards in its picture; where it looks along `up_W`
/// any sideways direction is taken. Throws std::invalid_argument if eye and target coincide.
[[nodiscard]] Pose lookAt(const Eigen::Vector3d& eye_W, const Eigen::Vector3d& target_W, const Eigen::Vector3d& up_W);

/// Pose of seven numbers "x y z qx qy qz qw" (metres, quaternion of any length but 0), or of three "x y z" for a
/// camera turned as the first one was. Commas count as blanks. Throws std::invalid_argument for anything else.
[[nodiscard]] Pose parsePose(const std::string& text);

/// A camera of `width` × `height` pixels that sees `horizontal_fov_rad` from side to side.
[[nodiscard]] PinholeCamera cameraWithFov(int width, int height, double horizontal_fov_rad);

/// `count` poses once around the scene, looking slightly down at its middle from so far away that all of it is seen by
/// `camera`; the first looks the way the first camera of the session did. Throws std::invalid_argument for an empty
/// scene.
[[nodiscard]] std::vector<Pose> turntable(const SceneFrame& scene, const PinholeCamera& camera, int count);

/// `count` poses along `path`, evenly in its length of time: positions by Catmull-Rom splines through a smoothed path,
/// turns by slerp, so that a shaky hand makes a calm film. Throws std::invalid_argument for an empty path.
[[nodiscard]] std::vector<Pose> flyThrough(const std::vector<Pose>& path, int count);

}  // namespace saccade
