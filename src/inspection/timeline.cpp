#include "saccade/inspection/timeline.hpp"

#include <unordered_map>

namespace saccade {
namespace {

constexpr double kRevisitShare = 0.5;  ///< of a candidate's leaves attended before

}  // namespace

std::vector<TimelineEntry> timelineOf(const SessionReader& session, const AttendLog& log) {
  std::unordered_map<std::uint32_t, const TickEvents*> events;
  for (std::size_t i = 0; i < log.tickCount(); ++i) events.emplace(log.tick(i).tick.value, &log.tick(i));
  std::vector<TimelineEntry> timeline;
  for (FrameRecord& frame : session.frames()) {
    TimelineEntry entry;
    for (const CandidateRecord& candidate : session.candidates(frame.ordinal)) {
      entry.revisits += candidate.revisited_share >= kRevisitShare ? 1 : 0;
    }
    // A frame closes the tick before the one that it leaves behind; a lost one closes none.
    const auto closed = frame.tracking == "lost" ? events.end() : events.find(frame.tick - 1);
    if (closed != events.end()) {
      entry.flags_on = static_cast<int>(closed->second->flags_on.size());
      entry.forgotten = static_cast<int>(closed->second->forgotten.size());
    }
    entry.frame = std::move(frame);
    timeline.push_back(std::move(entry));
  }
  return timeline;
}

}  // namespace saccade
