#include "saccade/pipeline/candidate_sink.hpp"

#include <utility>

#include "saccade/core/errors.hpp"
#include "saccade/discovery/candidate_json.hpp"

namespace saccade {

CandidateSink::CandidateSink(const std::filesystem::path& path, CandidateOutliner outliner)
    : path_(path), file_(path), outliner_(std::move(outliner)) {
  if (!file_) throw IoError(path_, "a candidate file that can be written", "none");
}

void CandidateSink::accept(const RgbdFrame& /*frame*/, const FrameReport& report) {
  const CandidateLineHeader header{report.index, report.name, report.stamp_s, nameOf(report.tracking.status)};
  outliner_.begin(*report.seen);
  file_ << candidateLine(header, report.open, static_cast<int>(report.attended), report.inhibited, *report.seen,
                         outliner_, report.depth, report.T_WC())
        << '\n'
        << std::flush;
  if (!file_) throw IoError(path_, "room for the candidates", "a full or failing disk");
}

void CandidateSink::finish() {
  file_.close();
}

}  // namespace saccade
