#pragma once

#include <vector>

#include "saccade/simulation/mesh.hpp"

namespace saccade {

/// Part of a texture that a face shows.
struct TextureWindow {
  float u0 = 0, v0 = 0, u1 = 1, v1 = 1;
};

/// Parts of a package's texture: the large sides, the narrow sides, top and bottom.
inline constexpr TextureWindow kFrontWindow{0.0f, 0.0f, 0.6f, 0.7f};
inline constexpr TextureWindow kSideWindow{0.6f, 0.0f, 1.0f, 0.7f};
inline constexpr TextureWindow kTopWindow{0.0f, 0.7f, 1.0f, 1.0f};

/// Largest distance of neighbouring vertices, where light is stored: what is finer is blurred.
inline constexpr float kObjectCell_m = 0.02f;

/// Adds a rectangle from `corner` along `right` and `down`; it faces right x (-down). The texture's first row is at
/// `corner`. The vertices are at most `cell_m` apart.
void addRectangle(Mesh& mesh, const Eigen::Vector3f& corner, const Eigen::Vector3f& right, const Eigen::Vector3f& down,
                  float cell_m, const TextureWindow& window = {});

/// A rectangle as a mesh of its own.
[[nodiscard]] Mesh makeRectangle(const Eigen::Vector3f& corner, const Eigen::Vector3f& right,
                                 const Eigen::Vector3f& down, float cell_m, const TextureWindow& window = {});

/// Box on the plane z = 0, centred on the z axis, with the windows of a package; the front faces +y.
[[nodiscard]] Mesh makeBox(const Eigen::Vector3f& size_m, float cell_m = kObjectCell_m);
/// The same with the whole texture repeated every `tile_m` on all faces: furniture.
[[nodiscard]] Mesh makeTiledBox(const Eigen::Vector3f& size_m, float tile_m, float cell_m);

/// Surface of revolution about z of a profile (radius, z) in metres, given from the bottom upwards on the outside; u
/// runs around, v from the profile's end (0) to its start (1). Edges sharper than 40 degrees stay hard.
[[nodiscard]] Mesh makeLathe(const std::vector<Eigen::Vector2f>& profile, int segments = 28);

/// Ball stretched to the half sizes, resting on z = 0.
[[nodiscard]] Mesh makeEllipsoid(const Eigen::Vector3f& half_size_m);

/// Prism over a polygon that is star-shaped about its centroid and goes round counter-clockwise, from z = 0 up.
[[nodiscard]] Mesh makeExtrusion(const std::vector<Eigen::Vector2f>& outline, float height_m);

/// Tube along a path with a radius at each of its points; ends are capped by a point.
[[nodiscard]] Mesh makeTube(const std::vector<Eigen::Vector3f>& path, const std::vector<float>& radius_m,
                            int segments = 10);

}  // namespace saccade
