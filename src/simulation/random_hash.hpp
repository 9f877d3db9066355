#pragma once

#include <cstdint>

namespace saccade {

/// Mixes a number into one that looks random (the finaliser of SplitMix64): the same everywhere, in any order.
[[nodiscard]] inline std::uint64_t mixed(std::uint64_t x) {
  x += 0x9e3779b97f4a7c15u;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

/// Uniform in [0, 1) from the upper bits.
[[nodiscard]] inline double uniform(std::uint64_t bits) {
  return static_cast<double>(bits >> 11) * 0x1p-53;
}

/// A running stream of random numbers for building scenes.
class RandomStream {
 public:
  explicit RandomStream(std::uint64_t seed) : state_(mixed(seed)) {}
  [[nodiscard]] double between(double low, double high) { return low + (high - low) * uniform(next()); }
  /// A whole number of 0 .. count - 1.
  [[nodiscard]] int below(int count) { return static_cast<int>(uniform(next()) * count); }
  [[nodiscard]] bool chance(double probability) { return uniform(next()) < probability; }
  [[nodiscard]] std::uint32_t bits() { return static_cast<std::uint32_t>(next() >> 32); }

 private:
  std::uint64_t next() { return mixed(state_++); }
  std::uint64_t state_;
};

}  // namespace saccade
