#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "saccade/discovery/candidate.hpp"
#include "saccade/discovery/perception.hpp"

namespace saccade {

/// How many pixels of a frame's segments, and so of its candidates, are not 0 in an image.
class WhitePixels {
 public:
  /// One pass over `image`, which has the size of what is `seen`. Throws std::invalid_argument otherwise, calling the
  /// image by `name`.
  WhitePixels(const cv::Mat1b& image, const Perception& seen, const char* name);

  /// Of all pixels of the candidate, 0..1. O(segments).
  [[nodiscard]] double shareOf(const Candidate& candidate) const;

 private:
  std::vector<int> color_, surface_;  // by segment
};

}  // namespace saccade
