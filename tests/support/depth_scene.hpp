#pragma once

#include <cmath>
#include <limits>
#include <vector>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"

namespace saccade::test {

/// A scene of planes and balls whose depth image is exact for any pose: the analytic truth of tests of depth, surface
/// and tracking. World frame, metres.
struct DepthScene {
  struct Plane {
    Eigen::Vector3d normal;
    double offset;  ///< points with normal . p = offset
  };
  struct Ball {
    Eigen::Vector3d centre;
    double radius;
  };
  std::vector<Plane> planes;
  std::vector<Ball> balls;

  /// What the ray origin + s * direction meets first: s, infinite if nothing, and the normal turned to the origin.
  struct Meeting {
    double s = std::numeric_limits<double>::infinity();
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  };

  [[nodiscard]] Meeting meet(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction) const {
    Meeting first;
    const auto offer = [&](double s, const Eigen::Vector3d& normal) {
      if (s > 1e-9 && s < first.s) first = {s, normal.dot(direction) > 0.0 ? Eigen::Vector3d(-normal) : normal};
    };
    for (const Plane& plane : planes) {
      offer((plane.offset - plane.normal.dot(origin)) / plane.normal.dot(direction), plane.normal);
    }
    for (const Ball& ball : balls) {
      const Eigen::Vector3d o = origin - ball.centre;
      const double a = direction.squaredNorm(), b = o.dot(direction), c = o.squaredNorm() - ball.radius * ball.radius;
      const double discriminant = b * b - a * c;
      if (discriminant < 0.0) continue;
      for (const double sign : {-1.0, 1.0}) {
        const double s = (-b + sign * std::sqrt(discriminant)) / a;
        offer(s, (o + s * direction) / ball.radius);
      }
    }
    return first;
  }

  /// Meeting of the pixel's ray, scaled so that s is the depth along the optical axis.
  [[nodiscard]] Meeting meetPixel(const PinholeCamera& camera, const Pose& T_WC, double u, double v) const {
    return meet(T_WC.translation(), T_WC.linear() * camera.unproject(u, v, 1.0));
  }

  /// Depth image, 0 where nothing is met.
  [[nodiscard]] cv::Mat1f render(const PinholeCamera& camera, const Pose& T_WC) const {
    cv::Mat1f depth_m(camera.height, camera.width);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const double s = meetPixel(camera, T_WC, u, v).s;
        depth_m(v, u) = std::isfinite(s) ? static_cast<float>(s) : 0.0F;
      }
    }
    return depth_m;
  }
};

/// A quarter of a Kinect's resolution, same field of view.
inline PinholeCamera smallCamera() {
  return {160, 120, 146.25, 146.25, 79.5, 59.5};
}

/// The corner of a room with three balls in it: every motion of the camera shows.
inline DepthScene cornerWithBalls() {
  DepthScene scene;
  scene.planes = {{Eigen::Vector3d(0.0, -1.0, 0.0), -0.7},
                  {Eigen::Vector3d(-0.8, 0.0, -0.6).normalized(), -1.6},
                  {Eigen::Vector3d(0.7, 0.0, -0.7).normalized(), -1.4}};
  scene.balls = {{{-0.3, 0.4, 1.3}, 0.25}, {{0.35, 0.5, 1.2}, 0.2}, {{0.0, -0.1, 1.5}, 0.15}};
  return scene;
}

/// Turn about an axis, degrees, then shift, metres.
inline Pose poseOf(const Eigen::Vector3d& axis, double angle_deg, const Eigen::Vector3d& shift_m) {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(angle_deg * 3.14159265358979 / 180.0, axis.normalized()).toRotationMatrix();
  pose.translation() = shift_m;
  return pose;
}

}  // namespace saccade::test
