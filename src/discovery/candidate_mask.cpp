#include "saccade/discovery/candidate_mask.hpp"

#include <algorithm>

namespace saccade {

void drawMask(const Candidate& candidate, const Perception& seen, cv::Mat1b& mask) {
  mask.create(seen.imageSize());
  mask.setTo(0);
  forEachMaskRun(candidate, seen,
                 [&](int v, int begin, int end) { std::fill(mask[v] + begin, mask[v] + end, std::uint8_t{255}); });
}

cv::Mat1b boxMask(const Candidate& candidate, const Perception& seen) {
  cv::Mat1b mask(candidate.box.size(), std::uint8_t{0});
  forEachMaskRun(candidate, seen, [&](int v, int begin, int end) {
    std::uint8_t* row = mask[v - candidate.box.y] - candidate.box.x;
    std::fill(row + begin, row + end, std::uint8_t{255});
  });
  return mask;
}

}  // namespace saccade
