#include "saccade/sources/depth_registration.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

constexpr int kNone = -1;     // the cell covers no pixel centre
constexpr int kSeveral = -2;  // the cell is broken or may cover several: look closer
// Barycentric weights may fall this far below 0, so that rounding opens no crack between two cells.
constexpr float kEdgeTolerance = 1e-3f;
constexpr float kLeastArea = 1e-6f;  // square pixels; what is smaller is seen edge-on or from behind
constexpr float kNearest_m = 1e-3f;  // what lies nearer to the colour camera, or behind it, is not seen

/// Motion and intrinsics that take rays of the depth camera to pixels of the colour camera.
struct Projection {
  std::array<float, 12> T_CD;
  float fx, fy, cx, cy;
};

SACCADE_MULTIVERSION
void projectRays(const Projection& p, const float* __restrict ray_x, const float* __restrict ray_y,
                 const float* __restrict depth_m, int width, float* __restrict u, float* __restrict v,
                 float* __restrict inverse_depth) {
  const float r00 = p.T_CD[0], r01 = p.T_CD[1], r02 = p.T_CD[2], tx = p.T_CD[3];
  const float r10 = p.T_CD[4], r11 = p.T_CD[5], r12 = p.T_CD[6], ty = p.T_CD[7];
  const float r20 = p.T_CD[8], r21 = p.T_CD[9], r22 = p.T_CD[10], tz = p.T_CD[11];
  const float fx = p.fx, fy = p.fy, cx = p.cx, cy = p.cy;
  for (int i = 0; i < width; ++i) {
    const float x = ray_x[i], y = ray_y[i];
    const float z = depth_m[i] > 0.0f ? depth_m[i] : 0.0f;  // NaN becomes 0
    const float x_C = (r00 * x + r01 * y + r02) * z + tx;
    const float y_C = (r10 * x + r11 * y + r12) * z + ty;
    const float z_C = (r20 * x + r21 * y + r22) * z + tz;
    const float inverse = 1.0f / (z_C > kNearest_m ? z_C : kNearest_m);
    const float seen = z_C > kNearest_m ? inverse : 0.0f;
    u[i] = fx * x_C * inverse + cx;
    v[i] = fy * y_C * inverse + cy;
    inverse_depth[i] = z > 0.0f ? seen : 0.0f;
  }
}

/// Whether a cell is one surface, from the extremes of its inverse depths.
struct Continuity {
  float max_step, max_relative_step;
};

/// Limits of the colour image as floats, for the vector loops.
struct ImageSize {
  int width, height;
};

/// Smallest whole number that is not below `x`, for |x| within the range of int; written so that it vectorises.
inline int ceilToInt(float x) {
  const int truncated = static_cast<int>(x);
  return truncated + static_cast<int>(static_cast<float>(truncated) < x);
}

inline float least(float a, float b) {
  return b < a ? b : a;
}

inline float most(float a, float b) {
  return b > a ? b : a;
}

inline float cross(float ax, float ay, float bx, float by) {
  return ax * by - ay * bx;
}

