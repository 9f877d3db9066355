#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "saccade/core/frame.hpp"
#include "saccade/map/attend_log.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/surface_volume.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "saccade/pipeline/frame_report.hpp"
#include "saccade/pipeline/map_pager.hpp"

namespace saccade {

/// All that an exploration has learnt and that its next frame depends on: with it, another Explorer of the same config
/// and camera goes on as this one would, bit for bit.
struct ExplorerMemory {
  IorMap map;
  SurfaceVolume surface;
  AttendLog log;
  MotionPredictor::State motion;
  std::optional<PhotometricReference::State> reference;    ///< none: tracking begins without colour
  std::vector<std::shared_ptr<const Keyframe>> keyframes;  ///< in the order in which they came
};

/// Explores a scene frame by frame: tracks the camera, maps, proposes objects, inhibits what was attended, attends the
/// best of the rest (paper, figure 1).
///
/// Owns the map with its attention memory, the surface volume and all stages. Leaves reading frames to sources and
/// keeping results to sinks. One frame at a time; when TBB has a second thread the attention branch runs beside the map
/// branch of the same frame or, where the caller hands in the next frame too, of the one before. Same frames, same
/// config: same results, at any number of threads.
class Explorer {
 public:
  /// `camera`: of all frames to come. `model` ranks instead of the built-in one. Throws std::invalid_argument if a
  /// setting is out of range.
  Explorer(const ExplorerConfig& config, const PinholeCamera& camera,
           const std::optional<RankerModel>& model = std::nullopt);
  ~Explorer();
  Explorer(const Explorer&) = delete;
  Explorer& operator=(const Explorer&) = delete;

  /// Processes one frame, finding its pose by tracking. The report's views are good until the next call. A lost frame
  /// edits nothing and no tick passes; a weakly tracked one attends but is not integrated. Throws
  /// std::invalid_argument if the frame's images do not have the camera's size.
  ///
  /// `next`, if the caller has it already, is the frame of the call that follows: it is tracked and perceived while
  /// this one is mapped and ranked, which keeps two threads busy all the time. Its images must not change until then;
  /// if another frame follows after all, the work was in vain and nothing else. The results are the same with it and
  /// without.
  FrameReport process(const RgbdFrame& frame, const RgbdFrame* next = nullptr);
  /// The same with a pose that is believed instead of tracking; none: the frame counts as lost. `next_T_WC` is the pose
  /// that will be believed of `next`.
  FrameReport processAt(const RgbdFrame& frame, const std::optional<Pose>& T_WC, const RgbdFrame* next = nullptr,
                        const std::optional<Pose>& next_T_WC = std::nullopt);

  /// Goes on from `memory` instead of from nothing.
  void restore(ExplorerMemory memory);
  /// From now on asks `pager` for what it is about to look at; it must live until another call. Null: the whole map is
  /// in memory.
  void pageBy(MapPager* pager);

  /// Where the frame was taken, by the keyframes and the surface alone; none if that is not certain. Edits nothing.
  [[nodiscard]] std::optional<VerifiedPlace> findPlace(const RgbdFrame& frame);
  /// The same near `guess`, by the surface alone.
  [[nodiscard]] std::optional<VerifiedPlace> verifyPlace(const RgbdFrame& frame, const Pose& guess);
  /// Says that the camera is at `T_WC` at `stamp_s`, at rest: the next frame is tracked from there.
  void placeAt(double stamp_s, const Pose& T_WC);

  [[nodiscard]] const IorMap& map() const;
  /// For those who keep or page the map between two frames.
  [[nodiscard]] IorMap& map();
  [[nodiscard]] const SurfaceVolume& surface() const;
  [[nodiscard]] SurfaceVolume& surface();
  [[nodiscard]] const AttendLog& attendLog() const;
  [[nodiscard]] AttendLog& attendLog();
  [[nodiscard]] const MotionPredictor::State& motion() const;
  [[nodiscard]] const PhotometricReference& photometricReference() const;
  [[nodiscard]] const KeyframeSet& keyframes() const;
  [[nodiscard]] const ExplorerConfig& config() const;
  [[nodiscard]] const PinholeCamera& camera() const;

 private:
  struct NextFrame;
  struct Stages;

  [[nodiscard]] bool hasCameraSize(const RgbdFrame& frame) const;
  void requireImages(const RgbdFrame& frame) const;
  FrameReport processFrame(const RgbdFrame& frame, const std::optional<Tracking>& believed, NextFrame next);

  std::unique_ptr<Stages> stages_;
};

}  // namespace saccade
