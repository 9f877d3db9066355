#include "saccade/evaluation/run_recording.hpp"

#include <fstream>

#include <nlohmann/json.hpp>

#include "saccade/core/errors.hpp"
#include "saccade/session/session_reader.hpp"

namespace saccade {
namespace {

RunRecording loadSession(const std::filesystem::path& path) {
  const SessionReader reader(path);
  RunRecording recording;
  recording.only_attended = true;
  recording.image_size = {reader.metadata().camera.width, reader.metadata().camera.height};
  for (FrameRecord& frame : reader.frames()) {
    RecordedFrame recorded{
        frame.index, std::move(frame.name), frame.stamp_s,      std::move(frame.tracking), frame.T_WC,
        {},          frame.inhibited,       frame.processing_ms};
    for (CandidateRecord& candidate : reader.candidates(frame.ordinal)) {
      recorded.open.push_back({candidate.box, std::move(candidate.mask_rle), true, candidate.revisited_share});
    }
    recording.frames.push_back(std::move(recorded));
  }
  return recording;
}

RecordedFrame frameOf(const nlohmann::json& line, cv::Size& size) {
  RecordedFrame frame;
  frame.index.value = line.at("frame").get<std::int64_t>();
  frame.name = line.at("name").get<std::string>();
  frame.stamp_s = line.at("stamp_s").get<double>();
  frame.tracking = line.at("tracking").get<std::string>();
  for (const nlohmann::json& candidate : line.at("candidates")) {
    if (candidate.at("inhibited").get<bool>()) {
      ++frame.inhibited;
      continue;
    }
    const auto box = candidate.at("box").get<std::array<int, 4>>();
    const nlohmann::json& mask = candidate.at("mask");
    const auto mask_size = mask.at("size").get<std::array<int, 2>>();
    size = {mask_size[1], mask_size[0]};
    frame.open.push_back({{box[0], box[1], box[2], box[3]},
                          mask.at("counts").get<std::string>(),
                          candidate.at("attended").get<bool>(),
                          std::nullopt});
  }
  return frame;
}

RunRecording loadCandidateLines(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw IoError(path, "a file of candidates", "none that can be read");
  RunRecording recording;
  std::string line;
  for (std::int64_t number = 1; std::getline(file, line); ++number) {
    try {
      recording.frames.push_back(frameOf(nlohmann::json::parse(line), recording.image_size));
    } catch (const nlohmann::json::exception& error) {
      throw IoError(path, "a candidate line (see saccade explore --candidates) at line " + std::to_string(number),
                    error.what());
    }
  }
  if (recording.frames.empty()) throw IoError(path, "candidate lines", "none");
  return recording;
}

}  // namespace

void RecordingSink::accept(const RgbdFrame& /*frame*/, const FrameReport& report) {
  RecordedFrame frame{report.index,
                      report.name,
                      report.stamp_s,
                      nameOf(report.tracking.status),
                      report.T_WC(),
                      {},
                      static_cast<int>(report.inhibited.size()),
                      report.total_ms};
  outliner_.begin(*report.seen, report.open);
  for (std::size_t rank = 0; rank < report.open.size(); ++rank) {
    CandidateOutline outline = outliner_.outline(report.open[rank]);
    RecordedCandidate candidate{outline.box, std::move(outline.mask), rank < report.attended, std::nullopt};
    if (rank < report.revisited_share.size()) candidate.revisited_share = report.revisited_share[rank];
    frame.open.push_back(std::move(candidate));
  }
  recording_.image_size = report.seen->imageSize();
  recording_.frames.push_back(std::move(frame));
}

RunRecording loadRecording(const std::filesystem::path& path) {
  return path.extension() == ".jsonl" ? loadCandidateLines(path) : loadSession(path);
}

}  // namespace saccade
