#pragma once

#include <cmath>

#include "saccade/tracking/intensity_pyramid.hpp"
#include "support/depth_scene.hpp"

namespace saccade::test {

/// The grey value that is painted on whatever surface is at a world point: waves of a few centimetres in all
/// directions, so that every motion along any surface shows.
inline double paintAt(const Eigen::Vector3d& p_W) {
  return 128.0 + 35.0 * std::sin(31.0 * p_W.x() + 5.0 * p_W.y()) + 35.0 * std::sin(27.0 * p_W.y() - 9.0 * p_W.z()) +
         20.0 * std::sin(23.0 * p_W.z() + 11.0 * p_W.x());
}

/// Colour image of the painted scene, grey, `brightness` added to all of it.
inline cv::Mat3b paintedColor(const DepthScene& scene, const PinholeCamera& camera, const Pose& T_WC,
                              double brightness = 0.0) {
  cv::Mat3b color(camera.height, camera.width);
  for (int v = 0; v < camera.height; ++v) {
    for (int u = 0; u < camera.width; ++u) {
      const double depth_m = scene.meetPixel(camera, T_WC, u, v).s;
      const double paint = std::isfinite(depth_m) ? paintAt(T_WC * camera.unproject(u, v, depth_m)) + brightness : 0.0;
      color(v, u) = cv::Vec3b::all(cv::saturate_cast<unsigned char>(paint));
    }
  }
  return color;
}

inline IntensityPyramid paintedIntensity(const DepthScene& scene, const PinholeCamera& camera, const Pose& T_WC,
                                         double brightness = 0.0) {
  IntensityPyramid pyramid;
  pyramid.build(paintedColor(scene, camera, T_WC, brightness), camera);
  return pyramid;
}

}  // namespace saccade::test
