#include "saccade/core/lens_distortion.hpp"

namespace saccade {

std::array<double, 2> LensDistortion::distort(double x, double y) const {
  const double r2 = x * x + y * y;
  const double radial = 1.0 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2.0 * p1 * x * y + p2 * (r2 + 2.0 * x * x),
          y * radial + p1 * (r2 + 2.0 * y * y) + 2.0 * p2 * x * y};
}

std::array<double, 2> LensDistortion::undistort(double x, double y) const {
  constexpr int kIterations = 30;  // each gains at least half a digit for the distortions of real cameras
  std::array<double, 2> ideal{x, y};
  for (int i = 0; i < kIterations; ++i) {
    const auto [u, v] = distort(ideal[0], ideal[1]);
    ideal = {ideal[0] + x - u, ideal[1] + y - v};
  }
  return ideal;
}

}  // namespace saccade
