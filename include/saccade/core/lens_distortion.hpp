#pragma once

#include <array>

namespace saccade {

/// Lens distortion of Brown and Conrady, in OpenCV's order of coefficients.
struct LensDistortion {
  double k1 = 0.0, k2 = 0.0, p1 = 0.0, p2 = 0.0, k3 = 0.0;

  [[nodiscard]] bool isZero() const { return k1 == 0 && k2 == 0 && p1 == 0 && p2 == 0 && k3 == 0; }
  /// Distorted normalised coordinates (x / z, y / z) of an ideal point.
  [[nodiscard]] std::array<double, 2> distort(double x, double y) const;
  /// Ideal normalised coordinates of a distorted point: the inverse of distort(), by iteration; good to 1e-6 within the
  /// image of any lens whose distortion rises steadily from the centre.
  [[nodiscard]] std::array<double, 2> undistort(double x, double y) const;
};

}  // namespace saccade
