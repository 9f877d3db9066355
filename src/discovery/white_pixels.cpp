#include "discovery/white_pixels.hpp"

#include <stdexcept>
#include <string>

namespace saccade {
namespace {

/// For each pixel, and the end of each row, how many white ones the row has before it.
cv::Mat1i whiteBefore(const cv::Mat1b& image) {
  cv::Mat1i before(image.rows, image.cols + 1);
  for (int v = 0; v < image.rows; ++v) {
    const std::uint8_t* white = image[v];
    int* counts = before[v];
    int count = 0;
    for (int u = 0; u < image.cols; ++u) {
      counts[u] = count;
      count += white[u] != 0 ? 1 : 0;
    }
    counts[image.cols] = count;
  }
  return before;
}

/// White pixels of each segment: those of a run are the difference of two sums along the row.
std::vector<int> bySegment(const LabelRuns& runs, const cv::Mat1i& white_before) {
  std::vector<int> pixels(static_cast<std::size_t>(runs.segments()), 0);
  for (int v = 0; v < runs.rows(); ++v) {
    const int* before = white_before[v];
    if (before[white_before.cols - 1] == 0) continue;
    int begin = 0;
    for (const LabelRun& run : runs.row(v)) {
      if (run.label >= 0) pixels[static_cast<std::size_t>(run.label)] += before[run.end_u] - before[begin];
      begin = run.end_u;
    }
  }
  return pixels;
}

}  // namespace

WhitePixels::WhitePixels(const cv::Mat1b& image, const Perception& seen, const char* name) {
  const cv::Size expected = seen.imageSize();
  if (image.size() != expected) {
    throw std::invalid_argument(std::string(name) + " has " + std::to_string(image.cols) + "x" +
                                std::to_string(image.rows) + " pixels, the frame " + std::to_string(expected.width) +
                                "x" + std::to_string(expected.height));
  }
  const cv::Mat1i white_before = whiteBefore(image);
  color_ = bySegment(seen.color_segments.runs(), white_before);
  surface_ = bySegment(seen.surface_segments.runs(), white_before);
}

double WhitePixels::shareOf(const Candidate& candidate) const {
  if (candidate.area <= 0) return 0.0;
  const std::vector<int>& pixels = candidate.source == CandidateSource::kColor ? color_ : surface_;
  int white = 0;
  for (const std::int32_t segment : candidate.segments) white += pixels[static_cast<std::size_t>(segment)];
  return static_cast<double>(white) / candidate.area;
}

}  // namespace saccade
