#include <algorithm>
#include <cmath>

#include "simulation/primitive_geometry.hpp"

namespace saccade {
namespace {

std::uint32_t cellHash(std::int32_t i, std::int32_t j, std::uint32_t seed) {
  std::uint32_t h =
      static_cast<std::uint32_t>(i) * 0x8da6b343u ^ static_cast<std::uint32_t>(j) * 0xd8163841u ^ seed * 0xcb1ab31fu;
  h = (h ^ (h >> 15)) * 0x2c1b3c6du;
  h = (h ^ (h >> 12)) * 0x297a2d39u;
  return h ^ (h >> 15);
}

float cellValue(std::int32_t i, std::int32_t j, std::uint32_t seed) {
  return static_cast<float>(cellHash(i, j, seed) >> 8) * 0x1p-24f;
}

/// Smooth noise in 0..1 with cells of size 1.
float valueNoise(double s, double t, std::uint32_t seed) {
  const double fs = std::floor(s), ft = std::floor(t);
  const auto i = static_cast<std::int32_t>(fs), j = static_cast<std::int32_t>(ft);
  float x = static_cast<float>(s - fs), y = static_cast<float>(t - ft);
  x = x * x * (3 - 2 * x);
  y = y * y * (3 - 2 * y);
  const float a = cellValue(i, j, seed), b = cellValue(i + 1, j, seed);
  const float c = cellValue(i, j + 1, seed), d = cellValue(i + 1, j + 1, seed);
  return a + x * (b - a) + y * (c - a) + x * y * (a - b - c + d);
}

Eigen::Vector3f blend(const Material& material, float share) {
  return material.color + share * (material.second - material.color);
}

/// Coordinates along the surface in metres.
Eigen::Vector2d surfaceCoordinates(const Primitive& primitive, const Eigen::Vector3d& p, const Eigen::Vector3d& n) {
  switch (primitive.shape) {
    case Shape::kRectangle:
      return {p.x(), p.y()};
    case Shape::kSphere:
      return {primitive.half_size_m.x() * std::atan2(p.y(), p.x()),
              primitive.half_size_m.x() * std::asin(std::clamp(n.z(), -1.0, 1.0))};
    case Shape::kCylinder:
      if (std::abs(n.z()) > 0.5) return {p.x(), p.y()};
      return {primitive.half_size_m.x() * std::atan2(p.y(), p.x()), p.z()};
    case Shape::kBox:
      break;
  }
  if (std::abs(n.x()) > 0.5) return {p.y(), p.z()};
  if (std::abs(n.y()) > 0.5) return {p.x(), p.z()};
  return {p.x(), p.y()};
}

/// A print: patches of colour, some with a disc, so that every place looks different.
Eigen::Vector3f picture(const Material& material, double s, double t) {
  const double x = s / material.scale_m, y = t / material.scale_m;
  const auto i = static_cast<std::int32_t>(std::floor(x)), j = static_cast<std::int32_t>(std::floor(y));
  const std::uint32_t h = cellHash(i, j, material.seed);
  Eigen::Vector3f color = blend(material, static_cast<float>(h & 7) / 7.0f);
  if ((h >> 3 & 3) == 0) {
    const double dx = x - i - 0.5, dy = y - j - 0.5;
    if (dx * dx + dy * dy < 0.13) color = Eigen::Vector3f::Ones() - 0.8f * color;
  } else if ((h >> 3 & 3) == 1) {
    const double line = (y - j) * 5;  // looks like lines of text
    if (line - std::floor(line) < 0.45 &&
        cellValue(static_cast<std::int32_t>(x * 9), j * 5 + static_cast<std::int32_t>(line), material.seed) < 0.7f) {
      color *= 0.35f;
    }
  }
  return color;
}

}  // namespace

Eigen::Vector3f albedoAt(const Primitive& primitive, const Eigen::Vector3d& p_O, const Eigen::Vector3d& normal_O) {
  const Material& material = primitive.material;
  if (material.pattern == Pattern::kPlain) return material.color;
  const Eigen::Vector2d st = surfaceCoordinates(primitive, p_O, normal_O);
  const double s = st.x() / material.scale_m, t = st.y() / material.scale_m;
  switch (material.pattern) {
    case Pattern::kChecker: {
      const auto parity = (static_cast<std::int64_t>(std::floor(s)) + static_cast<std::int64_t>(std::floor(t))) & 1;
      return parity != 0 ? material.second : material.color;
    }
    case Pattern::kStripes: {
      const auto band = static_cast<std::int32_t>(std::floor(t));
      return blend(material, (band & 1) != 0 ? 1.0f : 0.35f * cellValue(band, 0, material.seed));
    }
    case Pattern::kSpeckle: {
      const float coarse = valueNoise(s, t, material.seed), fine = valueNoise(4 * s, 4 * t, material.seed + 1);
      return blend(material, 0.6f * coarse + 0.4f * fine);
    }
    case Pattern::kWood: {
      const float warp = valueNoise(s, 0.5 * t, material.seed);
      const float grain = valueNoise(12 * s + 3 * warp, 0.6 * t, material.seed + 1);
      return blend(material, 0.3f * warp + 0.7f * grain);
    }
    case Pattern::kPicture:
      return picture(material, st.x(), st.y());
    case Pattern::kPlain:
      break;
  }
  return material.color;
}

}  // namespace saccade
