#pragma once

#include <cstdint>

namespace saccade::portable {

/// Eight floats that are worked on at once; any processor.
struct Lanes {
  float lane[8];

  static Lanes all(float value) {
    return Lanes::make([&](int) { return value; });
  }
  static Lanes load(const float* from) {
    return Lanes::make([&](int i) { return from[i]; });
  }

  /// The values must be whole and fit.
  void storeWhole(std::int32_t* to) const {
    for (int i = 0; i < 8; ++i) to[i] = static_cast<std::int32_t>(lane[i]);
  }
  /// Writes lane i where bit i is set, and `value` beside it.
  void storeWhere(unsigned bits, float* to, std::int32_t value, std::int32_t* beside) const {
    for (int i = 0; i < 8; ++i) {
      if ((bits >> i & 1u) != 0) {
        to[i] = lane[i];
        beside[i] = value;
      }
    }
  }

  template <typename Function>
  static Lanes make(Function function) {
    Lanes result;
    for (int i = 0; i < 8; ++i) result.lane[i] = function(i);
    return result;
  }
};

inline Lanes operator+(Lanes a, Lanes b) {
  return Lanes::make([&](int i) { return a.lane[i] + b.lane[i]; });
}
inline Lanes operator-(Lanes a, Lanes b) {
  return Lanes::make([&](int i) { return a.lane[i] - b.lane[i]; });
}
inline Lanes operator*(Lanes a, Lanes b) {
  return Lanes::make([&](int i) { return a.lane[i] * b.lane[i]; });
}
inline Lanes operator/(Lanes a, Lanes b) {
  return Lanes::make([&](int i) { return a.lane[i] / b.lane[i]; });
}
/// The second one where either is not a number, as the processor's instructions.
inline Lanes min(Lanes a, Lanes b) {
  return Lanes::make([&](int i) { return a.lane[i] < b.lane[i] ? a.lane[i] : b.lane[i]; });
}
inline Lanes max(Lanes a, Lanes b) {
  return Lanes::make([&](int i) { return a.lane[i] > b.lane[i] ? a.lane[i] : b.lane[i]; });
}
/// Whole part towards 0; the values must fit an int.
inline Lanes truncated(Lanes a) {
  return Lanes::make([&](int i) { return static_cast<float>(static_cast<std::int32_t>(a.lane[i])); });
}
inline Lanes abs(Lanes a) {
  return max(a, Lanes::all(0.0f) - a);
}
/// Bit i set where a > b in lane i.
inline unsigned greater(Lanes a, Lanes b) {
  unsigned bits = 0;
  for (int i = 0; i < 8; ++i) bits |= static_cast<unsigned>(a.lane[i] > b.lane[i]) << i;
  return bits;
}

}  // namespace saccade::portable
