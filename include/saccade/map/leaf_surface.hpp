#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <Eigen/Core>

namespace saccade {

/// What an occupied leaf remembers of its surface, 8 bytes: mean colour, normal, how often it was seen.
///
/// For pictures, inspection and export; neither tracking nor attention reads it. All zero: nothing known.
struct LeafSurface {
  std::uint8_t blue = 0, green = 0, red = 0;
  std::int8_t nx = 0, ny = 0, nz = 0;  ///< normal in W times 127; (0, 0, 0) = none
  std::uint16_t observations = 0;      ///< frames that hit the leaf, saturating

  friend bool operator==(const LeafSurface&, const LeafSurface&) = default;

  /// Unit normal in W, or (0, 0, 0) where none is known.
  [[nodiscard]] Eigen::Vector3f normal() const {
    const Eigen::Vector3f n(nx, ny, nz);
    const float length = n.norm();
    return length > 0.0f ? Eigen::Vector3f(n / length) : Eigen::Vector3f::Zero();
  }
  void setNormal(const Eigen::Vector3f& n_W) {
    const auto quantised = [](float c) {
      const float scaled = std::clamp(c, -1.0f, 1.0f) * 127.0f;
      return static_cast<std::int8_t>(scaled + (scaled < 0.0f ? -0.5f : 0.5f));
    };
    nx = quantised(n_W.x());
    ny = quantised(n_W.y());
    nz = quantised(n_W.z());
  }
};
static_assert(sizeof(LeafSurface) == 8);

}  // namespace saccade
