#pragma once

#include <vector>

#include "simulation/embree_scene.hpp"

namespace saccade {

/// Brightness at every vertex of a surface as a factor on its texture's grey levels (gamma 2.2 applied).
using VertexLight = std::vector<float>;

/// Lights all surfaces: each lamp by rays to places spread over it, so that shadows are soft, and ambient light by rays
/// over the hemisphere, so that corners and gaps are dark. The rays of a vertex depend on its place only. Runs on all
/// threads; about 10 us a vertex.
[[nodiscard]] std::vector<VertexLight> bakeLight(const Scene& scene, const EmbreeScene& rays);

}  // namespace saccade
