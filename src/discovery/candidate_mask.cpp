#include "saccade/discovery/candidate_mask.hpp"

#include <algorithm>

namespace saccade {

void drawMask(const Candidate& candidate, const Perception& seen, cv::Mat1b& mask) {
  mask.create(seen.imageSize());
  mask.setTo(0);
  forEachMaskRun(candidate, seen,
                 [&](int v, int begin, int end) { std::fill(mask[v] + begin, mask[v] + end, std::uint8_t{255}); });
}

}  // namespace saccade