/// Sorts the cells of one row: the index and inverse depth of the single pixel that a cell covers, kNone or kSeveral.
/// Cell i has the corners i and i + 1 of both rows; its diagonal runs from upper right (A) to lower left (B), its two
/// triangles have the third corner (C) upper left or lower right.
SACCADE_MULTIVERSION
void classifyCells(const Continuity& continuity, const ImageSize& size, const float* __restrict u0,
                   const float* __restrict v0, const float* __restrict w0, const float* __restrict u1,
                   const float* __restrict v1, const float* __restrict w1, int cells, int* __restrict cell_pixel,
                   float* __restrict cell_value) {
  const float max_step = continuity.max_step, max_relative_step = continuity.max_relative_step;
  const int width = size.width;
  const float max_u = static_cast<float>(size.width - 1), max_v = static_cast<float>(size.height - 1);
  for (int i = 0; i < cells; ++i) {
    const float u00 = u0[i], u10 = u0[i + 1], u01 = u1[i], u11 = u1[i + 1];
    const float v00 = v0[i], v10 = v0[i + 1], v01 = v1[i], v11 = v1[i + 1];
    const float w00 = w0[i], w10 = w0[i + 1], w01 = w1[i], w11 = w1[i + 1];
    const float w_low = least(least(w00, w10), least(w01, w11));
    const float w_high = most(most(w00, w10), most(w01, w11));
    const float slack = max_step + max_relative_step * w_high - (w_high - w_low);  // below 0: a discontinuity

    const float u_low = least(least(u00, u10), least(u01, u11));
    const float u_high = most(most(u00, u10), most(u01, u11));
    const float v_low = least(least(v00, v10), least(v01, v11));
    const float v_high = most(most(v00, v10), most(v01, v11));
    // Clamped first: cells far outside must not overflow an int.
    const int pu = ceilToInt(least(most(u_low - kEdgeTolerance, -1.0f), max_u + 2.0f));
    const int pv = ceilToInt(least(most(v_low - kEdgeTolerance, -1.0f), max_v + 2.0f));
    const float u = static_cast<float>(pu), v = static_cast<float>(pv);

    // On which side of the diagonal is the pixel; the third corner is there too.
    const float ex = u01 - u10, ey = v01 - v10, px = u - u10, py = v - v10;
    const float side = cross(ex, ey, px, py);
    const float uc = side >= 0.0f ? u00 : u11;
    const float vc = side >= 0.0f ? v00 : v11;
    const float wc = side >= 0.0f ? w00 : w11;
    const float cx = uc - u10, cy = vc - v10;
    const float area = cross(ex, ey, cx, cy);
    // Seen from the front the upper left corner lies at a positive area, the lower right one at a negative area.
    const float front = side >= 0.0f ? area : -area;
    const float scale = 1.0f / (front > kLeastArea ? area : 1.0f);
    const float weight_c = side * scale;
    const float weight_b = cross(px, py, cx, cy) * scale;
    const float weight_a = 1.0f - weight_b - weight_c;
    cell_value[i] = weight_a * w10 + weight_b * w01 + weight_c * wc;

    // Every condition as "this number is not negative", which keeps the loop free of branches.
    const float covered = least(least(weight_a, weight_b), weight_c) + kEdgeTolerance;
    const float in_image = least(least(u, max_u - u), least(v, max_v - v));
    const float inside = least(least(covered, in_image), front - kLeastArea);
    const float alone = least(u + 1.0f - u_high, v + 1.0f - v_high) - kEdgeTolerance;  // no other pixel in the cell
    const int single = inside >= 0.0f ? pv * width + pu : kNone;
    const int whole = least(alone, slack) >= 0.0f ? single : kSeveral;
    const int measured = w_low > 0.0f ? whole : kSeveral;
    cell_pixel[i] = w_high > 0.0f ? measured : kNone;
  }
}

SACCADE_MULTIVERSION
void invert(float* values, std::size_t count) {
  for (std::size_t i = 0; i < count; ++i) {
    const float value = values[i];
    const float inverse = 1.0f / (value > 0.0f ? value : 1.0f);
    values[i] = value > 0.0f ? inverse : 0.0f;
  }
}

struct Corner {
  float u, v, inverse_depth;
};

