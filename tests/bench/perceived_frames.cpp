#include "bench/perceived_frames.hpp"

namespace saccade::bench {

std::vector<PerceivedFrame>& perceivedFrames() {
  static std::vector<PerceivedFrame> perceived = [] {
    const std::vector<PreparedFrame>& prepared = preparedFrames();
    std::vector<PerceivedFrame> frames(prepared.size());
    Perceiver perceiver;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      frames[i].depth = prepared[i].depth;
      frames[i].color = prepared[i].color;
      perceiver.perceive(frames[i].color, &frames[i].depth, frames[i].seen);
    }
    return frames;
  }();
  return perceived;
}

}  // namespace saccade::bench
