#include "saccade/session/session_sink.hpp"

#include <span>
#include <utility>

#include "saccade/core/config_file.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/discovery/candidate_box.hpp"
#include "saccade/discovery/candidate_json.hpp"
#include "saccade/session/session_map.hpp"
#include "session/checkpoint.hpp"
#include "session/map_snapshot.hpp"
#include "session/motion_state.hpp"
#include "session/reference_state.hpp"
#include "session/session_pager.hpp"

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
      const Eigen::Vector3d low = box->min().cast<double>(), high = box->max().cast<double>();
      record.box3d_m = {low.x(), low.y(), low.z(), high.x(), high.y(), high.z()};
    }
  }
  record.features.assign(candidate.features.begin(), candidate.features.end());
  if (rank < report.revisited_share.size()) record.revisited_share = report.revisited_share[rank];
  return record;
}

}  // namespace

SessionSink::SessionSink(std::unique_ptr<SessionWriter> writer, Explorer& explorer, CandidateOutliner outliner,
                         const RunRecord& run, const SessionMetadata* before, double checkpoint_interval_s)
    : explorer_(explorer),
      path_(writer->path()),
      going_on_(before != nullptr),
      outliner_(std::move(outliner)),
      interval_(checkpoint_interval_s),
      last_checkpoint_(std::chrono::steady_clock::now()),
      next_ordinal_(writer->nextOrdinal().value),
      changes_(std::make_unique<MapChanges>(before != nullptr ? MapChanges::noneIn(explorer) : MapChanges())),
      checkpoint_(std::make_unique<Checkpoint>()) {
  if (before != nullptr) metadata_ = *before;
  if (before == nullptr) metadata_.created_utc = run.started_utc;
  metadata_.saccade_version = run.saccade_version;
  metadata_.input = run.input;
  metadata_.input_kind = run.input_kind;
  metadata_.state = SessionState::kComplete;
  ExplorerConfig config = explorer.config();
  metadata_.config_yaml = printConfig(describing(config), false);
  metadata_.camera = explorer.camera();
  metadata_.leaf_size_m = config.map.leaf_size_m;
  writer->addRun(run);
  thread_ = std::make_unique<CheckpointThread>(std::move(writer));
}

SessionSink::~SessionSink() = default;

void SessionSink::accept(const RgbdFrame& frame, const FrameReport& report) {
  ++metadata_.frames_read;
  const FrameOrdinal ordinal{next_ordinal_++};
  checkpoint_->frames.push_back(recordOf(report));
  MetricsRecord metrics;
  metrics.ordinal = ordinal;
  for (const StageTime& stage : report.stages) metrics.stages_ms.emplace_back(stage.stage, stage.ms);
  checkpoint_->metrics.push_back(std::move(metrics));
  outliner_.begin(*report.seen, std::span(report.open).first(report.attended));
  for (std::size_t rank = 0; rank < report.attended; ++rank) {
    checkpoint_->candidates.push_back(recordOf(report, ordinal, rank, outliner_));
  }
  if (report.keyframe) {
    checkpoint_->keyframes.push_back({ordinal, report.keyframe->T_WC, frame.color.clone(), frame.depth_m.clone(),
                                      encodeFeatures(report.keyframe->features)});
  }
  changes_->takeTicks(explorer_, checkpoint_->map);  // a little with every frame instead of much with a checkpoint
  const bool crowded = pager_ != nullptr && pager_->crowded() && makeRoom();
  const auto now = std::chrono::steady_clock::now();
  if (!thread_->idle() || (!crowded && now - last_checkpoint_ < interval_)) return;
  last_checkpoint_ = now;
  fill();
  const std::chrono::duration<double, std::milli> taken = std::chrono::steady_clock::now() - now;
  checkpoint_->metrics.back().stages_ms.emplace_back("checkpoint", taken.count());
  thread_->write(checkpoint_);
}

/// Drops from memory what the session holds; whether a checkpoint would let more be dropped that is needed.
bool SessionSink::makeRoom() {
  // A checkpoint in work is waited for: until it is durable, nothing that it found may be dropped.
  thread_->waitUntilIdle();
  const bool unsaved = pager_->drop(*changes_);
  return unsaved && pager_->crowded();
}

void SessionSink::limitMemory(std::size_t bytes) {
  pager_ = std::make_unique<SessionPager>(explorer_, path_, bytes);
  if (going_on_ && std::as_const(explorer_).surface().empty()) {
    const SessionReader session(path_);
    pager_->startFrom(session);
    *changes_ = MapChanges::noneIn(explorer_, session);
  }
}

void SessionSink::limitSize(std::uint64_t bytes) {
  thread_->limitSize(bytes);
}

bool SessionSink::full() {
  return thread_->full();
}

PagingReport SessionSink::paging() const {
  if (pager_ == nullptr) return {};
  const SessionPager::Statistics& done = pager_->statistics();
  return {done.dropped, done.returned, std::max(done.most_bytes, pager_->bytes())};
}

/// Copies what changed in the explorer since the last checkpoint and is not copied yet.
void SessionSink::fill() {
  if (thread_->idle()) thread_->lendRoom(checkpoint_->map);
  changes_->take(explorer_, checkpoint_->map, pager_.get());
  checkpoint_->state[kMotionState] = encodeMotion(explorer_.motion());
  const PhotometricReference& reference = explorer_.photometricReference();
  if (reference.changes() != saved_reference_) {
    checkpoint_->state[kReferenceState] = encodeReference(reference.state());
    saved_reference_ = reference.changes();
  }
  metadata_.tick = explorer_.map().now().value;
  metadata_.leaves = changes_->leaves();
  checkpoint_->metadata = metadata_;
}

void SessionSink::finish() {
  fill();
  if (pager_ != nullptr) pager_->close();  // a reader that stays would keep the session in two files
  thread_->finish(std::move(checkpoint_));
}

namespace {

ExplorerMemory loadMemory(const SessionReader& session, const MapRegion& region) {
  const std::optional<std::string> motion = session.state(kMotionState);
  if (!motion) throw IoError(session.path(), "the state of a tracked exploration to go on with", "none");
  const std::optional<std::string> reference = session.state(kReferenceState);
  return {loadMap(session, region),
          loadSurface(session, region),
          loadAttendedLeaves(session),
          decodeMotion(*motion, session.path()),
          reference ? std::optional(decodeReference(*reference, session.path())) : std::nullopt,
          loadKeyframes(session)};
}

}  // namespace

ExplorerMemory loadMemory(const SessionReader& session) {
  return loadMemory(session, MapRegion::everything());
}

ExplorerMemory loadMemoryWithoutMap(const SessionReader& session) {
  return loadMemory(session, MapRegion::nothing());
}

}  // namespace saccade
