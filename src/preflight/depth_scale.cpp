#include "preflight/depth_scale.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

namespace saccade {
namespace {

// Natural logarithms of a usual value and of the factor by which it usually varies.
struct Usual {
  double value, factor;

  /// How surprising `found` is: squared standard deviations, halved. No single witness outvotes all others.
  [[nodiscard]] double surprise(double found) const {
    constexpr double kMost = 8.0;
    if (!(found > 0.0)) return kMost;
    const double deviation = std::log(found / value) / std::log(factor);
    return std::min(kMost, 0.5 * deviation * deviation);
  }
};

constexpr Usual kRoomDepth_m{1.7, 1.7};           // indoors; medians of frames are rarely below 0.5 m or above 5 m
constexpr Usual kSensorNoise_per_m{0.0009, 2.5};  // of inverse depth
constexpr Usual kWayRatio{1.0, 1.06};             // alignment over poses
constexpr double kContradiction = 3.0;            // by which the declared scale must be more surprising

constexpr std::array kUnitsInUse = {5000.0, 1000.0, 256.0, 4000.0, 6553.5, 10000.0, 1.0};

const char* usersOf(double units) {
  if (units == 5000.0) return "as TUM and ICL-NUIM store it";
  if (units == 1000.0) return "millimetres";
  if (units == 256.0) return "as KITTI and void store it";
  if (units == 4000.0) return "quarters of a millimetre";
  if (units == 6553.5) return "10 m over 16 bits";
  if (units == 10000.0) return "tenths of a millimetre";
  if (units == 1.0) return "metres";
  return "as declared";
}

}  // namespace

double medianOf(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

double medianDepth(const cv::Mat1f& depth_m) {
  constexpr int kStep = 2;
  std::vector<double> measured;
  for (int v = 0; v < depth_m.rows; v += kStep) {
    for (int u = 0; u < depth_m.cols; u += kStep) {
      if (depth_m(v, u) > 0.0f) measured.push_back(static_cast<double>(depth_m(v, u)));
    }
  }
  return medianOf(std::move(measured));
}

std::optional<DepthScaleGuess> guessDepthScale(const std::vector<double>& medians_m, double declared_units_per_metre,
                                               const std::optional<RigidFit>& fit) {
  const double declared_depth_m = medianOf(medians_m);
  if (!(declared_depth_m > 0) || !(declared_units_per_metre > 0)) return std::nullopt;
  const auto surprise = [&](double units) {
    const double shrink = declared_units_per_metre / units;  // what lengths are multiplied with
    double sum = kRoomDepth_m.surprise(declared_depth_m * shrink);
    if (fit && fit->noise_per_m > 0) sum += kSensorNoise_per_m.surprise(fit->noise_per_m / shrink);
    if (fit && fit->way_ratio) sum += kWayRatio.surprise(*fit->way_ratio * shrink);
    return sum;
  };
  DepthScaleGuess guess;
  guess.declared_units_per_metre = guess.units_per_metre = declared_units_per_metre;
  double least = surprise(declared_units_per_metre);
  const double of_declared = least;
  for (const double units : kUnitsInUse) {
    if (const double found = surprise(units); found < least) {
      least = found;
      guess.units_per_metre = units;
    }
  }
  guess.contradicts = of_declared - least > kContradiction;
  if (!guess.contradicts) guess.units_per_metre = declared_units_per_metre;
  const double shrink = declared_units_per_metre / guess.units_per_metre;
  guess.median_depth_m = declared_depth_m * shrink;
  guess.reason = fmt::format("{:g} units a metre ({}) put the middle of the depth at {:.2f} m", guess.units_per_metre,
                             usersOf(guess.units_per_metre), guess.median_depth_m);
  if (fit && fit->noise_per_m > 0) {
    guess.reason += fmt::format(", the residual of aligned frames at {:.2g} of squared depth (sensors: some 1e-3)",
                                fit->noise_per_m / shrink);
  }
  if (fit && fit->way_ratio) {
    guess.reason += fmt::format(", the way between frames at {:.2f} of that of the poses", *fit->way_ratio * shrink);
  }
  if (guess.contradicts) {
    guess.reason += fmt::format("; the declared {:g} put it at {:.2f} m", declared_units_per_metre, declared_depth_m);
    if (fit && fit->way_ratio) guess.reason += fmt::format(" and the way at {:.2f}", *fit->way_ratio);
  }
  return guess;
}

}  // namespace saccade
