#include "saccade/core/errors.hpp"
#include "saccade/exchange/mrpt_scene.hpp"

// Stands in for mrpt_scene.cpp where MRPT is not installed.

namespace saccade {

bool canWriteMrptScene() {
  return false;
}

void writeMrptScene(const SceneContent& /*content*/, const std::filesystem::path& path) {
  throw IoError(path, "a build with MRPT for .3Dscene files (install libmrpt-opengl-dev, then configure again)",
                "one without");
}

}  // namespace saccade
