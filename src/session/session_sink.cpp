#include "saccade/session/session_sink.hpp"

#include <utility>

#include "saccade/core/config_file.hpp"
#include "saccade/discovery/candidate_json.hpp"
#include "saccade/map/map_tiles.hpp"
#include "session/map_blobs.hpp"

namespace saccade {
namespace {

FrameRecord recordOf(const FrameReport& report) {
  FrameRecord record;
  record.index = report.index;
  record.name = report.name;
  record.stamp_s = report.stamp_s;
  record.tracking = nameOf(report.tracking.status);
  record.T_WC = report.T_WC();
  record.inlier_share = report.tracking.inlier_share;
  record.rms_m = report.tracking.rms_m;
  record.tick = report.tick.value;
  record.open = static_cast<int>(report.open.size());
  record.inhibited = static_cast<int>(report.inhibited.size());
  record.attended = static_cast<int>(report.attended);
  record.processing_ms = report.total_ms;
  return record;
}

CandidateRecord recordOf(const FrameReport& report, FrameOrdinal ordinal, std::size_t rank,
                         const CandidateOutliner& outliner) {
  const Candidate& candidate = report.open[rank];
  CandidateRecord record;
  record.frame = ordinal;
  record.rank = static_cast<int>(rank);
  record.score = candidate.score;
  record.source = sourceName(candidate.source);
  CandidateOutline outline = outliner.outline(candidate);
  record.box = outline.box;
  record.mask_rle = std::move(outline.mask);
  if (report.depth != nullptr && report.T_WC()) {
    if (const auto box = candidateBox(candidate, *report.seen, *report.depth, *report.T_WC())) {
      record.box3d_m = {box->min().x(), box->min().y(), box->min().z(), box->max().x(), box->max().y(), box->max().z()};
    }
  }
  record.features.assign(candidate.features.begin(), candidate.features.end());
  if (rank < report.revisited_share.size()) record.revisited_share = report.revisited_share[rank];
  return record;
}

}  // namespace

SessionSink::SessionSink(const std::filesystem::path& path, WhenSessionExists when_exists, const Explorer& explorer,
                         CandidateOutliner outliner, RunRecord run)
    : explorer_(explorer), writer_(path, when_exists), outliner_(std::move(outliner)) {
  writer_.addRun(run);
  metadata_.saccade_version = std::move(run.saccade_version);
  metadata_.created_utc = std::move(run.started_utc);
  metadata_.input = std::move(run.input);
  metadata_.input_kind = std::move(run.input_kind);
}

void SessionSink::accept(const RgbdFrame& /*frame*/, const FrameReport& report) {
  ++metadata_.frames_read;
  const FrameOrdinal ordinal = writer_.addFrame(recordOf(report));
  MetricsRecord metrics;
  metrics.ordinal = ordinal;
  for (const StageTime& stage : report.stages) metrics.stages_ms.emplace_back(stage.stage, stage.ms);
  writer_.addMetrics(metrics);
  outliner_.begin(*report.seen);
  for (std::size_t rank = 0; rank < report.attended; ++rank) {
    writer_.addCandidate(recordOf(report, ordinal, rank, outliner_));
  }
}

void SessionSink::finish() {
  for (const NodeKey& root : listTiles(explorer_.map())) {
    writer_.addBlob(BlobTable::kTiles, {tileKey(root), 1, bytesOf(encodeTile(explorer_.map(), root))});
  }
  const SurfaceVolume& surface = explorer_.surface();
  for (std::size_t i = 0; i < surface.bricks().size(); ++i) {
    writer_.addBlob(BlobTable::kBricks, {brickKey(surface.bricks()[i]), 1, bytesOf(surface.brick(i))});
  }
  const AttendLog& log = explorer_.attendLog();
  for (std::size_t i = 0; i < log.tickCount(); ++i) {
    writer_.addBlob(BlobTable::kAttendLog, {log.tick(i).tick.value, log.candidateCount(i), encodeTick(log, i)});
  }
  ExplorerConfig config = explorer_.config();
  metadata_.config_yaml = printConfig(describing(config), false);
  metadata_.camera = explorer_.camera();
  metadata_.leaf_size_m = config.map.leaf_size_m;
  metadata_.tick = explorer_.map().now().value;
  metadata_.leaves = static_cast<std::int64_t>(explorer_.map().leafCount());
  writer_.finish(metadata_);
}

}  // namespace saccade
