#include "simulation/mesh_shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <Eigen/Geometry>

namespace saccade {
namespace {

using Eigen::Vector2f;
using Eigen::Vector3f;

constexpr float kTwoPi = 2 * std::numbers::pi_v<float>;
constexpr float kHardEdgeCosine = 0.766f;  // 40 degrees

int cellsAlong(float length_m, float cell_m) {
  return std::max(1, static_cast<int>(std::ceil(length_m / cell_m - 1e-3f)));
}

/// Two triangles over the grid cell whose corners are the given vertices, counter-clockwise from outside.
void addCell(Mesh& mesh, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

/// The six faces of a box, each handed to `add(corner, right, down, face)`; faces 0-1 are front and back (+-y), 2-3 the
/// sides (+-x), 4-5 top and bottom.
template <typename Add>
void forBoxFaces(const Vector3f& size, const Add& add) {
  const float x = size.x() / 2, y = size.y() / 2, z = size.z();
  add(Vector3f(x, y, z), Vector3f(-2 * x, 0, 0), Vector3f(0, 0, -z), 0);
  add(Vector3f(-x, -y, z), Vector3f(2 * x, 0, 0), Vector3f(0, 0, -z), 1);
  add(Vector3f(x, -y, z), Vector3f(0, 2 * y, 0), Vector3f(0, 0, -z), 2);
  add(Vector3f(-x, y, z), Vector3f(0, -2 * y, 0), Vector3f(0, 0, -z), 3);
  add(Vector3f(x, -y, z), Vector3f(-2 * x, 0, 0), Vector3f(0, 2 * y, 0), 4);
  add(Vector3f(-x, -y, 0), Vector3f(2 * x, 0, 0), Vector3f(0, 2 * y, 0), 5);
}

}  // namespace

void addRectangle(Mesh& mesh, const Vector3f& corner, const Vector3f& right, const Vector3f& down, float cell_m,
                  const TextureWindow& window) {
  const int columns = cellsAlong(right.norm(), cell_m), rows = cellsAlong(down.norm(), cell_m);
  const Vector3f normal = down.cross(right).normalized();
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  for (int row = 0; row <= rows; ++row) {
    const float t = static_cast<float>(row) / static_cast<float>(rows);
    for (int column = 0; column <= columns; ++column) {
      const float s = static_cast<float>(column) / static_cast<float>(columns);
      mesh.addVertex(corner + s * right + t * down, normal,
                     {window.u0 + s * (window.u1 - window.u0), window.v0 + t * (window.v1 - window.v0)});
    }
  }
  const auto stride = static_cast<std::uint32_t>(columns + 1);
  for (std::uint32_t row = 0; row < static_cast<std::uint32_t>(rows); ++row) {
    for (std::uint32_t column = 0; column < static_cast<std::uint32_t>(columns); ++column) {
      const std::uint32_t a = first + row * stride + column;
      addCell(mesh, a, a + stride, a + stride + 1, a + 1);
    }
  }
}

Mesh makeRectangle(const Vector3f& corner, const Vector3f& right, const Vector3f& down, float cell_m,
                   const TextureWindow& window) {
  Mesh mesh;
  addRectangle(mesh, corner, right, down, cell_m, window);
  return mesh;
}

Mesh makeBox(const Vector3f& size_m, float cell_m) {
  Mesh mesh;
  forBoxFaces(size_m, [&](const Vector3f& corner, const Vector3f& right, const Vector3f& down, int face) {
    addRectangle(mesh, corner, right, down, cell_m, face < 2 ? kFrontWindow : face < 4 ? kSideWindow : kTopWindow);
  });
  return mesh;
}

Mesh makeTiledBox(const Vector3f& size_m, float tile_m, float cell_m) {
  Mesh mesh;
  forBoxFaces(size_m, [&](const Vector3f& corner, const Vector3f& right, const Vector3f& down, int) {
    // The grain of wood runs along u: along the longer edge.
    const bool upright = down.norm() > right.norm();
    const auto first = mesh.uv.size();
    addRectangle(mesh, corner, right, down, cell_m, {0, 0, right.norm() / tile_m, down.norm() / tile_m});
    if (!upright) return;
    for (auto i = first; i < mesh.uv.size(); ++i) std::swap(mesh.uv[i].x(), mesh.uv[i].y());
  });
  return mesh;
}

Mesh makeLathe(const std::vector<Vector2f>& profile, int segments) {
  // Long straight pieces are divided, so that light has places to be stored.
  std::vector<Vector2f> points = {profile.front()};
  for (std::size_t i = 1; i < profile.size(); ++i) {
    const int pieces = cellsAlong((profile[i] - profile[i - 1]).norm(), kObjectCell_m);
    for (int k = 1; k <= pieces; ++k) {
      points.push_back(profile[i - 1] +
                       static_cast<float>(k) / static_cast<float>(pieces) * (profile[i] - profile[i - 1]));
    }
  }
  const std::size_t pieces = points.size() - 1;
  std::vector<Vector2f> outward(pieces);
  std::vector<float> along(points.size(), 0.0f);
  for (std::size_t i = 0; i < pieces; ++i) {
    const Vector2f step = points[i + 1] - points[i];
    along[i + 1] = along[i] + step.norm();
    outward[i] = Vector2f(step.y(), -step.x()).normalized();
  }
  const auto normalAt = [&](std::size_t piece, std::size_t neighbour) -> Vector2f {
    const bool smooth = neighbour < pieces && outward[piece].dot(outward[neighbour]) > kHardEdgeCosine;
    return smooth ? Vector2f((outward[piece] + outward[neighbour]).normalized()) : outward[piece];
  };
  Mesh mesh;
  for (std::size_t i = 0; i < pieces; ++i) {
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (std::size_t end = 0; end < 2; ++end) {
      const Vector2f& p = points[i + end];
      const Vector2f n = end == 0 ? normalAt(i, i - 1) : normalAt(i, i + 1);
      for (int k = 0; k <= segments; ++k) {
        const float u = static_cast<float>(k) / static_cast<float>(segments);
        const float c = std::cos(kTwoPi * u), s = std::sin(kTwoPi * u);
        mesh.addVertex({p.x() * c, p.x() * s, p.y()}, {n.x() * c, n.x() * s, n.y()},
                       {u, 1 - along[i + end] / along.back()});
      }
    }
    const auto stride = static_cast<std::uint32_t>(segments + 1);
    for (std::uint32_t k = first; k < first + stride - 1; ++k) addCell(mesh, k, k + 1, k + stride + 1, k + stride);
  }
  return mesh;
}

Mesh makeEllipsoid(const Vector3f& half_size_m) {
  constexpr int kPieces = 14;
  std::vector<Vector2f> profile;
  for (int i = 0; i <= kPieces; ++i) {
    const float angle = kTwoPi / 2 * static_cast<float>(i) / kPieces;
    profile.emplace_back(std::sin(angle), 1 - std::cos(angle));
  }
  profile.front().x() = profile.back().x() = 0;
  // The unit ball is one piece of profile per cell: shrink first, so that the lathe does not divide it again.
  for (Vector2f& p : profile) p *= 0.05f;
  Mesh mesh = makeLathe(profile, 24);
  mesh.scale(half_size_m / 0.05f);
  return mesh;
}

Mesh makeExtrusion(const std::vector<Vector2f>& outline, float height_m) {
  Mesh mesh;
  Vector2f centroid = Vector2f::Zero(), low = outline[0], high = outline[0];
  for (const Vector2f& p : outline) {
    centroid += p / static_cast<float>(outline.size());
    low = low.cwiseMin(p);
    high = high.cwiseMax(p);
  }
  for (std::size_t i = 0; i < outline.size(); ++i) {
    const Vector2f &a = outline[i], &b = outline[(i + 1) % outline.size()];
    addRectangle(mesh, {a.x(), a.y(), height_m}, {b.x() - a.x(), b.y() - a.y(), 0}, {0, 0, -height_m}, kObjectCell_m,
                 kSideWindow);
  }
  for (const bool top : {true, false}) {
    const float z = top ? height_m : 0;
    const auto uvAt = [&](const Vector2f& p) {
      const Vector2f share = (p - low).cwiseQuotient(high - low);
      return Vector2f(kFrontWindow.u1 * share.x(), kFrontWindow.v1 * (1 - share.y()));
    };
    const Vector3f normal(0, 0, top ? 1.0f : -1.0f);
    const std::uint32_t middle = mesh.addVertex({centroid.x(), centroid.y(), z}, normal, uvAt(centroid));
    const std::uint32_t first = middle + 1;
    for (const Vector2f& p : outline) mesh.addVertex({p.x(), p.y(), z}, normal, uvAt(p));
    const auto corners = static_cast<std::uint32_t>(outline.size());
    for (std::uint32_t i = 0; i < corners; ++i) {
      const std::uint32_t a = first + i, b = first + (i + 1) % corners;
      mesh.triangles.push_back(top ? std::array{middle, a, b} : std::array{middle, b, a});
    }
  }
  return mesh;
}

Mesh makeTube(const std::vector<Vector3f>& path, const std::vector<float>& radius_m, int segments) {
  Mesh mesh;
  const std::size_t rings = path.size();
  Vector3f side = Vector3f::UnitX();
  for (std::size_t i = 0; i < rings; ++i) {
    const Vector3f ahead = (path[std::min(i + 1, rings - 1)] - path[i == 0 ? 0 : i - 1]).normalized();
    // Carries the last ring's side along, so that the tube does not twist.
    if (i == 0) side = ahead.unitOrthogonal();
    side = (side - side.dot(ahead) * ahead).normalized();
    const Vector3f up = ahead.cross(side);
    for (int k = 0; k <= segments; ++k) {
      const float u = static_cast<float>(k) / static_cast<float>(segments);
      const Vector3f out = std::cos(kTwoPi * u) * side + std::sin(kTwoPi * u) * up;
      mesh.addVertex(path[i] + radius_m[i] * out, out, {u, static_cast<float>(i) / static_cast<float>(rings - 1)});
    }
  }
  const auto stride = static_cast<std::uint32_t>(segments + 1);
  for (std::uint32_t ring = 0; ring + 1 < rings; ++ring) {
    for (std::uint32_t k = ring * stride; k + 1 < (ring + 1) * stride; ++k) {
      addCell(mesh, k, k + 1, k + stride + 1, k + stride);
    }
  }
  for (const bool end : {false, true}) {
    const std::size_t ring = end ? rings - 1 : 0;
    const Vector3f outward = (path[ring] - path[end ? ring - 1 : 1]).normalized();
    const std::uint32_t tip = mesh.addVertex(path[ring], outward, {0.5f, end ? 1.0f : 0.0f});
    const auto first = static_cast<std::uint32_t>(ring) * stride;
    for (std::uint32_t k = first; k + 1 < first + stride; ++k) {
      mesh.triangles.push_back(end ? std::array{tip, k, k + 1} : std::array{tip, k + 1, k});
    }
  }
  return mesh;
}

}  // namespace saccade
