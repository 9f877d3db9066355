#include "saccade/exchange/session_merge.hpp"

#include <algorithm>
#include <vector>

#include "saccade/core/config_file.hpp"
#include "saccade/exchange/surface_merge.hpp"
#include "saccade/map/map_tiles.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/version.hpp"
#include "session/map_blobs.hpp"

namespace saccade {
namespace {

/// One of the sessions with where it goes in the merged one.
struct Part {
  const SessionReader& session;
  Pose T_CS = Pose::Identity();   ///< from its world frame to the merged one
  std::uint32_t tick_offset = 0;  ///< added to its ticks
};

std::vector<LeafKey> movedLeaves(const std::vector<LeafKey>& leaves, const IorMap& from, const IorMap& to,
                                 const Pose& T_TF) {
  std::vector<LeafKey> moved;
  moved.reserve(leaves.size());
  for (const LeafKey& leaf : leaves) {
    if (const auto key = to.keyAt(T_TF * from.centre(leaf))) moved.push_back(*key);
  }
  return moved;
}

/// Adds a session's log, ticks and leaves as the merged session counts them.
void appendLog(const Part& part, const IorMap& map, const IorMap& merged, AttendLog& log) {
  const AttendLog own = loadAttendLog(part.session);
  const auto move = [&](const std::vector<LeafKey>& leaves) { return movedLeaves(leaves, map, merged, part.T_CS); };
  for (std::size_t i = 0; i < own.tickCount(); ++i) {
    TickEvents events = own.tick(i);
    events.tick.value += part.tick_offset;
    events.flags_on = move(events.flags_on);
    events.forgotten = move(events.forgotten);
    std::vector<std::vector<LeafKey>> leaves;
    std::vector<CandidateLeaves> candidates;
    for (std::size_t c = 0; c < own.candidateCount(i); ++c) leaves.push_back(move(own.leaves(i, c)));
    for (std::size_t c = 0; c < leaves.size(); ++c) candidates.push_back({own.rank(i, c), leaves[c]});
    log.record(events, candidates);
  }
}

/// Runs, frames, candidates, metrics and keyframes in their order; poses are taken to the merged frame.
void appendFrames(const Part& part, SessionWriter& writer, SessionMergeReport& report) {
  const std::vector<RunRecord> runs = part.session.runs();
  const std::vector<MetricsRecord> metrics = part.session.metrics();
  auto run = runs.begin();
  auto metric = metrics.begin();
  for (FrameRecord frame : part.session.frames()) {
    for (; run != runs.end() && run->first <= frame.ordinal; ++run) writer.addRun(*run);
    const FrameOrdinal own = frame.ordinal;
    if (frame.T_WC) frame.T_WC = part.T_CS * *frame.T_WC;
    frame.tick += part.tick_offset;
    const FrameOrdinal ordinal = writer.addFrame(frame);
    ++report.frames;
    while (metric != metrics.end() && metric->ordinal < own) ++metric;
    if (metric != metrics.end() && metric->ordinal == own) writer.addMetrics({ordinal, metric->stages_ms});
    for (CandidateRecord candidate : part.session.candidates(own)) {
      candidate.frame = ordinal;
      const auto& box = candidate.box3d_m;
      const bool has_box = std::any_of(box.begin(), box.end(), [](double c) { return c != 0.0; });
      if (has_box) {
        Eigen::AlignedBox3d moved(Eigen::Vector3d(box[0], box[1], box[2]), Eigen::Vector3d(box[3], box[4], box[5]));
        moved = moved.transformed(part.T_CS);
        candidate.box3d_m = {moved.min().x(), moved.min().y(), moved.min().z(),
                             moved.max().x(), moved.max().y(), moved.max().z()};
      }
      writer.addCandidate(candidate);
    }
    if (auto keyframe = part.session.keyframe(own)) {
      keyframe->ordinal = ordinal;
      keyframe->T_WC = part.T_CS * keyframe->T_WC;
      writer.addKeyframe(*keyframe);
      ++report.keyframes;
    }
  }
  for (; run != runs.end(); ++run) writer.addRun(*run);  // those without frames
}

bool isSameFrame(const Pose& T_AB, const IorMap& a, const IorMap& b) {
  return T_AB.isApprox(Pose::Identity(), 0.0) && a.config().leaf_size_m == b.config().leaf_size_m;
}

}  // namespace

SessionMergeReport mergeSessions(const SessionReader& a, const SessionReader& b, const Pose& T_AB,
                                 const std::filesystem::path& path, WhenSessionExists when_exists,
                                 const std::string& created_utc) {
  SessionMergeReport report;
  SessionWriter writer(path, when_exists);
  const IorMap map_a = loadMap(a), map_b = loadMap(b);
  const IorMap merged = isSameFrame(T_AB, map_a, map_b)
                            ? mergeMaps(map_a, map_b, &report.map)
                            : mergeMaps(map_a, resampleMap(map_b, T_AB, map_a.config()), &report.map);
  SurfaceVolume surface = loadSurface(a);
  mergeSurface(loadSurface(b), T_AB, surface);

  const Part parts[] = {{a, Pose::Identity(), 0}, {b, T_AB, map_a.now().value}};
  AttendLog log;
  appendLog(parts[0], map_a, merged, log);
  appendLog(parts[1], map_b, merged, log);
  for (const Part& part : parts) appendFrames(part, writer, report);

  for (const NodeKey& root : listTiles(merged)) {
    writer.putBlob(BlobTable::kTiles, {tileKey(root), 1, bytesOf(encodeTile(merged, root))});
  }
  for (std::size_t i = 0; i < surface.bricks().size(); ++i) {
    writer.putBlob(BlobTable::kBricks, {brickKey(surface.bricks()[i]), 1, bytesOf(surface.brick(i))});
  }
  for (std::size_t i = 0; i < log.tickCount(); ++i) {
    writer.putBlob(BlobTable::kAttendLog, {log.tick(i).tick.value, log.candidateCount(i), encodeTick(log, i)});
  }
  SessionMetadata metadata = a.metadata();
  metadata.saccade_version = kVersion;
  metadata.created_utc = created_utc;
  metadata.input = a.metadata().input + " + " + b.metadata().input;
  metadata.input_kind = "merged sessions";
  if (metadata.camera.width == 0) metadata.camera = b.metadata().camera;
  metadata.tick = merged.now().value;
  metadata.leaves = static_cast<std::int64_t>(merged.leafCount());
  metadata.frames_read += b.metadata().frames_read;
  metadata.frames_skipped += b.metadata().frames_skipped;
  writer.finish(metadata);
  report.leaves = metadata.leaves;
  report.bricks = static_cast<std::int64_t>(surface.bricks().size());
  report.tick = metadata.tick;
  return report;
}

}  // namespace saccade
