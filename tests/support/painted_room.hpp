#pragma once

#include <cmath>
#include <cstdint>

#include <opencv2/imgproc.hpp>

#include "support/depth_scene.hpp"

namespace saccade::test {

/// A room whose surfaces carry a pattern of patches with random grey values, so that images of it have corners that
/// stay on the surface when the camera moves. Colour and depth are exact.
struct PaintedRoom {
  DepthScene scene = cornerWithBalls();
  std::uint32_t seed = 1;  ///< of the paint: another seed, another room of the same shape
  double patch_m = 0.07;

  [[nodiscard]] RgbdFrame photograph(const PinholeCamera& camera, const Pose& T_WC) const {
    RgbdFrame frame;
    frame.depth_m = scene.render(camera, T_WC);
    frame.color.create(camera.height, camera.width);
    for (int v = 0; v < camera.height; ++v) {
      for (int u = 0; u < camera.width; ++u) {
        const Eigen::Vector3d p_W = T_WC * camera.unproject(u, v, static_cast<double>(frame.depth_m(v, u)));
        frame.color(v, u) = cv::Vec3b::all(paintAt(p_W));
      }
    }
    return frame;
  }

 private:
  [[nodiscard]] std::uint8_t paintAt(const Eigen::Vector3d& p_W) const {
    std::uint32_t hash = seed * 2654435761U;
    for (const double x : {p_W.x(), p_W.y(), p_W.z()}) {
      hash ^= static_cast<std::uint32_t>(static_cast<std::int32_t>(std::floor(x / patch_m)) + 1000);
      hash *= 2246822519U;
      hash ^= hash >> 15U;
    }
    return static_cast<std::uint8_t>(hash >> 24U);
  }
};

}  // namespace saccade::test
