#include "saccade/preflight/preflight.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include <fmt/format.h>

#include "preflight/depth_scale.hpp"
#include "preflight/edge_agreement.hpp"
#include "preflight/folder_images.hpp"
#include "preflight/rigid_fit.hpp"
#include "preflight/stamp_check.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/simulation/simulated_source.hpp"
#include "sources/frame_list.hpp"
#include "sources/stamped_files.hpp"

namespace saccade {
namespace {

constexpr std::int64_t kSampledFrames = 48;
constexpr double kWrongFocal = 0.12;    // of the logarithm of the focal factor
constexpr double kWorseFit = 1.03;      // residual at the declared focal length over the least
constexpr double kMuchWorseFit = 1.06;  // people that walk about make 1.05
constexpr double kTelling = 1.3;        // gain of edges
constexpr double kSparseDepth = 0.1;    // share of the pixels
// Of exploring into a session, measured on two cores of an AMD EPYC with 640x480 pixels and 1 cm leaves: the kitchen's
// 500 frames take 35 s and 680 MiB at most, its first 120 frames 375 MiB.
constexpr double kSecondsPerFrame = 0.07;
constexpr double kBaseMemory_mib = 280.0;
constexpr double kMemoryPerFrame_mib = 0.8;
constexpr double kUsualPixels = 640.0 * 480.0;

/// Frames to be looked at in depth, in a row.
struct Sample {
  std::vector<RgbdFrame> frames;
  std::int64_t skipped = 0;
  std::string skip_reason;
};

Sample readSample(const std::string& input, const SourceDescription& description) {
  FrameRange range;
  if (description.total_frames > kSampledFrames) range.first = (description.total_frames - kSampledFrames) / 2;
  Sample sample;
  const auto source = openSource(input, range);
  RgbdFrame frame;
  for (std::int64_t read = 0; read < kSampledFrames; ++read) {
    const ReadStatus status = source->read(frame);
    if (status == ReadStatus::kEnd) break;
    if (status == ReadStatus::kFrame) {
      // The pixels are handed over, so that the next frame is read into new ones.
      sample.frames.push_back(std::exchange(frame, RgbdFrame{}));
    } else if (++sample.skipped == 1) {
      sample.skip_reason = source->skipReason();
    }
  }
  return sample;
}

bool isFolder(const std::string& input) {
  std::error_code ignored;
  return !SimulationRequest::matches(input) && std::filesystem::is_directory(input, ignored);
}

/// What the files of a folder tell, also where it cannot be opened as a whole.
void checkFolder(const std::filesystem::path& folder, PreflightReport& report) {
  const std::filesystem::path color_list = folder / "rgb.txt", depth_list = folder / "depth.txt";
  try {
    if (std::filesystem::exists(color_list) && std::filesystem::exists(depth_list)) {
      const std::vector<double> color_s = stampsOf(readStampedFiles(color_list));
      report.stamps = stampStatistics(color_s);
      checkStamps(*report.stamps, "colour", report.findings);
      checkStampPairs(color_s, stampsOf(readStampedFiles(depth_list)), report.findings);
    }
    const FrameList list = listFolder(folder);
    checkFolderImages(list, report.findings);
    if (report.stamps) return;
    std::vector<double> stamps_s;
    for (const FrameFiles& files : list.frames) stamps_s.push_back(files.stamp_s);
    report.stamps = stampStatistics(stamps_s);
    checkStamps(*report.stamps, "the frames", report.findings);
  } catch (const IoError&) {
    // The same error comes again, and is told, where the folder is opened.
  }
}

void checkScale(const Sample& sample, const std::optional<RigidFit>& fit, PreflightReport& report) {
  std::vector<double> medians_m, shares;
  for (const RgbdFrame& frame : sample.frames) {
    medians_m.push_back(medianDepth(frame.depth_m));
    shares.push_back(cv::countNonZero(frame.depth_m > 0) / static_cast<double>(frame.depth_m.total()));
  }
  if (const double share = medianOf(shares); share < kSparseDepth) {
    report.findings.push_back({FindingSeverity::kWarning, "sparse-depth",
                               fmt::format("only {:.0f} % of the pixels have depth", 100.0 * share)});
  }
  report.depth_scale = guessDepthScale(medians_m, report.source->depth_units_per_metre, fit);
  if (!report.depth_scale || !report.depth_scale->contradicts) return;
  report.findings.push_back(
      {FindingSeverity::kFault, "depth-scale",
       fmt::format("depth looks {:.3g} times too {}: {}. Say depth_units_per_metre: {:g} in a "
                   "camera.yaml",
                   std::max(report.depth_scale->units_per_metre, report.source->depth_units_per_metre) /
                       std::min(report.depth_scale->units_per_metre, report.source->depth_units_per_metre),
                   report.depth_scale->units_per_metre > report.source->depth_units_per_metre ? "far" : "near",
                   report.depth_scale->reason, report.depth_scale->units_per_metre)});
}

void checkFit(const RigidFit& fit, PreflightReport& report) {
  if (2 * fit.lost_segments > fit.segments) {
    report.findings.push_back({FindingSeverity::kFault, "no-fit",
                               fmt::format("depth of neighbouring frames does not fit together in {} of {} places: not "
                                           "one scene, or steps too wide for tracking (try --poses)",
                                           fit.lost_segments, fit.segments)});
    return;
  }
  report.focal_factor = fit.focal_factor;
  if (!fit.focal_factor) {
    report.findings.push_back({FindingSeverity::kNote, "little-motion",
                               fmt::format("the camera turns too little where it was looked at ({:.1f} degrees) for "
                                           "intrinsics to be judged",
                                           fit.turn_deg)});
    return;
  }
  if (std::abs(std::log(*fit.focal_factor)) < kWrongFocal || fit.focal_penalty < kWorseFit) return;
  report.findings.push_back(
      {fit.focal_penalty < kMuchWorseFit ? FindingSeverity::kWarning : FindingSeverity::kFault, "intrinsics",
       fmt::format("neighbouring frames fit best with a focal length of {:.2f} times the declared {:.0f} px ({}), and "
                   "{:.0f} % worse with that one: the intrinsics look wrong",
                   *fit.focal_factor, report.source->camera.fx, report.source->intrinsics_origin,
                   100.0 * (fit.focal_penalty - 1.0))});
}

void checkEdges(const EdgeAgreement& edges, PreflightReport& report) {
  if (edges.gain_of_turn > kTelling) {
    report.findings.push_back(
        {FindingSeverity::kFault, "rotated-images",
         "edges of colour and depth meet only with depth " + edges.best_turn + ": one of the two was turned"});
    return;
  }
  if (edges.gain_of_lag <= kTelling || report.has("stamp-shift")) return;
  report.findings.push_back({FindingSeverity::kWarning, "time-lag",
                             fmt::format("edges of colour meet those of the depth {} frame{} {} much better: images of "
                                         "different moments seem to be paired",
                                         std::abs(edges.best_lag), std::abs(edges.best_lag) == 1 ? "" : "s",
                                         edges.best_lag > 0 ? "later" : "earlier")});
}

void checkFrames(const std::string& input, PreflightReport& report) {
  const Sample sample = readSample(input, *report.source);
  if (sample.frames.empty()) {
    report.findings.push_back({FindingSeverity::kFault, "no-frames", "no usable frame: " + sample.skip_reason});
    return;
  }
  if (sample.skipped > 0 && !report.has("unreadable-images") && !report.has("missing-images")) {
    report.findings.push_back(
        {FindingSeverity::kWarning, "skipped-frames",
         fmt::format("{} of {} frames looked at cannot be used: {}", sample.skipped,
                     sample.skipped + static_cast<std::int64_t>(sample.frames.size()), sample.skip_reason)});
  }
  if (!report.source->has_depth) return;
  const std::optional<RigidFit> fit = fitFrames(sample.frames, report.source->camera);
  if (fit) checkFit(*fit, report);
  checkScale(sample, fit, report);
  if (const auto edges = compareEdges(sample.frames)) checkEdges(*edges, report);
}

std::string quoted(const std::string& text) {
  const bool plain = text.find_first_not_of("abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789/._-:=") ==
                     std::string::npos;
  if (plain) return text;
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string commandFor(const std::string& input) {
  std::string name = std::filesystem::path(input).lexically_normal().stem().string();
  if (name.empty()) name = std::filesystem::path(input).lexically_normal().parent_path().stem().string();
  const std::string word = name.substr(0, name.find_first_of("?#"));
  std::string stem;
  for (const char c : word) stem += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '-' ? c : '_';
  return "saccade explore " + quoted(input) + " -o " + (stem.empty() ? "my" : stem) + ".saccade";
}

void estimateCost(PreflightReport& report) {
  const SourceDescription& source = *report.source;
  if (source.frames < 0) return;
  const double frames = static_cast<double>(source.frames);
  const double pixels = static_cast<double>(source.camera.width) * source.camera.height / kUsualPixels;
  report.expected_seconds = frames * kSecondsPerFrame * pixels;
  report.expected_memory_mib = kBaseMemory_mib * pixels + frames * kMemoryPerFrame_mib;
}

}  // namespace

bool PreflightReport::wouldFail() const {
  return std::any_of(findings.begin(), findings.end(),
                     [](const PreflightFinding& finding) { return finding.severity == FindingSeverity::kFault; });
}

bool PreflightReport::has(const std::string& code) const {
  return std::any_of(findings.begin(), findings.end(),
                     [&](const PreflightFinding& finding) { return finding.code == code; });
}

PreflightReport preflight(const std::string& input) {
  PreflightReport report;
  report.input = input;
  report.command = commandFor(input);
  if (isFolder(input)) checkFolder(input, report);
  try {
    report.source = openSource(input)->description();
    if (!report.source->has_depth) {
      report.findings.push_back({FindingSeverity::kFault, "no-depth", "there is no depth, only colour"});
    }
    checkFrames(input, report);
    estimateCost(report);
  } catch (const IoError& error) {
    // What the files told says more than the first of them that could not be opened.
    if (!report.wouldFail()) report.findings.push_back({FindingSeverity::kFault, "cannot-open", error.what()});
  }
  std::stable_sort(report.findings.begin(), report.findings.end(),
                   [](const PreflightFinding& a, const PreflightFinding& b) { return a.severity > b.severity; });
  return report;
}

const char* nameOf(FindingSeverity severity) {
  switch (severity) {
    case FindingSeverity::kFault:
      return "fault";
    case FindingSeverity::kWarning:
      return "warning";
    case FindingSeverity::kNote:
      break;
  }
  return "note";
}

}  // namespace saccade
