#pragma once

#include <cmath>
#include <cstdint>

namespace saccade {

inline constexpr long double kMicroseconds = 1e6L;  // per second; OpenNI2
inline constexpr long double kMrptTicks = 1e7L;
inline constexpr long double kNanoseconds = 1e9L;  // ROS

/// A stamp as a whole number of units, as a container keeps it.
[[nodiscard]] inline std::int64_t stampIn(long double units_per_second, double stamp_s) {
  return static_cast<std::int64_t>(std::llround(static_cast<long double>(stamp_s) * units_per_second));
}

/// The double nearest to a stamp of so many units; the same as reading it as decimal text.
[[nodiscard]] inline double secondsOf(std::int64_t count, long double units_per_second) {
  return static_cast<double>(static_cast<long double>(count) / units_per_second);
}

/// A stamp as all frames have it: whole microseconds, the finest that every container keeps. Motion is predicted from
/// stamps, so a recording explores to the same bytes as its input only where both have the very same ones.
[[nodiscard]] inline double inWholeMicroseconds(double stamp_s) {
  return secondsOf(stampIn(kMicroseconds, stamp_s), kMicroseconds);
}

}  // namespace saccade
