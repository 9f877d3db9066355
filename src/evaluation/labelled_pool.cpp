#include "labelled_pool.hpp"

#include <algorithm>
#include <memory>

#include "saccade/core/depth_maps.hpp"
#include "saccade/sources/frame_source.hpp"

namespace saccade {
namespace {

class PoolReader {
 public:
  explicit PoolReader(const RankerTrainingConfig& config)
      : config_(config), perceiver_(config.discovery.perception), measurer_(config.discovery.ranking.features) {}

  void read(const std::string& input, std::vector<LabelledPool>& pools) {
    const std::size_t at = input.rfind('@');
    const FrameRange range = at == std::string::npos ? FrameRange{} : FrameRange::parse(input.substr(at + 1));
    const std::unique_ptr<FrameSource> source = openSource(input.substr(0, at), range);
    DiscoveryRules rules;
    if (source->description().ignore_from) rules.ignore_from = *source->description().ignore_from;
    RgbdFrame frame;
    for (ReadStatus status = source->read(frame); status != ReadStatus::kEnd; status = source->read(frame)) {
      if (status != ReadStatus::kFrame || frame.label.empty() || frame.depth_m.empty()) continue;
      preparation_.prepare(frame.depth_m, source->description().camera, depth_);
      perceiver_.perceive(frame.color, &depth_, seen_);
      coverage_ = static_cast<double>(cv::countNonZero(frame.depth_m > 0)) / static_cast<double>(frame.depth_m.total());
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
      double best_box = 0.0;
      for (std::size_t i = 0; i < objects.size(); ++i) {
        const double box = boxIou(objects[i].box, candidate.box);
        best_box = std::max(best_box, box);
        best = std::max(best, std::min(box, overlaps[i]));
        most = std::max({most, box, overlaps[i]});
        if (box > rules.min_iou) shows.push_back(static_cast<int>(i));
      }
      const bool is_trusted = trusted(candidate);
      pool.overlaps.push_back(best_box);
      pool.is_trusted.push_back(is_trusted ? 1 : 0);
      pool.shows.push_back(std::move(shows));
      pool.kinds.push_back(best > config_.positive_iou                 ? Kind::kObject
                           : most < config_.negative_iou && is_trusted ? Kind::kOther
                                                                       : Kind::kUndecided);
    }
    return pool;
  }

  /// Where depth was cut to the objects, as in some sets of labelled frames, its absence tells of the cut.
  [[nodiscard]] bool trusted(const Candidate& candidate) const {
    if (coverage_ >= config_.full_coverage) return true;
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
  double coverage_ = 0.0;  ///< share of the frame's pixels with depth
};

}  // namespace

std::vector<LabelledPool> readLabelledPools(const std::vector<std::string>& inputs,
                                            const RankerTrainingConfig& config) {
  std::vector<LabelledPool> pools;
  PoolReader reader(config);
  for (const std::string& input : inputs) {
    const std::size_t first = pools.size();
    reader.read(input, pools);
    const std::size_t frames = pools.size() - first;
    for (std::size_t i = 0; i < frames; ++i) {
      pools[first + i].fold = static_cast<int>(i * static_cast<std::size_t>(config.folds) / frames);
    }
  }
  return pools;
}

}  // namespace saccade
