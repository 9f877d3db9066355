#pragma once

#include <algorithm>
#include <cmath>
#include <limits>

#include "saccade/simulation/scene.hpp"

namespace saccade {

constexpr double kNoHit = std::numeric_limits<double>::infinity();

/// First t > 0 at which the ray `o + t * d`, in the primitive's own frame, meets its surface; kNoHit if it does not. A
/// ray from inside a closed shape meets the shape from within.
[[nodiscard]] inline double intersect(Shape shape, const Eigen::Vector3d& half, const Eigen::Vector3d& o,
                                      const Eigen::Vector3d& d) {
  switch (shape) {
    case Shape::kRectangle: {
      const double t = -o.z() / d.z();
      if (!(t > 0)) return kNoHit;
      return std::abs(o.x() + t * d.x()) <= half.x() && std::abs(o.y() + t * d.y()) <= half.y() ? t : kNoHit;
    }
    case Shape::kBox: {
      double enter = -kNoHit, leave = kNoHit;
      for (int axis = 0; axis < 3; ++axis) {
        if (d[axis] == 0) {
          if (std::abs(o[axis]) > half[axis]) return kNoHit;
          continue;
        }
        const double inverse = 1.0 / d[axis];
        const double middle = -o[axis] * inverse, reach = half[axis] * std::abs(inverse);
        enter = std::max(enter, middle - reach);
        leave = std::min(leave, middle + reach);
      }
      if (enter > leave || !(leave > 0)) return kNoHit;
      return enter > 0 ? enter : leave;
    }
    case Shape::kCylinder: {
      const double r = half.x(), h = half.z();
      double enter = -kNoHit, leave = kNoHit;
      const double a = d.x() * d.x() + d.y() * d.y();
      const double c = o.x() * o.x() + o.y() * o.y() - r * r;
      if (a > 0) {
        const double b = o.x() * d.x() + o.y() * d.y();
        const double discriminant = b * b - a * c;
        if (discriminant < 0) return kNoHit;
        const double root = std::sqrt(discriminant);
        enter = (-b - root) / a;
        leave = (-b + root) / a;
      } else if (c > 0) {
        return kNoHit;
      }
      if (d.z() != 0) {
        const double middle = -o.z() / d.z(), reach = h / std::abs(d.z());
        enter = std::max(enter, middle - reach);
        leave = std::min(leave, middle + reach);
      } else if (std::abs(o.z()) > h) {
        return kNoHit;
      }
      if (enter > leave || !(leave > 0)) return kNoHit;
      return enter > 0 ? enter : leave;
    }
    case Shape::kSphere: {
      const double a = d.squaredNorm(), b = o.dot(d), c = o.squaredNorm() - half.x() * half.x();
      const double discriminant = b * b - a * c;
      if (discriminant < 0) return kNoHit;
      const double root = std::sqrt(discriminant);
      if (-b - root > 0) return (-b - root) / a;
      return -b + root > 0 ? (-b + root) / a : kNoHit;
    }
  }
  return kNoHit;
}

/// Outward unit normal at a point of the surface, in the primitive's own frame.
[[nodiscard]] inline Eigen::Vector3d outwardNormal(Shape shape, const Eigen::Vector3d& half, const Eigen::Vector3d& p) {
  switch (shape) {
    case Shape::kRectangle:
      return Eigen::Vector3d::UnitZ();
    case Shape::kSphere:
      return p / half.x();
    case Shape::kCylinder: {
      const double radius = std::hypot(p.x(), p.y());
      if (half.z() - std::abs(p.z()) < half.x() - radius) return {0, 0, p.z() > 0 ? 1.0 : -1.0};
      return {p.x() / radius, p.y() / radius, 0};
    }
    case Shape::kBox:
      break;
  }
  int axis = 0;
  (half - p.cwiseAbs()).minCoeff(&axis);
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  normal[axis] = p[axis] > 0 ? 1.0 : -1.0;
  return normal;
}

/// Half sizes of the box that encloses the primitive in its own frame.
[[nodiscard]] inline Eigen::Vector3d enclosingHalfSize(const Primitive& primitive) {
  const Eigen::Vector3d& half = primitive.half_size_m;
  switch (primitive.shape) {
    case Shape::kRectangle:
      return {half.x(), half.y(), 0};
    case Shape::kCylinder:
      return {half.x(), half.x(), half.z()};
    case Shape::kSphere:
      return Eigen::Vector3d::Constant(half.x());
    case Shape::kBox:
      break;
  }
  return half;
}

/// Colour of the primitive at a point of its surface (own frame).
[[nodiscard]] Eigen::Vector3f albedoAt(const Primitive& primitive, const Eigen::Vector3d& p_O,
                                       const Eigen::Vector3d& normal_O);

}  // namespace saccade
