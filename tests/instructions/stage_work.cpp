// Runs each stage once, warm, on a simulated frame, and marks its instructions for callgrind: see check.sh.

#include <cstddef>
#include <cstdlib>
#include <iostream>
#include <span>
#include <string>
#include <utility>
#include <valgrind/callgrind.h>
#include <vector>

#include <opencv2/core/utility.hpp>

#include "saccade/core/depth_maps.hpp"
#include "saccade/discovery/inhibition.hpp"
#include "saccade/discovery/perceiver.hpp"
#include "saccade/discovery/proposals.hpp"
#include "saccade/discovery/ranker.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/surface_volume.hpp"
#include "saccade/rendering/back_project.hpp"
#include "saccade/rendering/depth_completion.hpp"
#include "saccade/rendering/renderer.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/tracking/tracker.hpp"

namespace saccade {
namespace {

/// Does the work twice: the first time buffers are made, the second time instructions are counted.
template <typename Work>
void count(const std::string& stage, const Work& work) {
  work();
  CALLGRIND_START_INSTRUMENTATION;
  CALLGRIND_ZERO_STATS;
  work();
  CALLGRIND_DUMP_STATS_AT(stage.c_str());
  CALLGRIND_STOP_INSTRUMENTATION;
}

RgbdFrame firstFrame(FrameSource& source) {
  RgbdFrame frame;
  if (source.read(frame) != ReadStatus::kFrame) {
    std::cerr << "the simulated scene gave no frame\n";
    std::exit(EXIT_FAILURE);
  }
  return frame;
}

void countPerception(const RgbdFrame& frame, const DepthMaps& depth) {
  const PerceptionConfig config;
  SaliencyModel saliency(config.saliency);
  BlobGrower blobs(config.blobs);
  ColorSegmenter color(config.color);
  SurfaceSegmenter surface(config.surface);
  count("saliency", [&] { saliency.compute(frame.color); });
  const cv::Mat1f map = saliency.compute(frame.color);
  count("salient_blobs", [&] {
    std::vector<SaliencyMaximum> maxima = findLocalMaxima(map);
    const auto most = static_cast<std::size_t>(config.max_maxima);
    if (maxima.size() > most) maxima.resize(most);
    blobs.grow(map, maxima);
  });
  count("colour_segments", [&] { color.segment(frame.color); });
  count("surface_segments", [&] { surface.segment(depth); });
}

void countDiscovery(const RgbdFrame& frame, const DepthMaps& depth) {
  Perceiver perceiver;
  Perception seen;
  perceiver.perceive(frame.color, &depth, seen);
  count("segment_tables", [&] { seen.makeTables(frame.color, &depth); });
  count("propose", [&] { (void)proposeCandidates(seen, {}); });
  Candidates pool = proposeCandidates(seen, {});
  CandidateMeasurer measurer;
  count("features", [&] { measurer.measure(pool, seen); });
  count("scores", [&] { RankerModel::builtIn(FeatureSet::kExtended).score(pool); });
  Ranker ranker;
  std::vector<Candidates> copies(2, pool);
  count("rank", [&] {
    (void)ranker.rank(std::move(copies.back()), seen);
    copies.pop_back();
  });
}

void countMapping(const RgbdFrame& frame, const DepthMaps& depth) {
  const Pose T_WC = Pose::Identity();
  SurfaceVolume volume;
  count("integrate_surface", [&] { volume.integrate(depth, T_WC); });
  ModelView model;
  const PinholeCamera half = depth.camera.reducedBy(2);
  count("model_view", [&] { volume.rayCast(half, T_WC, model); });
  DepthMaps seen_less, completed;
  cv::Mat1f inner = depth.depth_m.clone();
  inner(cv::Rect(0, 0, inner.cols / 6, inner.rows)).setTo(0.0F);
  DepthPreparation().prepare(inner, depth.camera, seen_less);
  DepthCompletion completion;
  count("complete_depth", [&] { (void)completion.complete(seen_less, volume, T_WC, completed); });
  Tracker tracker;
  IntensityPyramid intensity;
  count("grey_values", [&] { intensity.build(frame.color, depth.camera); });
  PhotometricReference reference;
  count("photometric_reference", [&] { reference.take(depth, intensity, T_WC); });
  const TrackedColor color{intensity, reference};
  count("track", [&] { (void)tracker.track(depth, model, T_WC, &color); });
  IorMap map;
  count("integrate_map", [&] { (void)map.integrate(depth, frame.color, T_WC); });
  Renderer renderer;
  count("ior_view", [&] { (void)renderer.renderIor(map.view(), depth.camera, T_WC); });
  const cv::Mat1b everything(depth.depth_m.size(), 255);
  const std::vector<LeafKey> keys =
      backProject(std::span(&everything, 1), renderer.renderIor(map.view(), depth.camera, T_WC));
  count("attend", [&] { (void)map.attend(keys); });
}

}  // namespace
}  // namespace saccade

int main() {
  using namespace saccade;
  cv::setNumThreads(1);
  const auto source = openSource("sim:coffee?seed=3&frames=1");
  const RgbdFrame frame = firstFrame(*source);
  DepthPreparation preparation;
  DepthMaps depth;
  count("prepare_depth", [&] { preparation.prepare(frame.depth_m, source->description().camera, depth); });
  countPerception(frame, depth);
  countDiscovery(frame, depth);
  countMapping(frame, depth);
}
