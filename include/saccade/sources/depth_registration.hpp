#pragma once

#include <array>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/core/camera.hpp"
#include "saccade/core/config_fields.hpp"
#include "saccade/sources/camera_calibration.hpp"

namespace saccade {

struct DepthRegistrationConfig {
  /// Neighbouring depth pixels belong to one surface while their inverse depths differ by no more than
  /// `max_step_per_m + max_relative_step * inverse depth`: the first part covers the sensor's disparity steps (constant
  /// in inverse depth), the second slanted surfaces (3 % a pixel is 87 degrees at 585 px focal length).
  double max_step_per_m = 0.006;
  double max_relative_step = 0.03;

  void describe(ConfigVisitor& visitor);
};

/// Renders the depth image of a depth camera D into an ideal colour camera C that stands elsewhere.
///
/// The depth image is taken as a surface: every cell of four neighbouring measurements is two triangles, cells that
/// span a depth discontinuity are left open (or keep the triangle that does not), surfaces seen from behind are left
/// out, and the nearest surface wins. So resampling leaves no holes, background does not shine through foreground, and
/// what the depth camera cannot see stays empty. Inverse depth is interpolated, which is exact for planes.
///
/// Owns its row buffers; nothing is allocated after the first frame. One instance per thread. Invalid values are the
/// caller's business: depth 0 (or less, or NaN) is "no measurement" here.
class DepthRegistration {
 public:
  using Config = DepthRegistrationConfig;

  DepthRegistration(const PinholeCamera& color, const DepthCamera& depth, const Config& config = {});

  /// Renders `depth_D_m` (metres along D's optical axis, of D's size) to `depth_C_m` (along C's optical axis, of C's
  /// size, 0 = no measurement). Buffers are reused. About 1 ms for 640x480. Throws std::invalid_argument on another
  /// size.
  void render(const cv::Mat1f& depth_D_m, cv::Mat1f& depth_C_m);

  /// One row of depth pixels seen by the colour camera: pixel coordinates and inverse depth (0 = no measurement).
  struct ProjectedRow {
    std::vector<float> u, v, inverse_depth;
  };

 private:
  void projectRow(const cv::Mat1f& depth_D_m, int row, ProjectedRow& projected);
  void renderCellRow(const ProjectedRow& upper, const ProjectedRow& lower, cv::Mat1f& inverse_depth);

  Config config_;
  PinholeCamera color_;
  PinholeCamera depth_;
  std::array<float, 12> T_CD_;    // rows of [R | t]
  cv::Mat1f ray_x_, ray_y_;       // normalised rays of D; one row only where D has no distortion
  std::vector<float> ray_y_row_;  // y of the current row, repeated
  std::array<ProjectedRow, 2> rows_;
  std::vector<int> cell_pixel_;    // per cell of a row: the one pixel it covers, or kNone, or kSeveral
  std::vector<float> cell_value_;  // inverse depth there
};

}  // namespace saccade
