#pragma once

#include <algorithm>
#include <cmath>
#include <compare>
#include <cstdint>

#include "saccade/core/config_fields.hpp"

/// The law of inhibition of return (paper, "3D IOR map update") in closed form: pure functions, no state of their own.
///
/// The paper touches every voxel at every frame: attended, `w += 1`, and on reaching IOR_LIMIT with the flag off, flag
/// on and `w *= mf`; not attended, `w = max(0, w - 1)`, and at 0 the flag goes off. Here a leaf stores the tick at
/// which it will be forgotten, so that whatever is not attended needs no work at all.
namespace saccade {

/// Time of the map: the number of attention steps since it was begun.
struct Tick {
  std::uint32_t value = 0;
  friend auto operator<=>(const Tick&, const Tick&) = default;
};

/// Memory of one leaf, 4 bytes: when it will be forgotten, and whether it inhibits until then.
class IorState {
 public:
  static constexpr std::uint32_t kLastExpiry = 0x7FFFFFFFu;  ///< expiries saturate here (2.2 years at 30 frames/s)

  constexpr IorState() = default;
  constexpr IorState(std::uint32_t expiry, bool flag) : bits_(std::min(expiry, kLastExpiry) << 1 | (flag ? 1u : 0u)) {}

  /// First tick at which the leaf is forgotten; 0 = never attended. It stays when that tick is over.
  [[nodiscard]] constexpr std::uint32_t expiry() const { return bits_ >> 1; }
  /// The IOR flag as stored; it counts only before the expiry, see inhibited().
  [[nodiscard]] constexpr bool flag() const { return (bits_ & 1u) != 0; }
  /// Expiry and flag as one number, for files.
  [[nodiscard]] constexpr std::uint32_t bits() const { return bits_; }
  [[nodiscard]] static constexpr IorState fromBits(std::uint32_t bits) {
    IorState state;
    state.bits_ = bits;
    return state;
  }
  friend constexpr bool operator==(const IorState&, const IorState&) = default;

 private:
  std::uint32_t bits_ = 0;
};
static_assert(sizeof(IorState) == 4);

/// Parameters of the law.
struct IorParameters {
  int ior_limit = 3;  ///< weight at which the flag goes on (the paper's IOR_LIMIT; the number is by experiment)
  double mf = 6.0;    ///< factor on the weight when the flag goes on (paper: 2, 4, 6)

  void describe(ConfigVisitor& v) {
    v.integer("ior_limit", ior_limit, {1, 1000000}, "ticks", "weight at which the IOR flag goes on");
    v.number("mf", mf, {1, 1000}, "", "factor on the IOR weight when the flag goes on");
  }
};

/// IOR weight at `now`: ticks until the leaf is forgotten, 0 if it is.
[[nodiscard]] constexpr std::uint32_t weight(IorState state, Tick now) {
  return state.expiry() > now.value ? state.expiry() - now.value : 0;
}

/// Whether the leaf inhibits at `now`: flag on and not yet forgotten.
[[nodiscard]] constexpr bool inhibited(IorState state, Tick now) {
  return state.flag() && state.expiry() > now.value;
}

/// The state as far as it is remembered at `now`: a forgotten one is the same as none.
[[nodiscard]] constexpr IorState remembered(IorState state, Tick now) {
  return state.expiry() > now.value ? state : IorState{};
}

/// Whether the leaf was attended at any time since it became occupied, be it forgotten or not.
[[nodiscard]] constexpr bool wasAttended(IorState state) {
  return state.expiry() > 0;
}

/// Whether the leaf was attended and forgotten since. Beyond the paper: attention may return to it, but to what it
/// never attended, or has not had enough of, it goes first (RankingConfig::familiar_loss).
[[nodiscard]] constexpr bool isFamiliar(IorState state, Tick now) {
  return wasAttended(state) && state.expiry() <= now.value;
}

/// The state as far as it can matter from `now` on: of a forgotten one, only that there was one. For comparing and
/// pruning.
[[nodiscard]] constexpr IorState lasting(IorState state, Tick now) {
  constexpr IorState kLongForgotten(1, false);  // who has forgotten anything is at tick 1 or later
  return isFamiliar(state, now) ? kLongForgotten : state;
}

/// Of two states the one that inhibits longer, a state without the flag not at all: what inner nodes hold.
[[nodiscard]] constexpr IorState laterInhibition(IorState a, IorState b) {
  if (!b.flag()) return a;
  return !a.flag() || a.expiry() < b.expiry() ? b : a;
}

/// State after attending a leaf in the step `now` -> `now + 1`.
///
/// A fractional mf gives a fractional weight in the paper; its life is the next whole number of ticks, which is what is
/// stored. Weights that would pass the 31st bit saturate.
[[nodiscard]] inline IorState attend(IorState state, Tick now, const IorParameters& parameters) {
  const std::uint32_t before = weight(state, now);
  bool flag = before > 0 && state.flag();
  double w = static_cast<double>(before) + 1.0;
  if (!flag && w >= parameters.ior_limit) {
    flag = true;
    w = std::ceil(w * parameters.mf);
  }
  const double expiry = static_cast<double>(now.value) + 1.0 + w;
  return {expiry >= IorState::kLastExpiry ? IorState::kLastExpiry : static_cast<std::uint32_t>(expiry), flag};
}

}  // namespace saccade
