#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/map/model_view.hpp"
#include "saccade/pipeline/explorer.hpp"

namespace saccade {

/// How single frames were found again in a known scene. A frame is located if its place is within 5 cm and 5 degrees of
/// the truth (Shotton et al. 2013).
struct RelocalisationScore {
  static constexpr double kLocated_m = 0.05;
  static constexpr double kLocated_rad = 0.0872665;
  static constexpr double kKnownShare = 0.6;

  std::int64_t frames = 0;
  std::int64_t accepted = 0;  ///< frames for which a place was given
  std::int64_t known = 0;     ///< of which the scene covers kKnownShare of what is measured
  std::int64_t known_located = 0;
  std::int64_t less_known = 0;  ///< the others with a true pose
  std::int64_t less_known_located = 0;
  std::int64_t less_known_refused = 0;
  std::int64_t false_accepts = 0;  ///< places that are wrong, or of frames from elsewhere
  double search_ms = 0.0;          ///< over all frames

  /// A false accept of a frame whose true pose is known.
  struct WrongPlace {
    FrameIndex frame;
    double error_m = 0.0;
    double error_rad = 0.0;
  };
  std::vector<WrongPlace> wrong_places;
};

/// Asks an explorer that knows a scene for the place of single frames, one independent of the other, and keeps score.
class RelocalisationEvaluation {
 public:
  /// `explorer` must outlive this; nothing in it is edited.
  explicit RelocalisationEvaluation(Explorer& explorer) : explorer_(explorer) {}

  /// Scores a frame. `T_WC`: its true pose; none: the frame is from elsewhere and must be refused.
  void add(const RgbdFrame& frame, const std::optional<Pose>& T_WC);

  [[nodiscard]] const RelocalisationScore& score() const { return score_; }

 private:
  [[nodiscard]] double coveredShare(const RgbdFrame& frame, const Pose& T_WC);

  Explorer& explorer_;
  RelocalisationScore score_;
  DepthMaps depth_;
  ModelView view_;
};

}  // namespace saccade
