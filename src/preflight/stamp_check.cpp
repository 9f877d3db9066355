#include "preflight/stamp_check.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "sources/association.hpp"
#include "sources/stamped_files.hpp"

namespace saccade {
namespace {

constexpr double kGapPeriods = 1.6;       // between two stamps: more is a gap
constexpr double kLongGap_s = 0.3;        // a hand-held camera moves out of reach
constexpr double kManyMissing = 0.2;      // share of the frames
constexpr double kManyUnmatched = 0.3;    // share of all images
constexpr double kShiftPeriods = 1.5;     // between the begins, and the ends, of both streams
constexpr double kDriftRate = 0.0025;     // 29.9 against 30 frames a second are 0.0033
constexpr double kVisibleDrift_s = 0.01;  // over the whole input

double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// A shift of the whole stream, by which most images of one stream find their neighbour in the other.
void checkShift(const std::vector<double>& color_s, const std::vector<double>& depth_s, double period_s,
                std::vector<PreflightFinding>& findings) {
  const double at_begin_s = depth_s.front() - color_s.front(), at_end_s = depth_s.back() - color_s.back();
  const double shift_s = 0.5 * (at_begin_s + at_end_s);
  if (std::abs(at_begin_s) < kShiftPeriods * period_s || std::abs(at_end_s) < kShiftPeriods * period_s ||
      std::abs(at_begin_s - at_end_s) > kShiftPeriods * period_s) {
    return;
  }
  findings.push_back({FindingSeverity::kFault, "stamp-shift",
                      fmt::format("depth stamps lie {:.3f} s {} those of colour from begin to end, so that images of "
                                  "different moments are paired: take that off the stamps of one list",
                                  std::abs(shift_s), shift_s > 0 ? "after" : "before")});
}

void checkDrift(const StampStatistics& color, const StampStatistics& depth, double duration_s,
                std::vector<PreflightFinding>& findings) {
  const double rate = depth.period_s / color.period_s - 1.0;
  const double drift_s = rate * duration_s;
  if (std::abs(rate) < kDriftRate || std::abs(drift_s) < kVisibleDrift_s) return;
  // One stream at another frame rate on purpose (15 and 30 a second) is no drift.
  constexpr double kOtherRate = 0.2;
  if (std::abs(rate) > kOtherRate) return;
  findings.push_back(
      {FindingSeverity::kFault, "stamp-drift",
       fmt::format("depth stamps run {:.2f} % {} than those of colour ({:.4f} and {:.4f} s a frame): {:.0f} ms apart "
                   "at the end. The clocks differ, or one list was stamped with a wrong frame rate",
                   100.0 * std::abs(rate), rate > 0 ? "slower" : "faster", depth.period_s, color.period_s,
                   1000.0 * std::abs(drift_s))});
}

}  // namespace

StampStatistics stampStatistics(const std::vector<double>& stamps_s) {
  StampStatistics statistics;
  statistics.frames = static_cast<std::int64_t>(stamps_s.size());
  std::vector<double> steps;
  for (std::size_t i = 1; i < stamps_s.size(); ++i) {
    const double step = stamps_s[i] - stamps_s[i - 1];
    step > 0.0 ? steps.push_back(step) : void(++statistics.duplicates);
  }
  if (steps.empty()) return statistics;
  statistics.worst_gap_s = *std::max_element(steps.begin(), steps.end());
  // Steps tremble, so that their median is a few percent off; counted in whole periods, they add up to the right one.
  const double about_s = median(steps);
  double periods = 0.0;
  for (const double step : steps) {
    periods += std::max(1.0, std::round(step / about_s));
    if (step > kGapPeriods * about_s) statistics.missing += std::lround(step / about_s) - 1;
  }
  statistics.period_s = (stamps_s.back() - stamps_s.front()) / periods;
  return statistics;
}

void checkStamps(const StampStatistics& stamps, const std::string& what, std::vector<PreflightFinding>& findings) {
  if (stamps.duplicates > 0) {
    findings.push_back({FindingSeverity::kWarning, "stamp-duplicates",
                        fmt::format("{} of {} stamps of {} are those of the image before: motion between such frames "
                                    "cannot be foreseen",
                                    stamps.duplicates, stamps.frames, what)});
  }
  if (stamps.missing == 0) return;
  const bool grave =
      stamps.worst_gap_s > kLongGap_s ||
      static_cast<double>(stamps.missing) > kManyMissing * static_cast<double>(stamps.frames + stamps.missing);
  findings.push_back({grave ? FindingSeverity::kWarning : FindingSeverity::kNote, "stamp-gaps",
                      fmt::format("{} frames of {} are missing by the stamps ({:.1f} frames a second), the longest gap "
                                  "is {:.2f} s: tracking may be lost there",
                                  stamps.missing, what, 1.0 / stamps.period_s, stamps.worst_gap_s)});
}

void checkStampPairs(const std::vector<double>& color_s, const std::vector<double>& depth_s,
                     std::vector<PreflightFinding>& findings) {
  if (color_s.empty() || depth_s.empty()) return;
  const StampStatistics color = stampStatistics(color_s), depth = stampStatistics(depth_s);
  if (color.period_s > 0 && depth.period_s > 0) {
    checkShift(color_s, depth_s, color.period_s, findings);
    checkDrift(color, depth, color_s.back() - color_s.front(), findings);
  }
  const auto images = static_cast<double>(color_s.size() + depth_s.size());
  const auto pairs = static_cast<double>(associate(color_s, depth_s, kSamePairStamps_s).size());
  const double unmatched = 1.0 - 2.0 * pairs / images;
  if (unmatched <= kManyUnmatched) return;
  findings.push_back({pairs == 0 ? FindingSeverity::kFault : FindingSeverity::kWarning, "unmatched",
                      fmt::format("{:.0f} % of {} colour and {} depth images find no partner within {:.0f} ms",
                                  100.0 * unmatched, color_s.size(), depth_s.size(), 1000.0 * kSamePairStamps_s)});
}

}  // namespace saccade
