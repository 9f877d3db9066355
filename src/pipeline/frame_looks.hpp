#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include <tbb/task_group.h>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/discovery/perceiver.hpp"
#include "saccade/discovery/perception.hpp"
#include "saccade/discovery/proposals.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "saccade/pipeline/frame_report.hpp"
#include "saccade/tracking/intensity_pyramid.hpp"

namespace saccade {

/// What is seen of one frame by itself, without pose and map.
struct FrameLook {
  DepthMaps depth;
  IntensityPyramid intensity;  ///< where there is depth
  bool has_depth = false;
  Perception seen;
  Candidates pool;  ///< proposed by what was seen
  std::vector<StageTime> times;
};

/// The part of figure 1 that needs nothing but the frame: depth maps, saliency, segments, proposals. It can be begun
/// for the frame that comes next while the map still works on the one before.
///
/// Holds two looks, the one in use and the one ahead. Serves one thread; the look ahead is a task of TBB.
class FrameLooks {
 public:
  FrameLooks(const ExplorerConfig& config, const PinholeCamera& camera)
      : camera_(camera),
        preparation_(config.depth),
        perceiver_(config.discovery.perception),
        proposal_(config.discovery.proposal) {}
  ~FrameLooks() { task_.wait(); }
  FrameLooks(const FrameLooks&) = delete;
  FrameLooks& operator=(const FrameLooks&) = delete;

  /// The look at `frame`, whole, if it was begun ahead; else null. The one before it is over.
  FrameLook* takeAhead(const RgbdFrame& frame);
  /// A look with what tracking needs only, depth maps and grey values; perceive() adds the rest. The one before it is
  /// over.
  FrameLook& prepare(const RgbdFrame& frame);
  void perceive(const RgbdFrame& frame, FrameLook& look);
  /// Begins the look at the frame that comes next, whose images must not change until it is taken. Neither prepare()
  /// nor perceive() may run until then.
  void beginAhead(const RgbdFrame& next);
  /// The look ahead, with what tracking needs at least: the rest may be in work. Only between beginAhead() and
  /// takeAhead().
  [[nodiscard]] const FrameLook& depthAhead();

 private:
  void prepareDepth(const RgbdFrame& frame, FrameLook& look);
  void prepareDepthAhead();

  PinholeCamera camera_;
  DepthPreparation preparation_;
  Perceiver perceiver_;
  ProposalConfig proposal_;
  FrameLook looks_[2];
  int current_ = 0;
  RgbdFrame ahead_;                            // shares its images; without any: nothing is ahead
  std::optional<std::once_flag> depth_ahead_;  // who needs the depth maps ahead first makes them
  tbb::task_group task_;
};

}  // namespace saccade
