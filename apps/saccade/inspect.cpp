#include "inspect.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "saccade/session/session_reader.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Summary {
  SessionMetadata metadata;
  std::int64_t file_bytes = 0;
  std::int64_t frames = 0, tracked = 0, weak = 0, lost = 0;
  std::int64_t attended = 0;
  double path_length_m = 0.0;
  double mean_open = 0.0, mean_inhibited = 0.0;
  double median_ms = 0.0;
  double first_stamp_s = 0.0, last_stamp_s = 0.0;
};

Summary summarise(const std::string& path) {
  const SessionReader reader(path);
  Summary summary;
  summary.metadata = reader.metadata();
  summary.file_bytes = static_cast<std::int64_t>(std::filesystem::file_size(path));
  summary.attended = reader.candidateCount();
  const std::vector<FrameRecord> frames = reader.frames();
  summary.frames = static_cast<std::int64_t>(frames.size());
  std::vector<double> times;
  const FrameRecord* last = nullptr;
  for (const FrameRecord& frame : frames) {
    (frame.tracking == "tracked" ? summary.tracked : frame.tracking == "weak" ? summary.weak : summary.lost) += 1;
    summary.mean_open += frame.open;
    summary.mean_inhibited += frame.inhibited;
    times.push_back(frame.processing_ms);
    if (!frame.T_WC) continue;
    if (last != nullptr) summary.path_length_m += (frame.T_WC->translation() - last->T_WC->translation()).norm();
    last = &frame;
  }
  if (frames.empty()) return summary;
  summary.mean_open /= static_cast<double>(frames.size());
  summary.mean_inhibited /= static_cast<double>(frames.size());
  std::nth_element(times.begin(), times.begin() + static_cast<std::ptrdiff_t>(times.size() / 2), times.end());
  summary.median_ms = times[times.size() / 2];
  summary.first_stamp_s = frames.front().stamp_s;
  summary.last_stamp_s = frames.back().stamp_s;
  return summary;
}

void printJson(const Summary& s) {
  const PinholeCamera& camera = s.metadata.camera;
  const nlohmann::ordered_json json = {
      {"saccade_version", s.metadata.saccade_version},
      {"created_utc", s.metadata.created_utc},
      {"input", s.metadata.input},
      {"input_kind", s.metadata.input_kind},
      {"file_bytes", s.file_bytes},
      {"state", nameOf(s.metadata.state)},
      {"camera",
       {{"width", camera.width},
        {"height", camera.height},
        {"fx", camera.fx},
        {"fy", camera.fy},
        {"cx", camera.cx},
        {"cy", camera.cy}}},
      {"frames",
       {{"processed", s.frames},
        {"tracked", s.tracked},
        {"weak", s.weak},
        {"lost", s.lost},
        {"skipped", s.metadata.frames_skipped},
        {"first_stamp_s", s.first_stamp_s},
        {"last_stamp_s", s.last_stamp_s},
        {"median_ms", s.median_ms}}},
      {"path_length_m", s.path_length_m},
      {"map", {{"leaf_size_m", s.metadata.leaf_size_m}, {"leaves", s.metadata.leaves}, {"tick", s.metadata.tick}}},
      {"attention",
       {{"attended_candidates", s.attended}, {"mean_open", s.mean_open}, {"mean_inhibited", s.mean_inhibited}}},
      {"config", s.metadata.config_yaml}};
  std::cout << json.dump(2) << "\n";
}

const char* stateText(SessionState state) {
  switch (state) {
    case SessionState::kExploring:
      return ", still being written or cut off; whole up to its last checkpoint";
    case SessionState::kComplete:
      return "";
    case SessionState::kInterrupted:
      return ", ended early by hand";
  }
  return "";
}

void printText(const Summary& s, const std::string& path) {
  const PinholeCamera& camera = s.metadata.camera;
  std::cout << path << ": a session of " << s.metadata.input << " (" << s.metadata.input_kind << "), written "
            << s.metadata.created_utc << " by saccade " << s.metadata.saccade_version << stateText(s.metadata.state)
            << "\n";
  std::cout << alignedTable({
      {"frames", grouped(s.frames) + " (" + grouped(s.tracked) + " tracked, " + grouped(s.weak) + " weak, " +
                     grouped(s.lost) + " lost, " + grouped(s.metadata.frames_skipped) + " skipped)"},
      {"time covered", fixed(s.last_stamp_s - s.first_stamp_s, 1) + " s"},
      {"camera", grouped(camera.width) + " x " + grouped(camera.height) + " px, f " + fixed(camera.fx, 1)},
      {"camera path", fixed(s.path_length_m, 2) + " m"},
      {"map", grouped(s.metadata.leaves) + " leaves of " + fixed(s.metadata.leaf_size_m * 100.0, 1) + " cm"},
      {"attention", grouped(s.attended) + " looks in " + grouped(s.metadata.tick) + " ticks"},
      {"candidates a frame", fixed(s.mean_open, 1) + " open, " + fixed(s.mean_inhibited, 1) + " inhibited"},
      {"median time a frame", fixed(s.median_ms, 1) + " ms"},
      {"file", fixed(static_cast<double>(s.file_bytes) / 1048576.0, 1) + " MiB"},
  });
}

}  // namespace

void addInspect(CLI::App& program) {
  auto target = std::make_shared<InspectTarget>();
  CLI::App* command = program.add_subcommand("inspect", "Say what a session holds; reads, never writes");
  command->add_option("SESSION", target->session, "a *.saccade file")->required();
  command->add_flag("--json", target->json, "print JSON");
  addInspectObjects(*command, target);
  command->callback([target, command] {
    if (!command->get_subcommands().empty()) return;  // the question was answered
    const Summary summary = summarise(target->session);
    target->json ? printJson(summary) : printText(summary, target->session);
  });
}

}  // namespace saccade::app
