#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "saccade/core/frame.hpp"
#include "saccade/simulation/scene.hpp"

namespace saccade {

/// A scene and a hand-held camera's way through it. World z is up, the floor is z = 0.
struct SimulatedWorld {
  Scene scene;
  std::function<Pose(std::int64_t frame)> cameraPose;  ///< T_WC; at most 2 cm and 1.5 degrees from frame to frame
};

/// A kind of scene that can be made from any seed.
struct SceneKind {
  const char* name;
  const char* what;             ///< one line for people
  std::int64_t default_frames;  ///< of a sequence; the camera comes back to its start after this many or a few more
  SimulatedWorld (*make)(std::uint64_t seed, std::int64_t loop_frames);
};

/// desk, coffee, office, flat and plain.
[[nodiscard]] const std::vector<SceneKind>& sceneKinds();

/// The kind of that name; null if there is none.
[[nodiscard]] const SceneKind* findSceneKind(const std::string& name);

/// Makes an instance of a kind with its usual camera path.
[[nodiscard]] inline SimulatedWorld makeWorld(const SceneKind& kind, std::uint64_t seed) {
  return kind.make(seed, kind.default_frames);
}

}  // namespace saccade
