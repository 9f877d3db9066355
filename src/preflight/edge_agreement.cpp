#include "preflight/edge_agreement.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <opencv2/imgproc.hpp>

#include "preflight/depth_scale.hpp"

namespace saccade {
namespace {

constexpr int kWidth = 160;   // images are compared at this width: edges of colour and depth lie some pixels apart
constexpr int kMostLag = 15;  // frames; half a second
constexpr float kEdgeStep = 0.08f;  // relative step of depth that is an edge
constexpr int kFewestEdgePixels = 40;

struct Edges {
  cv::Mat1f contrast;  // of colour, mean 1
  cv::Mat1b depth;     // 1 where depth has an edge
  int depth_pixels = 0;
};

cv::Mat1f contrastOf(const cv::Mat3b& color, const cv::Size& size) {
  cv::Mat grey, small, du, dv;
  cv::cvtColor(color, grey, cv::COLOR_BGR2GRAY);
  cv::resize(grey, small, size, 0, 0, cv::INTER_AREA);
  cv::Sobel(small, du, CV_32F, 1, 0);
  cv::Sobel(small, dv, CV_32F, 0, 1);
  cv::Mat1f contrast;
  cv::magnitude(du, dv, contrast);
  const double mean = cv::mean(contrast)[0];
  if (mean > 0) contrast /= mean;
  return contrast;
}

cv::Mat1b depthEdges(const cv::Mat1f& depth_m, const cv::Size& size) {
  cv::Mat1f small;
  cv::resize(depth_m, small, size, 0, 0, cv::INTER_NEAREST);
  cv::Mat1b edges(size, uchar{0});
  const auto isStep = [](float a, float b) {
    return a > 0.0f && b > 0.0f && std::abs(a - b) > kEdgeStep * std::min(a, b);
  };
  for (int v = 0; v + 1 < small.rows; ++v) {
    for (int u = 0; u + 1 < small.cols; ++u) {
      edges(v, u) = isStep(small(v, u), small(v, u + 1)) || isStep(small(v, u), small(v + 1, u)) ? 1 : 0;
    }
  }
  return edges;
}

double agreement(const Edges& color, const cv::Mat1b& depth_edges) {
  return cv::mean(color.contrast, depth_edges)[0];
}

/// Median over the frames of how much better colour agrees with the depth of `lag` frames later than with its own.
double gainOfLag(const std::vector<Edges>& frames, int lag) {
  std::vector<double> gains;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const auto partner = static_cast<std::ptrdiff_t>(i) + lag;
    if (partner < 0 || partner >= static_cast<std::ptrdiff_t>(frames.size())) continue;
    const Edges& other = frames[static_cast<std::size_t>(partner)];
    const double own = agreement(frames[i], frames[i].depth);
    if (own > 0.0 && other.depth_pixels > 0) gains.push_back(agreement(frames[i], other.depth) / own);
  }
  return medianOf(std::move(gains));
}

/// The same for depth that is turned, of the same frame.
double gainOfTurn(const std::vector<Edges>& frames, int flip) {
  std::vector<double> gains;
  for (const Edges& frame : frames) {
    cv::Mat1b turned;
    cv::flip(frame.depth, turned, flip);
    const double own = agreement(frame, frame.depth);
    if (own > 0.0) gains.push_back(agreement(frame, turned) / own);
  }
  return medianOf(std::move(gains));
}

struct Turn {
  const char* name;
  int flip;  // OpenCV's code
};
constexpr std::array kTurns = {Turn{"turned by 180 degrees", -1}, Turn{"mirrored", 1}, Turn{"upside down", 0}};

}  // namespace

std::optional<EdgeAgreement> compareEdges(const std::vector<RgbdFrame>& frames) {
  std::vector<Edges> edges;
  std::int64_t pixels = 0;
  for (const RgbdFrame& frame : frames) {
    if (frame.depth_m.empty()) return std::nullopt;
    const cv::Size size(kWidth, std::max(1, frame.color.rows * kWidth / frame.color.cols));
    Edges found{contrastOf(frame.color, size), depthEdges(frame.depth_m, size)};
    found.depth_pixels = cv::countNonZero(found.depth);
    pixels += found.depth_pixels;
    edges.push_back(std::move(found));
  }
  if (edges.empty() || pixels < kFewestEdgePixels * static_cast<std::int64_t>(edges.size())) return std::nullopt;
  EdgeAgreement result;
  for (const Turn& turn : kTurns) {
    const double gain = gainOfTurn(edges, turn.flip);
    if (gain <= result.gain_of_turn) continue;
    result.gain_of_turn = gain;
    result.best_turn = turn.name;
  }
  const int most_lag = std::min(kMostLag, static_cast<int>(edges.size()) / 3);
  for (int lag = -most_lag; lag <= most_lag; ++lag) {
    const double gain = gainOfLag(edges, lag);
    if (gain <= result.gain_of_lag) continue;
    result.gain_of_lag = gain;
    result.best_lag = lag;
  }
  return result;
}

}  // namespace saccade
