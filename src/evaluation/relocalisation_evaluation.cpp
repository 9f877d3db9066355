#include "saccade/evaluation/relocalisation_evaluation.hpp"

#include <chrono>

#include <Eigen/Geometry>

namespace saccade {
namespace {

using WrongPlace = RelocalisationScore::WrongPlace;

WrongPlace errorOf(FrameIndex frame, const Pose& T_WC, const Pose& truth) {
  const Pose error = truth.inverse() * T_WC;
  return {frame, error.translation().norm(), Eigen::AngleAxisd(error.linear()).angle()};
}

bool isLocated(const WrongPlace& error) {
  return error.error_m < RelocalisationScore::kLocated_m && error.error_rad < RelocalisationScore::kLocated_rad;
}

}  // namespace

/// Share of the measured pixels behind which the scene has a surface, seen from the true pose.
double RelocalisationEvaluation::coveredShare(const RgbdFrame& frame, const Pose& T_WC) {
  DepthPreparation(explorer_.config().depth).prepare(frame.depth_m, explorer_.camera(), depth_);
  explorer_.surface().rayCast(explorer_.camera(), T_WC, view_);
  std::int64_t measured = 0, covered = 0;
  for (int v = 0; v < view_.depth_m.rows; ++v) {
    for (int u = 0; u < view_.depth_m.cols; ++u) {
      if (!(depth_.depth_m(v, u) > 0.0F)) continue;
      ++measured;
      if (view_.depth_m(v, u) > 0.0F) ++covered;
    }
  }
  return measured > 0 ? static_cast<double>(covered) / static_cast<double>(measured) : 0.0;
}

void RelocalisationEvaluation::add(const RgbdFrame& frame, const std::optional<Pose>& T_WC) {
  const auto start = std::chrono::steady_clock::now();
  const std::optional<VerifiedPlace> place = explorer_.findPlace(frame);
  score_.search_ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  ++score_.frames;
  if (place) ++score_.accepted;
  bool located = false;
  if (place && T_WC) {
    const WrongPlace error = errorOf(frame.index, place->tracking.T_WC, *T_WC);
    located = isLocated(error);
    if (!located) score_.wrong_places.push_back(error);
  }
  if (place && !located) ++score_.false_accepts;
  if (!T_WC) return;
  if (!frame.depth_m.empty() && coveredShare(frame, *T_WC) >= RelocalisationScore::kKnownShare) {
    ++score_.known;
    if (located) ++score_.known_located;
    return;
  }
  ++score_.less_known;
  if (located) ++score_.less_known_located;
  if (!place) ++score_.less_known_refused;
}

}  // namespace saccade
