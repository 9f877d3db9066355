#include "saccade/tracking/photometric_reference.hpp"

#include <cmath>
#include <utility>

#include "tracking/rigid_motion.hpp"

namespace saccade {
namespace {

using Points = PhotometricReference::Points;

struct Texture {
  float grey = 0.0F;
  float along_u = 0.0F, along_v = 0.0F;  // grey levels per pixel
};

float bilinear(const cv::Mat1f& image, float u, float v) {
  const int column = static_cast<int>(u), row = static_cast<int>(v);
  const float right = u - static_cast<float>(column), down = v - static_cast<float>(row);
  const float* upper = image[row] + column;
  const float* lower = image[row + 1] + column;
  return (1.0F - down) * ((1.0F - right) * upper[0] + right * upper[1]) +
         down * ((1.0F - right) * lower[0] + right * lower[1]);
}

// At least two pixels from the image's border.
Texture textureAt(const cv::Mat1f& image, float u, float v) {
  return {bilinear(image, u, v), 0.5F * (bilinear(image, u + 1.0F, v) - bilinear(image, u - 1.0F, v)),
          0.5F * (bilinear(image, u, v + 1.0F) - bilinear(image, u, v - 1.0F))};
}

// Of the projected point's grey value, by the derivative of u = fx x / z + cx and v = fy y / z + cy.
Eigen::Vector3f slopeOf(const Texture& texture, const PinholeCamera& camera, const Eigen::Vector3f& point) {
  const float per_z = 1.0F / point.z();
  const float x = texture.along_u * static_cast<float>(camera.fx) * per_z;
  const float y = texture.along_v * static_cast<float>(camera.fy) * per_z;
  return {x, y, -(x * point.x() + y * point.y()) * per_z};
}

}  // namespace

void PhotometricReferenceConfig::describe(ConfigVisitor& visitor) {
  visitor.number("shift_m", shift_m, {0.0, 100.0}, "m", "a camera farther from the reference becomes the next one");
  visitor.number("turn_rad", turn_rad, {0.0, 3.2}, "rad", "or one that is turned by more");
  visitor.number("smallest_gradient", smallest_gradient, {0.0, 255.0}, "grey levels",
                 "of points, per pixel of half the resolution");
}

PhotometricReference::PhotometricReference(const Config& config) : config_(config) {
  requireValid(config_);
}

bool PhotometricReference::wants(const Pose& T_WC) const {
  if (!taken_) return true;
  const Pose T_RC = state_.T_WR.inverse() * T_WC;
  return T_RC.translation().norm() > config_.shift_m || rotationVector(T_RC.linear()).norm() > config_.turn_rad;
}

void PhotometricReference::take(const DepthMaps& depth, const IntensityPyramid& intensity, const Pose& T_WC) {
  constexpr int kStep = 2;
  constexpr int kBorder = 6;  // two pixels of a quarter's resolution and what interpolation reads beyond
  const IntensityPyramid::Level& half = intensity.levels[0];
  const IntensityPyramid::Level& quarter = intensity.levels[1];
  const auto least_square = static_cast<float>(config_.smallest_gradient * config_.smallest_gradient);
  Points& points = state_.points;
  const auto most =
      static_cast<std::size_t>((half.grey.cols / kStep + 1) * (half.grey.rows / kStep + 1)) + Points::kBlock;
  Points::forEachArray(points, [&](std::vector<float>& array) { array.resize(most); });
  points.count = 0;
  for (int v = kBorder; v < half.grey.rows - kBorder; v += kStep) {
    for (int u = kBorder; u < half.grey.cols - kBorder; u += kStep) {
      const cv::Vec3f& normal = depth.normals(2 * v + 1, 2 * u + 1);
      if (normal == cv::Vec3f(0, 0, 0)) continue;
      const auto at_u = static_cast<float>(u), at_v = static_cast<float>(v);
      const Texture fine = textureAt(half.grey, at_u, at_v);
      if (fine.along_u * fine.along_u + fine.along_v * fine.along_v < least_square) continue;
      const Texture coarse = textureAt(quarter.grey, 0.5F * at_u - 0.25F, 0.5F * at_v - 0.25F);
      const double z = static_cast<double>(depth.vertices(2 * v + 1, 2 * u + 1)[2]);
      const Eigen::Vector3f point = half.camera.unproject(u, v, z).cast<float>();
      const Eigen::Vector3f slopes[] = {slopeOf(fine, half.camera, point), slopeOf(coarse, quarter.camera, point)};
      const float greys[] = {fine.grey, coarse.grey};
      const std::size_t i = points.count++;
      for (std::size_t axis = 0; axis < 3; ++axis) points.position[axis][i] = point[static_cast<int>(axis)];
      for (std::size_t level = 0; level < IntensityPyramid::kLevels; ++level) {
        points.levels[level].grey[i] = greys[level];
        for (std::size_t axis = 0; axis < 3; ++axis) {
          points.levels[level].slope[axis][i] = slopes[level][static_cast<int>(axis)];
        }
      }
    }
  }
  const std::size_t padded = (points.count + Points::kBlock - 1) / Points::kBlock * Points::kBlock;
  Points::forEachArray(points, [&](std::vector<float>& array) {
    std::fill(array.begin() + static_cast<std::ptrdiff_t>(points.count),
              array.begin() + static_cast<std::ptrdiff_t>(padded), 0.0F);
    array.resize(padded);
  });
  state_.T_WR = T_WC;
  taken_ = true;
  ++changes_;
}

void PhotometricReference::restore(State state) {
  state_ = std::move(state);
  taken_ = true;
  ++changes_;
}

}  // namespace saccade
