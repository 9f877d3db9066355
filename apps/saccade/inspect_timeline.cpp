#include <iostream>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "inspect.hpp"
#include "saccade/inspection/timeline.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_snapshot.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

using Json = nlohmann::ordered_json;

void printJson(const std::vector<TimelineEntry>& timeline) {
  Json frames = Json::array();
  for (const TimelineEntry& entry : timeline) {
    const FrameRecord& frame = entry.frame;
    frames.push_back({{"ordinal", frame.ordinal.value},
                      {"frame", frame.index.value},
                      {"name", frame.name},
                      {"stamp_s", frame.stamp_s},
                      {"tracking", frame.tracking},
                      {"tick", frame.tick},
                      {"open", frame.open},
                      {"inhibited", frame.inhibited},
                      {"attended", frame.attended},
                      {"revisits", entry.revisits},
                      {"flags_on", entry.flags_on},
                      {"turned_free", entry.forgotten},
                      {"inlier_share", frame.inlier_share},
                      {"rms_m", frame.rms_m},
                      {"processing_ms", frame.processing_ms}});
  }
  std::cout << Json({{"schema", kInspectSchema}, {"frames", frames}}).dump(2) << "\n";
}

void printText(const std::vector<TimelineEntry>& timeline) {
  std::vector<std::vector<std::string>> rows = {
      {"frame", "tracking", "tick", "open", "inhibited", "attended", "revisits", "flags on", "turned free", "ms"}};
  for (const TimelineEntry& entry : timeline) {
    const FrameRecord& frame = entry.frame;
    rows.push_back({frame.name, frame.tracking, std::to_string(frame.tick), std::to_string(frame.open),
                    std::to_string(frame.inhibited), std::to_string(frame.attended), std::to_string(entry.revisits),
                    grouped(entry.flags_on), grouped(entry.forgotten), fixed(frame.processing_ms, 1)});
  }
  std::cout << alignedTable(rows);
}

}  // namespace

void addInspectTimeline(CLI::App& inspect, const std::shared_ptr<InspectTarget>& target) {
  CLI::App* timeline =
      inspect.add_subcommand("timeline", "frame by frame: tracking, candidates, looks, revisits, flags");
  timeline->fallthrough();
  timeline->callback([target] {
    const SessionReader session(target->session);
    const SessionSnapshot still(session);
    const std::vector<TimelineEntry> entries = timelineOf(session, loadAttendLog(session));
    target->json ? printJson(entries) : printText(entries);
  });
}

}  // namespace saccade::app
