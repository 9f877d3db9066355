#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "saccade/core/frame.hpp"
#include "saccade/discovery/discovery_config.hpp"
#include "saccade/evaluation/discovery_metrics.hpp"

namespace saccade {

/// How one way of making a ranked list did on labelled frames.
struct MethodScore {
  std::string name;
  DiscoveryScore boxes;
  std::optional<DiscoveryScore> masks;  ///< none for methods that give boxes only
  /// Of a rival: the boxes cut in each frame to as many as we give there, so that F compares lists of one length.
  std::optional<DiscoveryScore> boxes_as_many_as_ours = std::nullopt;
  double candidates = 0.0;  ///< mean number a frame that the method gave
  double ms = 0.0;          ///< mean time a frame for what this method does beyond perception

  /// Makes means of the sums over `frames` frames that `candidates` and `ms` hold until then.
  void finish(int frames);
};

/// Which methods stand beside ours.
struct ComparisonOptions {
  bool sources = false;    ///< colour segments alone, surface segments alone (paper: Colour, Depth)
  bool baselines = false;  ///< our pool ordered by area, by saliency, at random
  bool rivals = false;     ///< OpenCV's Selective Search and Edge Boxes
};

/// Judges other ways to make candidates on the frames on which ours are judged.
///
/// Not to be moved or copied: the methods refer to the ranker inside.
class ComparedMethods {
 public:
  ComparedMethods(const ComparisonOptions& options, const DiscoveryConfig& discovery,
                  const std::optional<RankerModel>& model, const DiscoveryRules& rules);

  ComparedMethods(const ComparedMethods&) = delete;
  ComparedMethods& operator=(const ComparedMethods&) = delete;

  /// `pool`: our candidates of the frame before ranking, `our_count`: how many are left after it.
  void add(const RgbdFrame& frame, const Perception& seen, const Candidates& pool, std::size_t our_count);
  /// The scores, in a fixed order. Call once, after the last frame.
  [[nodiscard]] std::vector<MethodScore> finish();

 private:
  using Order = std::function<Candidates(Candidates, const Perception&)>;
  using Rival = std::function<std::vector<cv::Rect>(const cv::Mat3b&)>;
  struct Ordering {
    MethodScore score;
    Order order;
  };
  struct RivalMethod {
    MethodScore score;
    Rival propose;
  };

  DiscoveryRules rules_;
  int frames_ = 0;
  Ranker ranker_;
  std::vector<Ordering> orderings_;
  std::vector<RivalMethod> rivals_;
};

}  // namespace saccade
