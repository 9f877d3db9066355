#include "saccade/evaluation/discovery_evaluation.hpp"

#include <chrono>

#include "saccade/core/depth_maps.hpp"

namespace saccade {
namespace {

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

void accumulate(Perceiver::Times& sum, const Perceiver::Times& times) {
  sum.saliency_ms += times.saliency_ms;
  sum.blobs_ms += times.blobs_ms;
  sum.color_ms += times.color_ms;
  sum.surface_ms += times.surface_ms;
  sum.tables_ms += times.tables_ms;
}

void divide(Perceiver::Times& sum, double count) {
  sum.saliency_ms /= count;
  sum.blobs_ms /= count;
  sum.color_ms /= count;
  sum.surface_ms /= count;
  sum.tables_ms /= count;
}

Ranker makeRanker(const EvaluationOptions& options) {
  if (options.model) return Ranker(options.discovery.ranking, *options.model);
  return Ranker(options.discovery.ranking);
}

}  // namespace

DiscoveryEvaluation evaluateFrames(FrameSource& source, const EvaluationOptions& options) {
  DiscoveryRules rules = options.rules;
  if (source.description().ignore_from) rules.ignore_from = *source.description().ignore_from;

  Perceiver perceiver(options.discovery.perception);
  Ranker ranker = makeRanker(options);
  DepthPreparation preparation;
  DepthMaps depth;
  Perception seen;
  DiscoveryEvaluation result;
  result.boxes = result.masks = DiscoveryScore(rules.max_candidates);
  RgbdFrame frame;
  for (ReadStatus status = source.read(frame); status != ReadStatus::kEnd; status = source.read(frame)) {
    if (status != ReadStatus::kFrame || frame.label.empty()) continue;

    const bool with_depth = options.use_depth && !frame.depth_m.empty();
    if (with_depth) preparation.prepare(frame.depth_m, source.description().camera, depth);
    perceiver.perceive(frame.color, with_depth ? &depth : nullptr, seen);
    const auto start = std::chrono::steady_clock::now();
    Candidates pool = proposeCandidates(seen, options.discovery.proposal);
    const double propose_ms = millisecondsSince(start);
    result.pool_size += static_cast<double>(pool.size());
    const Candidates ranked = ranker.rank(std::move(pool), seen);
    result.rank_ms += millisecondsSince(start) - propose_ms;
    result.propose_ms += propose_ms;
    result.ranked += static_cast<double>(ranked.size());
    accumulate(result.perceive_ms, perceiver.times());

    result.boxes.add(matchBoxes(ranked, frame.label, rules));
    result.masks.add(matchMasks(ranked, seen, frame.label, rules));
    if (options.on_frame) options.on_frame({frame, with_depth ? &depth : nullptr, seen, ranked});
    ++result.frames;
  }
  if (result.frames == 0) return result;
  const double count = result.frames;
  result.pool_size /= count;
  result.ranked /= count;
  result.propose_ms /= count;
  result.rank_ms /= count;
  divide(result.perceive_ms, count);
  return result;
}

}  // namespace saccade
