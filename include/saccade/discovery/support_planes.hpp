#pragma once

#include <cstdint>
#include <vector>

#include <Eigen/Core>

#include "saccade/core/camera.hpp"
#include "saccade/core/config_fields.hpp"
#include "saccade/discovery/segment_table.hpp"

namespace saccade {

struct SupportPlaneConfig {
  double min_area_m2 = 0.06;
  double max_distance_m = 0.012;
  double max_angle_rad = 0.30;

  void describe(ConfigVisitor& v) {
    v.number("min_area", min_area_m2, {0.001, 100.0}, "m^2", "area from which a flat surface segment is a structure");
    v.number("max_distance", max_distance_m, {0.0, 0.5}, "m", "distance up to which a segment belongs to a plane");
    v.number("max_angle", max_angle_rad, {0.0, 1.6}, "rad", "angle of the normals up to which it belongs to a plane");
  }
};

/// The large planes of one frame (table, floor, wall: what things stand on or before) and which surface segments lie
/// on them. Beyond the paper: what is left when they are taken away falls apart into things.
class SupportPlanes {
 public:
  struct Plane {
    Eigen::Vector3d normal;  ///< unit, frame C, towards the camera
    double offset_m = 0.0;   ///< normal · p = offset on the plane
    double area_m2 = 0.0;
  };
  static constexpr std::int32_t kNoPlane = -1;

  /// Finds the planes among `surfaces`, largest first. Without depth there are none.
  void build(const SegmentTable& surfaces, const PinholeCamera& camera, const SupportPlaneConfig& config);

  [[nodiscard]] const std::vector<Plane>& planes() const { return planes_; }
  /// Index of the plane on which surface segment `segment` lies, or kNoPlane.
  [[nodiscard]] std::int32_t planeOf(std::int32_t segment) const {
    return plane_of_[static_cast<std::size_t>(segment)];
  }
  /// Distance of `p_C` from the plane closest below it, metres: 0 if it is above none.
  [[nodiscard]] double height(const Eigen::Vector3d& p_C) const;

 private:
  std::vector<Plane> planes_;
  std::vector<std::int32_t> plane_of_;
};

/// Area of the visible surface of `sums`, taken as one flat patch: m².
[[nodiscard]] double metricArea(const SegmentSums& sums, const PinholeCamera& camera);

}  // namespace saccade