/// Draws one triangle, nearest surface first; `a, b, c` turn the same way as they do in the depth image when the
/// surface is seen from the front.
void drawTriangle(const Corner& a, const Corner& b, const Corner& c, const Continuity& continuity,
                  cv::Mat1f& inverse_depth) {
  const auto [low, high] = std::minmax({a.inverse_depth, b.inverse_depth, c.inverse_depth});
  if (low <= 0.0f || high - low > continuity.max_step + continuity.max_relative_step * high) return;
  const float area = cross(b.u - a.u, b.v - a.v, c.u - a.u, c.v - a.v);
  if (!(area > kLeastArea)) return;
  const float width = static_cast<float>(inverse_depth.cols), height = static_cast<float>(inverse_depth.rows);
  const int first_u = ceilToInt(std::clamp(std::min({a.u, b.u, c.u}) - kEdgeTolerance, 0.0f, width));
  const int first_v = ceilToInt(std::clamp(std::min({a.v, b.v, c.v}) - kEdgeTolerance, 0.0f, height));
  const int last_u = static_cast<int>(std::clamp(std::max({a.u, b.u, c.u}) + kEdgeTolerance, -1.0f, width - 1.0f));
  const int last_v = static_cast<int>(std::clamp(std::max({a.v, b.v, c.v}) + kEdgeTolerance, -1.0f, height - 1.0f));
  for (int v = first_v; v <= last_v; ++v) {
    float* row = inverse_depth[v];
    for (int u = first_u; u <= last_u; ++u) {
      const float pu = static_cast<float>(u), pv = static_cast<float>(v);
      const float weight_c = cross(b.u - a.u, b.v - a.v, pu - a.u, pv - a.v) / area;
      const float weight_b = cross(pu - a.u, pv - a.v, c.u - a.u, c.v - a.v) / area;
      const float weight_a = 1.0f - weight_b - weight_c;
      if (std::min({weight_a, weight_b, weight_c}) < -kEdgeTolerance) continue;
      row[u] = std::max(row[u], weight_a * a.inverse_depth + weight_b * b.inverse_depth + weight_c * c.inverse_depth);
    }
  }
}

/// Draws what is whole of a cell: both triangles, or the one that leaves the corner behind the discontinuity out.
void drawCell(const Corner& upper_left, const Corner& upper_right, const Corner& lower_left, const Corner& lower_right,
              const Continuity& continuity, cv::Mat1f& inverse_depth) {
  const auto together = [&](const Corner& a, const Corner& b) {
    const float high = std::max(a.inverse_depth, b.inverse_depth), low = std::min(a.inverse_depth, b.inverse_depth);
    return low > 0.0f && high - low <= continuity.max_step + continuity.max_relative_step * high;
  };
  if (together(upper_right, lower_left)) {
    drawTriangle(upper_right, lower_left, upper_left, continuity, inverse_depth);
    drawTriangle(lower_left, upper_right, lower_right, continuity, inverse_depth);
  } else if (together(upper_left, lower_right)) {
    drawTriangle(upper_left, lower_right, lower_left, continuity, inverse_depth);
    drawTriangle(lower_right, upper_left, upper_right, continuity, inverse_depth);
  }
}

}  // namespace

void DepthRegistrationConfig::describe(ConfigVisitor& visitor) {
  visitor.number("max_step_per_m", max_step_per_m, {0.0, 10.0}, "1/m",
                 "inverse depth step between neighbours of one surface, constant part");
  visitor.number("max_relative_step", max_relative_step, {0.0, 1.0}, "",
                 "inverse depth step between neighbours of one surface, share of the inverse depth");
}

DepthRegistration::DepthRegistration(const PinholeCamera& color, const DepthCamera& depth, const Config& config)
    : config_(config), color_(color), depth_(depth.camera) {
  requireValid(config);
  if (color.width <= 0 || color.height <= 0 || depth_.width <= 1 || depth_.height <= 1 || !(depth_.fx > 0) ||
      !(depth_.fy > 0)) {
    throw std::invalid_argument("DepthRegistration: expected two cameras with sizes and focal lengths, found " +
                                std::to_string(color.width) + " x " + std::to_string(color.height) + " and " +
                                std::to_string(depth_.width) + " x " + std::to_string(depth_.height));
  }
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 4; ++column) {
      T_CD_[static_cast<std::size_t>(4 * row + column)] = static_cast<float>(depth.T_CD(row, column));
    }
  }
  const bool distorted = !depth.distortion.isZero();
  ray_x_.create(distorted ? depth_.height : 1, depth_.width);
  ray_y_.create(depth_.height, distorted ? depth_.width : 1);
  for (int v = 0; v < depth_.height; ++v) {
    for (int u = 0; u < depth_.width; ++u) {
      const double x_image = (u - depth_.cx) / depth_.fx, y_image = (v - depth_.cy) / depth_.fy;
      double x = x_image, y = y_image;
      // The inverse of the distortion by fixed point; it contracts for every lens that shows the scene once.
      for (int step = 0; distorted && step < 30; ++step) {
        const auto [dx, dy] = depth.distortion.distort(x, y);
        x += x_image - dx;
        y += y_image - dy;
      }
      if (distorted || v == 0) ray_x_(distorted ? v : 0, u) = static_cast<float>(x);
      if (distorted || u == 0) ray_y_(v, distorted ? u : 0) = static_cast<float>(y);
    }
  }
  const auto width = static_cast<std::size_t>(depth_.width);
  ray_y_row_.resize(width);
  for (ProjectedRow& row : rows_) {
    row.u.resize(width);
    row.v.resize(width);
    row.inverse_depth.resize(width);
  }
  cell_pixel_.resize(width);
  cell_value_.resize(width);
}

