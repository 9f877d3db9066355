#pragma once

#include <mutex>
#include <optional>
#include <vector>

#include "pipeline/errand.hpp"
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

/// The part of figure 1 that needs nothing but the frame: depth maps, saliency, segments, proposals. It runs beside the
/// map branch, of the same frame or of the one before, and is waited for only where both branches meet.
///
/// Holds two looks, of the frame in work and of the one announced to come next. Serves one thread; what it begins are
/// errands for idle threads of TBB.
class FrameLooks {
 public:
  FrameLooks(const ExplorerConfig& config, const PinholeCamera& camera)
      : camera_(camera), slots_{Slot(config), Slot(config)} {}
  FrameLooks(const FrameLooks&) = delete;
  FrameLooks& operator=(const FrameLooks&) = delete;

  /// Names the frame that comes next, whose images must not change until it is taken and perceived.
  void announce(const RgbdFrame& next);
  /// Whether `frame` is the one announced.
  [[nodiscard]] bool isAnnounced(const RgbdFrame& frame) const;
  /// The look at `frame`, with what tracking needs: depth maps and grey values. The one before it is over.
  FrameLook& take(const RgbdFrame& frame);

  /// Begins to add the rest to the look taken, if that was not done ahead.
  void perceive() { begin(slots_[current_]); }
  /// The same for the frame announced, if there is one.
  void perceiveAhead() { begin(slots_[1 - current_]); }
  [[nodiscard]] bool isPerceived() const { return slots_[current_].is_begun && slots_[current_].errand.isDone(); }
  /// Waits for the rest of the look taken. Its images are free then.
  void waitUntilPerceived();

  /// The look at the frame announced, with what tracking needs at least. May be called by a task, until that frame is
  /// taken.
  [[nodiscard]] const FrameLook& depthAhead();

 private:
  struct Slot {
    explicit Slot(const ExplorerConfig& config)
        : preparation(config.depth), perceiver(config.discovery.perception), proposer(config.discovery.proposal) {}

    RgbdFrame frame;  ///< shares its images; without any: none
    FrameLook look;
    DepthPreparation preparation;
    Perceiver perceiver;
    Proposer proposer;
    std::optional<std::once_flag> prepared;  ///< who needs the depth maps first makes them
    bool is_begun = false;
    Errand errand;  ///< last: it ends before what it works on
  };

  static void assign(Slot& slot, const RgbdFrame& frame);
  void prepare(Slot& slot) const;
  void begin(Slot& slot);
  void perceive(Slot& slot) const;

  PinholeCamera camera_;
  Slot slots_[2];
  int current_ = 0;
};

}  // namespace saccade
