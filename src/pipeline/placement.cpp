#include "saccade/pipeline/placement.hpp"

namespace saccade {

const char* nameOf(PlacementState state) {
  switch (state) {
    case PlacementState::kUnlocalised:
      return "unlocalised";
    case PlacementState::kTentative:
      return "tentative";
    case PlacementState::kVerified:
      return "verified";
  }
  return "";
}

Placement::Placement(Explorer& explorer, const std::optional<Pose>& guess) : explorer_(explorer), T_WC_(guess) {}

PlacementState Placement::offer(const RgbdFrame& frame) {
  if (state_ == PlacementState::kVerified) return state_;
  const bool was_tentative = state_ == PlacementState::kTentative;
  std::optional<VerifiedPlace> place;
  if (T_WC_) place = explorer_.verifyPlace(frame, *T_WC_);
  confirmations_ = place && was_tentative ? confirmations_ + 1 : 0;
  if (!place) place = explorer_.findPlace(frame);
  T_WC_ = place ? std::optional<Pose>(place->tracking.T_WC) : std::nullopt;
  state_ = !place                            ? PlacementState::kUnlocalised
           : confirmations_ < kConfirmations ? PlacementState::kTentative
                                             : PlacementState::kVerified;
  if (state_ == PlacementState::kVerified) explorer_.placeAt(frame.stamp_s, *T_WC_);
  return state_;
}

}  // namespace saccade
