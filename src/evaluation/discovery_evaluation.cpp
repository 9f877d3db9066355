#include "saccade/evaluation/discovery_evaluation.hpp"

#include <chrono>

#include "saccade/core/depth_maps.hpp"

namespace saccade {
namespace {

double millisecondsSince(std::chrono::steady_clock::time_point start) {
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
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
  ComparedMethods compared(options.compare, options.discovery, options.model, rules);
  DepthPreparation preparation;
  DepthMaps depth;
  Perception seen;
  DiscoveryEvaluation result;
  result.ours = {"colour + depth", DiscoveryScore(rules.max_candidates), DiscoveryScore(rules.max_candidates)};
  RgbdFrame frame;
  for (ReadStatus status = source.read(frame); status != ReadStatus::kEnd; status = source.read(frame)) {
    if (status != ReadStatus::kFrame || frame.label.empty()) continue;
    if (options.accept && !options.accept(frame)) continue;

    const bool with_depth = options.use_depth && !frame.depth_m.empty();
    if (with_depth) preparation.prepare(frame.depth_m, source.description().camera, depth);
    const auto start = std::chrono::steady_clock::now();
    perceiver.perceive(frame.color, with_depth ? &depth : nullptr, seen);
    Candidates pool = proposeCandidates(seen, options.discovery.proposal);
    const Candidates ranked = ranker.rank(pool, seen);
    result.ours.ms += millisecondsSince(start);

    result.pool_size += static_cast<double>(pool.size());
    result.ours.candidates += static_cast<double>(ranked.size());
    result.ours.boxes.add(matchBoxes(ranked, frame.label, rules));
    result.ours.masks->add(matchMasks(ranked, seen, frame.label, rules));
    compared.add(frame, seen, pool, ranked.size());
    if (options.on_frame) options.on_frame({frame, with_depth ? &depth : nullptr, seen, ranked});
    ++result.frames;
  }
  result.others = compared.finish();
  result.ours.finish(result.frames);
  if (result.frames > 0) result.pool_size /= result.frames;
  return result;
}

}  // namespace saccade
