#include "saccade/evaluation/ranker_training.hpp"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

#include "saccade/core/depth_maps.hpp"
#include "saccade/sources/frame_source.hpp"

namespace saccade {
namespace {

constexpr double kRoundTo = 1000.0;  // scaled values are rounded to 1 / 1000 so that the model's text is short

enum class Kind : std::uint8_t { kObject, kOther, kUndecided };

// A frame's measured candidates with what the labels say of them. Holds no images.
struct LabelledPool {
  Candidates candidates;
  std::vector<Kind> kinds;
  std::vector<std::vector<int>> shows;  ///< of each candidate: indices of the objects its box shows
  std::vector<int> object_ids;
};

class PoolReader {
 public:
  explicit PoolReader(const RankerTrainingConfig& config)
      : config_(config), perceiver_(config.discovery.perception), measurer_(config.discovery.ranking.features) {}

  void read(const std::string& input, std::vector<LabelledPool>& pools) {
    const std::unique_ptr<FrameSource> source = openSource(input);
    DiscoveryRules rules;
    if (source->description().ignore_from) rules.ignore_from = *source->description().ignore_from;
    RgbdFrame frame;
    for (ReadStatus status = source->read(frame); status != ReadStatus::kEnd; status = source->read(frame)) {
      if (status != ReadStatus::kFrame || frame.label.empty() || frame.depth_m.empty()) continue;
      preparation_.prepare(frame.depth_m, source->description().camera, depth_);
      perceiver_.perceive(frame.color, &depth_, seen_);
      pools.push_back(judge(frame.label, rules));
    }
  }

 private:
  LabelledPool judge(const cv::Mat1w& label, const DiscoveryRules& rules) {
    LabelledPool pool;
    pool.candidates = proposeCandidates(seen_, config_.discovery.proposal);
    measurer_.measure(pool.candidates, seen_);
    const std::vector<LabelledObject> objects = labelledObjects(label, rules);
    for (const LabelledObject& object : objects) pool.object_ids.push_back(object.id);
    for (const Candidate& candidate : pool.candidates) {
      const std::vector<double> overlaps = maskOverlaps(candidate, seen_, label, objects);
      std::vector<int> shows;
      double best = 0.0, most = 0.0;  // by the weaker and by the stronger of box and mask
      for (std::size_t i = 0; i < objects.size(); ++i) {
        const double box = boxIou(objects[i].box, candidate.box);
        best = std::max(best, std::min(box, overlaps[i]));
        most = std::max({most, box, overlaps[i]});
        if (box > rules.min_iou) shows.push_back(static_cast<int>(i));
      }
      pool.shows.push_back(std::move(shows));
      pool.kinds.push_back(best > config_.positive_iou                         ? Kind::kObject
                           : most < config_.negative_iou && trusted(candidate) ? Kind::kOther
                                                                               : Kind::kUndecided);
    }
    return pool;
  }

  [[nodiscard]] bool trusted(const Candidate& candidate) const {
    int with_depth = 0;
    for (const std::int32_t id : candidate.segments) with_depth += seen_.table(candidate.source).sums(id).depth_count;
    return with_depth >= config_.min_negative_depth * candidate.area &&
           static_cast<double>(candidate.cues[kCueUnknownDepth]) <= 1.0 - config_.min_negative_depth;
  }

