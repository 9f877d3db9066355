#pragma once

#include <vector>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"

namespace saccade::bench {

/// Real frames of the kitchen sequence, decoded and registered, with the dataset's poses; read once.
struct KitchenFrames {
  PinholeCamera camera;
  std::vector<RgbdFrame> frames;
};

/// Every fifth of the first 250 frames. Ends the program with a clear sentence where the data is absent.
[[nodiscard]] const KitchenFrames& kitchenFrames();

}  // namespace saccade::bench
