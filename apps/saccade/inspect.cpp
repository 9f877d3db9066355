#include "inspect.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "saccade/inspection/session_summary.hpp"
#include "saccade/session/session_snapshot.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

void printJson(const SessionSummary& s) {
  const PinholeCamera& camera = s.metadata.camera;
  nlohmann::ordered_json runs = nlohmann::ordered_json::array();
  for (const RunRecord& run : s.runs) {
    runs.push_back({{"input", run.input},
                    {"input_kind", run.input_kind},
                    {"first_frame", run.first.value},
                    {"started_utc", run.started_utc}});
  }
  const nlohmann::ordered_json json = {
      {"schema", kInspectSchema},
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
      {"runs", runs},
      {"frames",
       {{"processed", s.frames},
        {"tracked", s.tracked},
        {"weak", s.weak},
        {"lost", s.lost},
        {"skipped", s.metadata.frames_skipped},
        {"keyframes", s.keyframes},
        {"first_stamp_s", s.first_stamp_s},
        {"last_stamp_s", s.last_stamp_s},
        {"covered_s", s.covered_s},
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

/// The course of one number over the frames, a line of the table.
template <typename ValueOf>
std::vector<std::string> course(const char* name, const std::vector<FrameRecord>& frames, int digits,
                                const ValueOf& valueOf) {
  std::vector<double> values;
  for (const FrameRecord& frame : frames) values.push_back(valueOf(frame));
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  return {name, sparkline(values), fixed(*least, digits) + " to " + fixed(*most, digits)};
}

void printText(const SessionSummary& s, const std::vector<FrameRecord>& frames, const std::string& path) {
  const PinholeCamera& camera = s.metadata.camera;
  std::cout << path << ": a session of " << s.metadata.input << " (" << s.metadata.input_kind << "), written "
            << s.metadata.created_utc << " by saccade " << s.metadata.saccade_version << stateText(s.metadata.state)
            << "\n";
  std::cout << alignedTable({
      {"frames", grouped(s.frames) + " (" + grouped(s.tracked) + " tracked, " + grouped(s.weak) + " weak, " +
                     grouped(s.lost) + " lost, " + grouped(s.metadata.frames_skipped) + " skipped)"},
      {"runs", grouped(static_cast<std::int64_t>(s.runs.size()))},
      {"time covered", fixed(s.covered_s, 1) + " s"},
      {"camera", grouped(camera.width) + " x " + grouped(camera.height) + " px, f " + fixed(camera.fx, 1)},
      {"camera path", fixed(s.path_length_m, 2) + " m"},
      {"map", grouped(s.metadata.leaves) + " leaves of " + fixed(s.metadata.leaf_size_m * 100.0, 1) + " cm"},
      {"attention", grouped(s.attended) + " looks in " + grouped(s.metadata.tick) + " ticks"},
      {"candidates a frame", fixed(s.mean_open, 1) + " open, " + fixed(s.mean_inhibited, 1) + " inhibited"},
      {"median time a frame", fixed(s.median_ms, 1) + " ms"},
      {"key frames", grouped(s.keyframes)},
      {"file", fixed(static_cast<double>(s.file_bytes) / 1048576.0, 1) + " MiB"},
  });
  if (frames.size() < 2) return;
  std::cout << "over the frames:\n"
            << alignedTable({
                   course("open candidates", frames, 0, [](const FrameRecord& f) { return f.open; }),
                   course("inhibited", frames, 0, [](const FrameRecord& f) { return f.inhibited; }),
                   course("matched pixels, %", frames, 0, [](const FrameRecord& f) { return 100.0 * f.inlier_share; }),
                   course("residual, mm", frames, 1, [](const FrameRecord& f) { return 1000.0 * f.rms_m; }),
                   course("time, ms", frames, 0, [](const FrameRecord& f) { return f.processing_ms; }),
               });
}

}  // namespace

void addInspect(CLI::App& program) {
  auto target = std::make_shared<InspectTarget>();
  CLI::App* command = program.add_subcommand("inspect", "Say what a session holds; reads, never writes");
  command->add_option("SESSION", target->session, "a session (*.saccade)")->required();
  command->add_flag("--json", target->json, "print JSON, as docs/inspect-json.md describes it");
  addInspectObjects(*command, target);
  addInspectMap(*command, target);
  addInspectTimeline(*command, target);
  command->require_subcommand(0, 1);
  command->footer(
      "Examples:\n"
      "  saccade inspect my.saccade\n"
      "  saccade inspect my.saccade query 0.2 -0.1 1.5    what is there, and when it was attended\n"
      "  saccade inspect my.saccade slice --z 1.2 -o cut.png\n"
      "  saccade inspect my.saccade objects --json");
  command->callback([target, command] {
    if (!command->get_subcommands().empty()) return;  // the question was answered
    const SessionReader session(target->session);
    const SessionSnapshot still(session);
    const std::vector<FrameRecord> frames = session.frames();
    const SessionSummary summary = summarise(session, frames);
    target->json ? printJson(summary) : printText(summary, frames, target->session);
  });
}

}  // namespace saccade::app
