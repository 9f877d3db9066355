#pragma once

#include <vector>

#include "bench/prepared_frames.hpp"
#include "saccade/discovery/perceiver.hpp"

namespace saccade::bench {

/// A kitchen frame as the candidate stages see it.
struct PerceivedFrame {
  DepthMaps depth;
  cv::Mat3b color;
  Perception seen;
};

/// The frames of preparedFrames(), perceived once. Building their tables anew changes nothing.
[[nodiscard]] std::vector<PerceivedFrame>& perceivedFrames();

}  // namespace saccade::bench
