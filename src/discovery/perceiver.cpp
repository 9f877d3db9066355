#include "saccade/discovery/perceiver.hpp"

#include <chrono>
#include <utility>

#include <tbb/parallel_invoke.h>

namespace saccade {
namespace {

/// Runs `work` and returns the milliseconds that it took.
template <typename Work>
double timed(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

Perceiver::Perceiver(PerceptionConfig config)
    : config_(std::move(config)),
      saliency_(config_.saliency),
      blobs_(config_.blobs),
      color_(config_.color),
      surface_(config_.surface) {
  requireValid(config_);
}

void Perceiver::perceive(const cv::Mat3b& color, const DepthMaps* depth, Perception& seen) {
  tbb::parallel_invoke([&] { perceiveColor(color, seen); }, [&] { perceiveSurface(depth, seen); });
  relate(color, depth, seen);
}

void Perceiver::perceiveColor(const cv::Mat3b& color, Perception& seen) {
  // Each needs the image alone: a thread that would have to wait takes a part.
  tbb::parallel_invoke([&] { times_.color_ms = timed([&] { color_.segment(color, seen.color); }); },
                       [&] {
                         times_.saliency_ms = timed([&] { saliency_.compute(color, seen.saliency); });
                         times_.blobs_ms = timed([&] { growBlobs(seen); });
                       });
}

void Perceiver::perceiveSurface(const DepthMaps* depth, Perception& seen) {
  times_.surface_ms = timed([&] {
    if (depth != nullptr) surface_.segment(*depth, seen.surface);
  });
}

void Perceiver::relate(const cv::Mat3b& color, const DepthMaps* depth, Perception& seen) {
  times_.tables_ms = timed([&] { seen.makeTables(color, depth, config_.planes); });
}

void Perceiver::growBlobs(Perception& seen) {
  std::vector<SaliencyMaximum> maxima = findLocalMaxima(seen.saliency);
  if (config_.max_maxima > 0 && maxima.size() > static_cast<std::size_t>(config_.max_maxima)) {
    maxima.resize(static_cast<std::size_t>(config_.max_maxima));
  }
  seen.blobs = blobs_.grow(seen.saliency, maxima);
}

}  // namespace saccade