void DepthRegistration::projectRow(const cv::Mat1f& depth_D_m, int row, ProjectedRow& projected) {
  const bool distorted = ray_x_.rows > 1;
  if (!distorted) std::fill(ray_y_row_.begin(), ray_y_row_.end(), ray_y_(row, 0));
  const Projection projection{T_CD_, static_cast<float>(color_.fx), static_cast<float>(color_.fy),
                              static_cast<float>(color_.cx), static_cast<float>(color_.cy)};
  projectRays(projection, ray_x_[distorted ? row : 0], distorted ? ray_y_[row] : ray_y_row_.data(), depth_D_m[row],
              depth_.width, projected.u.data(), projected.v.data(), projected.inverse_depth.data());
}

void DepthRegistration::renderCellRow(const ProjectedRow& upper, const ProjectedRow& lower, cv::Mat1f& inverse_depth) {
  const Continuity continuity{static_cast<float>(config_.max_step_per_m),
                              static_cast<float>(config_.max_relative_step)};
  const int cells = depth_.width - 1;
  classifyCells(continuity, {color_.width, color_.height}, upper.u.data(), upper.v.data(), upper.inverse_depth.data(),
                lower.u.data(), lower.v.data(), lower.inverse_depth.data(), cells, cell_pixel_.data(),
                cell_value_.data());
  float* pixels = inverse_depth[0];
  for (std::size_t i = 0; i < static_cast<std::size_t>(cells); ++i) {
    const int pixel = cell_pixel_[i];
    if (pixel >= 0) {
      pixels[pixel] = std::max(pixels[pixel], cell_value_[i]);
    } else if (pixel == kSeveral) {
      const auto corner = [&](const ProjectedRow& row, std::size_t at) {
        return Corner{row.u[at], row.v[at], row.inverse_depth[at]};
      };
      drawCell(corner(upper, i), corner(upper, i + 1), corner(lower, i), corner(lower, i + 1), continuity,
               inverse_depth);
    }
  }
}

void DepthRegistration::render(const cv::Mat1f& depth_D_m, cv::Mat1f& depth_C_m) {
  if (depth_D_m.cols != depth_.width || depth_D_m.rows != depth_.height) {
    throw std::invalid_argument("DepthRegistration: expected a depth image of " + std::to_string(depth_.width) + " x " +
                                std::to_string(depth_.height) + ", found " + std::to_string(depth_D_m.cols) + " x " +
                                std::to_string(depth_D_m.rows));
  }
  depth_C_m.create(color_.height, color_.width);
  if (!depth_C_m.isContinuous()) depth_C_m = cv::Mat1f(color_.height, color_.width);
  depth_C_m.setTo(0.0f);  // holds inverse depth until the last step: 0 is infinitely far, the nearest has the largest
  projectRow(depth_D_m, 0, rows_[0]);
  for (int row = 1; row < depth_.height; ++row) {
    ProjectedRow& upper = rows_[static_cast<std::size_t>(row - 1) % 2];
    ProjectedRow& lower = rows_[static_cast<std::size_t>(row) % 2];
    projectRow(depth_D_m, row, lower);
    renderCellRow(upper, lower, depth_C_m);
  }
  invert(depth_C_m[0], depth_C_m.total());
}

}  // namespace saccade