  const RankerTrainingConfig& config_;
  Perceiver perceiver_;
  CandidateMeasurer measurer_;
  DepthPreparation preparation_;
  DepthMaps depth_;
  Perception seen_;
};

struct Example {
  const Candidate* candidate = nullptr;
  std::int8_t label = 0;
  int group = 0;
};

std::vector<Example> chooseExamples(const std::vector<LabelledPool>& pools, const RankerTrainingConfig& config) {
  std::mt19937_64 random(static_cast<std::uint64_t>(config.seed));
  std::vector<Example> examples;
  for (std::size_t frame = 0; frame < pools.size(); ++frame) {
    const LabelledPool& pool = pools[frame];
    for (const Kind kind : {Kind::kObject, Kind::kOther}) {
      std::vector<std::size_t> all;
      for (std::size_t i = 0; i < pool.kinds.size(); ++i) {
        if (pool.kinds[i] == kind) all.push_back(i);
      }
      for (std::size_t i = all.size(); i > 1; --i) std::swap(all[i - 1], all[random() % i]);
      const int limit = kind == Kind::kObject ? config.positives_per_frame : config.negatives_per_frame;
      all.resize(std::min(all.size(), static_cast<std::size_t>(limit)));
      std::sort(all.begin(), all.end());
      for (const std::size_t i : all) {
        const auto label = static_cast<std::int8_t>(kind == Kind::kObject ? 1 : -1);
        examples.push_back({&pool.candidates[i], label, static_cast<int>(frame)});
      }
    }
  }
  return examples;
}

Judge trainJudge(const std::vector<Example>& examples, FeatureSet set, bool with_depth, SvmTrainingConfig svm_config) {
  SvmExamples svm;
  svm.dimension = featureCount(set, with_depth);
  for (const Example& example : examples) {
    if (with_depth && !example.candidate->has_depth) continue;
    appendFeatures(*example.candidate, set, with_depth, svm.rows);
    svm.labels.push_back(example.label);
    svm.groups.push_back(example.group);
  }
  Judge judge;
  const auto n = static_cast<double>(std::max<std::size_t>(1, svm.size()));
  for (std::size_t column = 0; column < svm.dimension; ++column) {
    double sum = 0.0, squared = 0.0;
    for (std::size_t i = column; i < svm.rows.size(); i += svm.dimension) {
      sum += static_cast<double>(svm.rows[i]);
      squared += static_cast<double>(svm.rows[i]) * static_cast<double>(svm.rows[i]);
    }
    const double mean = sum / n, deviation = std::sqrt(std::max(0.0, squared / n - mean * mean));
    judge.mean.push_back(static_cast<float>(mean));
    judge.scale.push_back(deviation > 1e-9 ? static_cast<float>(deviation) : 1.0F);
  }
  judge.scaleRows(svm.rows);
  for (float& value : svm.rows)
    value = static_cast<float>(std::round(static_cast<double>(value) * kRoundTo) / kRoundTo);
  judge.svm = trainSvm(svm, svm_config);
  return judge;
}

RankerModel trainModel(const std::vector<Example>& examples, FeatureSet set, const SvmTrainingConfig& svm_config) {
  Judge with_depth = trainJudge(examples, set, true, svm_config);
  return {set, std::move(with_depth), trainJudge(examples, set, false, svm_config)};
}

// Matches of a held-out frame: its candidates ranked by `model`, without the merging of duplicates, which needs masks.
FrameMatches rankHeldOut(const LabelledPool& pool, const RankerModel& model, const RankingConfig& ranking) {
  // The list of segments is not needed any more: it remembers which candidate this was.
  Candidates ranked;
  for (std::size_t i = 0; i < pool.candidates.size(); ++i) {
    Candidate light = pool.candidates[i];
    light.segments.assign(1, static_cast<std::int32_t>(i));
    ranked.push_back(std::move(light));
  }
  model.score(ranked);
  std::stable_sort(ranked.begin(), ranked.end(),
                   [](const Candidate& a, const Candidate& b) { return a.score > b.score; });
  if (!ranking.paper && ranking.suppress) suppressOverlapping(ranked, ranking);
  FrameMatches matches;
  matches.object_ids = pool.object_ids;
  matches.found_at.assign(pool.object_ids.size(), FrameMatches::kNever);
  for (std::size_t rank = 0; rank < ranked.size(); ++rank) {
    for (const int object : pool.shows[static_cast<std::size_t>(ranked[rank].segments[0])]) {
      int& found = matches.found_at[static_cast<std::size_t>(object)];
      if (found == FrameMatches::kNever) found = static_cast<int>(rank);
    }
  }
  return matches;
}

RankerTrial crossValidate(const std::vector<LabelledPool>& pools, const std::vector<Example>& examples, FeatureSet set,
                          const RankerTrainingConfig& config, const SvmTrainingConfig& svm_config) {
  std::vector<int> frames;
  for (std::size_t i = 0; i < pools.size(); ++i) frames.push_back(static_cast<int>(i));
  const std::vector<int> folds = foldOfExamples(frames, config.folds);
  DiscoveryScore score;
  for (int fold = 0; fold < config.folds; ++fold) {
    std::vector<Example> rest;
    for (const Example& example : examples) {
      if (folds[static_cast<std::size_t>(example.group)] != fold) rest.push_back(example);
    }
    const RankerModel model = trainModel(rest, set, svm_config);
    for (std::size_t i = 0; i < pools.size(); ++i) {
      if (folds[i] == fold) score.add(rankHeldOut(pools[i], model, config.discovery.ranking));
    }
  }
  return {svm_config.c, svm_config.gamma, score.recall(5), score.recall(10), score.recall(20)};
}

}  // namespace

RankerTraining trainRanker(const std::vector<std::string>& inputs, const RankerTrainingConfig& config) {
  requireValid(config);
  std::vector<LabelledPool> pools;
  PoolReader reader(config);
  for (const std::string& input : inputs) reader.read(input, pools);
  const std::vector<Example> examples = chooseExamples(pools, config);

  RankerTraining result;
  result.frames = static_cast<int>(pools.size());
  for (const Example& example : examples) ++(example.label > 0 ? result.positives : result.negatives);
  if (result.positives == 0 || result.negatives == 0) {
    throw std::invalid_argument("trainRanker: " + std::to_string(result.positives) + " candidates show objects and " +
                                std::to_string(result.negatives) + " do not, in " + std::to_string(result.frames) +
                                " labelled frames with depth; both are needed");
  }
  const FeatureSet set = config.discovery.ranking.paper ? FeatureSet::kPaper : FeatureSet::kExtended;
  SvmTrainingConfig svm;
  svm.max_vectors = config.max_vectors;
  svm.seed = static_cast<std::uint64_t>(config.seed);
  for (const double c : config.c_values) {
    for (const double gamma : config.gamma_values) {
      svm.c = c;
      svm.gamma = gamma;
      result.trials.push_back(crossValidate(pools, examples, set, config, svm));
      if (result.trials.size() == 1 || result.trials.back().merit() > result.chosen.merit()) {
        result.chosen = result.trials.back();
      }
    }
  }
  svm.c = result.chosen.c;
  svm.gamma = result.chosen.gamma;
  result.model = trainModel(examples, set, svm);
  return result;
}

}  // namespace saccade
