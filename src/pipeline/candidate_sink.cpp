#include "saccade/pipeline/candidate_sink.hpp"

#include <fstream>
#include <optional>
#include <utility>

#include "pipeline/background_writer.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/discovery/candidate_json.hpp"

namespace saccade {
namespace {

/// What a line is made of, free of the explorer.
struct LineParts {
  CandidateLineHeader header;
  Candidates open, inhibited;
  int attended = 0;
  FrameSegments segments;
  cv::Mat3f vertices;        // frame C
  std::optional<Pose> T_WC;  // none: no boxes in W
};

void copy(const Segmentation& from, Segmentation& to) {
  to.count = from.count;
  if (from.count > 0) from.labels.copyTo(to.labels);
}

void copy(const FrameReport& report, LineParts& parts) {
  parts.header = {report.index, report.name, report.stamp_s, nameOf(report.tracking.status)};
  parts.open = report.open;
  parts.inhibited = report.inhibited;
  parts.attended = static_cast<int>(report.attended);
  copy(report.seen->color, parts.segments.color);
  copy(report.seen->surface, parts.segments.surface);
  parts.T_WC.reset();
  if (report.depth == nullptr || !report.T_WC()) return;
  report.depth->vertices.copyTo(parts.vertices);
  parts.T_WC = report.T_WC();
}

}  // namespace

class CandidateSink::Lines {
 public:
  Lines(const std::filesystem::path& path, CandidateOutliner outliner)
      : path_(path),
        file_(path),
        outliner_(std::move(outliner)),
        writer_([this](const LineParts& parts) { write(parts); }) {
    if (!file_) throw IoError(path_, "a candidate file that can be written", "none");
  }

  void add(const FrameReport& report) {
    copy(report, writer_.next());
    writer_.submit();
  }

  void finish() {
    writer_.finish();
    file_.close();
  }

 private:
  void write(const LineParts& parts) {
    outliner_.begin(parts.segments, parts.open, parts.inhibited);
    if (parts.T_WC) {
      boxes_.begin(parts.segments, parts.vertices, *parts.T_WC);
    } else {
      boxes_.beginWithoutDepth();
    }
    file_ << candidateLine(parts.header, parts.open, parts.attended, parts.inhibited, outliner_, boxes_) << '\n'
          << std::flush;
    if (!file_) throw IoError(path_, "room for the candidates", "a full or failing disk");
  }

  std::filesystem::path path_;
  std::ofstream file_;
  CandidateOutliner outliner_;
  CandidateBoxes boxes_;
  BackgroundWriter<LineParts> writer_;  // last: its thread uses all others
};

CandidateSink::CandidateSink(const std::filesystem::path& path, CandidateOutliner outliner)
    : lines_(std::make_unique<Lines>(path, std::move(outliner))) {}

CandidateSink::~CandidateSink() = default;

void CandidateSink::accept(const RgbdFrame& /*frame*/, const FrameReport& report) {
  lines_->add(report);
}

void CandidateSink::finish() {
  lines_->finish();
}

}  // namespace saccade
