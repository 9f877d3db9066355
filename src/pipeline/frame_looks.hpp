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
#include "saccade/map/surface_volume.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "saccade/pipeline/frame_report.hpp"
#include "saccade/rendering/depth_completion.hpp"
#include "saccade/tracking/intensity_pyramid.hpp"

namespace saccade {

/// What is seen of one frame.
struct FrameLook {
  DepthMaps depth;
  IntensityPyramid intensity;  ///< where there is depth
  bool has_depth = false;
  DepthMaps completed;  ///< `depth` and what the map adds
  bool is_completed = false;
  Perception seen;
  Candidates pool;  ///< proposed by what was seen
  std::vector<StageTime> times;

  /// What is perceived: null for a frame of colour alone.
  [[nodiscard]] const DepthMaps* perceivedDepth() const {
    if (!has_depth) return nullptr;
    return is_completed ? &completed : &depth;
  }
};

/// The attention branch of figure 1: depth maps, saliency, segments, proposals. It runs beside the map branch, of the
/// same frame or of the one before, and is waited for only where both branches meet. Of the map it needs no more than
/// the surface that completes the frame's depth, and that only when it begins.
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

  /// Begins to add the rest to the look taken, if that was not done ahead. Depth is completed by what `surface` shows
  /// from `T_WC`, before this returns; without a pose it stays as measured.
  void perceive(const SurfaceVolume& surface, const std::optional<Pose>& T_WC) {
    begin(slots_[current_], surface, T_WC);
  }
  /// The same for the frame announced, if there is one. May be called by a task, until that frame is taken; if the pose
  /// turns out to be another one, perceive() begins anew.
  void perceiveAhead(const SurfaceVolume& surface, const std::optional<Pose>& T_WC) {
    begin(slots_[1 - current_], surface, T_WC);
  }
  /// Begins with what the colour of the frame announced tells by itself, which needs no pose.
  void perceiveColorAhead() { beginColor(slots_[1 - current_]); }
  [[nodiscard]] bool isPerceived() const { return slots_[current_].errand.isDone(); }
  /// Waits for the rest of the look taken, which must be begun. Its images are free then.
  void waitUntilPerceived();

  /// The look at the frame announced, with what tracking needs at least. May be called by a task, until that frame is
  /// taken.
  [[nodiscard]] const FrameLook& depthAhead();

 private:
  struct Slot {
    explicit Slot(const ExplorerConfig& config)
        : preparation(config.depth),
          completion(config.completion),
          perceiver(config.discovery.perception),
          proposer(config.discovery.proposal) {}

    RgbdFrame frame;  ///< shares its images; without any: none
    FrameLook look;
    DepthPreparation preparation;
    DepthCompletion completion;
    Perceiver perceiver;
    Proposer proposer;
    std::optional<std::once_flag> prepared;  ///< who needs the depth maps first makes them
    std::vector<StageTime> prepared_times, completion_times;
    std::mutex color_mutex;  ///< of the next line
    bool is_color_begun = false;
    bool is_begun = false;
    std::optional<Pose> seen_from;  ///< where the map was asked to complete the depth
    Errand of_color, errand;        ///< last: they end before what they work on; the second waits for the first
  };

  static void assign(Slot& slot, const RgbdFrame& frame);
  void prepare(Slot& slot) const;
  static void beginColor(Slot& slot);
  void begin(Slot& slot, const SurfaceVolume& surface, const std::optional<Pose>& T_WC);
  void complete(Slot& slot, const SurfaceVolume& surface) const;
  void perceive(Slot& slot) const;

  PinholeCamera camera_;
  Slot slots_[2];
  int current_ = 0;
};

}  // namespace saccade
