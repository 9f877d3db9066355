#include "saccade/discovery/perceiver.hpp"

#include <chrono>

namespace saccade {
namespace {

class Stopwatch {
 public:
  double lap_ms() {
    const auto now = std::chrono::steady_clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

void copy(const Segmentation& from, Segmentation& to) {
  from.labels.copyTo(to.labels);
  to.count = from.count;
}

}  // namespace

Perceiver::Perceiver(PerceptionConfig config)
    : config_(config),
      saliency_(config.saliency),
      blobs_(config.blobs),
      color_(config.color),
      surface_(config.surface) {
  requireValid(config_);
}

void Perceiver::perceive(const cv::Mat3b& color, const DepthMaps* depth, Perception& seen) {
  Stopwatch watch;
  saliency_.compute(color).copyTo(seen.saliency);
  times_.saliency_ms = watch.lap_ms();
  std::vector<SaliencyMaximum> maxima = findLocalMaxima(seen.saliency);
  if (config_.max_maxima > 0 && maxima.size() > static_cast<std::size_t>(config_.max_maxima)) {
    maxima.resize(static_cast<std::size_t>(config_.max_maxima));
  }
  seen.blobs = blobs_.grow(seen.saliency, maxima);
  times_.blobs_ms = watch.lap_ms();
  copy(color_.segment(color), seen.color);
  times_.color_ms = watch.lap_ms();
  if (depth != nullptr) copy(surface_.segment(*depth), seen.surface);
  times_.surface_ms = watch.lap_ms();
  seen.makeTables(color, depth, config_.planes);
  times_.tables_ms = watch.lap_ms();
}

}  // namespace saccade
