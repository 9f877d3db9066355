#include "saccade/inspection/session_summary.hpp"

#include <algorithm>
#include <filesystem>

namespace saccade {
namespace {

/// Sum over the runs of the time between their first and last frames: stamps of two inputs have nothing in common.
double coveredTime_s(const std::vector<RunRecord>& runs, const std::vector<FrameRecord>& frames) {
  double covered_s = 0.0;
  std::size_t begin = 0;
  for (std::size_t run = 0; run < runs.size() && begin < frames.size(); ++run) {
    std::size_t end = begin;
    const bool last = run + 1 == runs.size();
    while (end < frames.size() && (last || frames[end].ordinal < runs[run + 1].first)) ++end;
    if (end > begin) covered_s += frames[end - 1].stamp_s - frames[begin].stamp_s;
    begin = end;
  }
  return covered_s;
}

}  // namespace

SessionSummary summarise(const SessionReader& session, const std::vector<FrameRecord>& frames) {
  SessionSummary summary;
  summary.metadata = session.metadata();
  summary.runs = session.runs();
  summary.file_bytes = static_cast<std::int64_t>(std::filesystem::file_size(session.path()));
  summary.keyframes = static_cast<std::int64_t>(session.keyframes().size());
  summary.attended = session.candidateCount();
  summary.frames = static_cast<std::int64_t>(frames.size());
  std::vector<double> times_ms;
  const FrameRecord* last = nullptr;
  for (const FrameRecord& frame : frames) {
    (frame.tracking == "tracked" ? summary.tracked : frame.tracking == "weak" ? summary.weak : summary.lost) += 1;
    summary.mean_open += frame.open;
    summary.mean_inhibited += frame.inhibited;
    times_ms.push_back(frame.processing_ms);
    if (!frame.T_WC) continue;
    if (last != nullptr) summary.path_length_m += (frame.T_WC->translation() - last->T_WC->translation()).norm();
    last = &frame;
  }
  if (frames.empty()) return summary;
  summary.mean_open /= static_cast<double>(frames.size());
  summary.mean_inhibited /= static_cast<double>(frames.size());
  const auto middle = times_ms.begin() + static_cast<std::ptrdiff_t>(times_ms.size() / 2);
  std::nth_element(times_ms.begin(), middle, times_ms.end());
  summary.median_ms = *middle;
  summary.first_stamp_s = frames.front().stamp_s;
  summary.last_stamp_s = frames.back().stamp_s;
  summary.covered_s = coveredTime_s(summary.runs, frames);
  return summary;
}

}  // namespace saccade
