#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "saccade/sources/frame_source.hpp"

namespace saccade {

enum class FindingSeverity {
  kNote,     ///< worth knowing
  kWarning,  ///< exploring works, but not as well as it might
  kFault,    ///< exploring would fail, or give nonsense
};

/// One thing that a preflight noticed about an input.
struct PreflightFinding {
  FindingSeverity severity = FindingSeverity::kNote;
  std::string code;  ///< "swapped-lists", "depth-scale", ...: the same word for the same thing, see docs/inputs.md
  std::string text;  ///< for people: what was found, and what to do
};

/// Distances between the stamps of one stream.
struct StampStatistics {
  double period_s = 0.0;  ///< of the frames, gaps filled; 0: fewer than two stamps
  double worst_gap_s = 0.0;
  std::int64_t frames = 0;
  std::int64_t missing = 0;     ///< frames that would fill the gaps
  std::int64_t duplicates = 0;  ///< stamps that the stamp before them has too
};

/// How many raw units of depth a metre has, judged by what the depth images hold.
struct DepthScaleGuess {
  double units_per_metre = 0.0;  ///< the likeliest of those in use
  double declared_units_per_metre = 0.0;
  double median_depth_m = 0.0;  ///< at the likeliest scale
  std::string reason;           ///< one sentence
  bool contradicts = false;     ///< the declared scale is much less likely
};

/// What is to be known about an input before it is explored.
struct PreflightReport {
  std::string input;
  std::optional<SourceDescription> source;  ///< none: it cannot be opened
  std::vector<PreflightFinding> findings;   ///< the gravest first
  std::optional<StampStatistics> stamps;    ///< of the colour images, where they are known without reading them
  std::optional<DepthScaleGuess> depth_scale;
  /// True focal length over the declared one, by the fit of neighbouring frames; none: it could not be judged.
  std::optional<double> focal_factor;
  double expected_seconds = 0.0;  ///< of exploring on two cores; 0: the number of frames is not known
  double expected_memory_mib = 0.0;
  std::string command;  ///< the exact call that explores it

  /// Whether exploring would fail or give nonsense.
  [[nodiscard]] bool wouldFail() const;
  [[nodiscard]] bool has(const std::string& code) const;
};

/// Examines an input without exploring it: opens it, looks at all files of a folder, and at some 50 frames in depth
/// (stamps, scale, intrinsics, whether colour and depth show the same things). Some seconds. Never throws for what is
/// wrong with the input: that is a finding.
[[nodiscard]] PreflightReport preflight(const std::string& input);

[[nodiscard]] const char* nameOf(FindingSeverity severity);

}  // namespace saccade
