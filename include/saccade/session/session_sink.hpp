#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>

#include "saccade/discovery/candidate_outline.hpp"
#include "saccade/pipeline/explorer.hpp"
#include "saccade/pipeline/frame_sink.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_writer.hpp"

namespace saccade {

struct Checkpoint;
class CheckpointThread;
class MapChanges;
class SessionPager;

/// Time between two checkpoints unless said otherwise: what `kill -9` can cost.
inline constexpr double kCheckpointInterval_s = 5.0;

/// What paging did, see SessionSink::limitMemory().
struct PagingReport {
  std::int64_t dropped = 0;    ///< tiles and bricks
  std::int64_t returned = 0;   ///< of these, read again
  std::size_t most_bytes = 0;  ///< of map and surface volume in memory
};

/// Keeps an exploration as a session file: rows of frames, candidates and keyframes, and of the map, the surface volume
/// and the attend log what changed, checkpoint by checkpoint.
///
/// The frame thread only copies what changed; compressing and writing happen on a thread of its own. A checkpoint that
/// is due while the last one is still being written waits for it. What cannot be written is thrown by the next accept()
/// or by finish(); the session then is what the last checkpoint left.
class SessionSink final : public FrameSink {
 public:
  /// `explorer` must outlive the sink, `outliner`: that of the input's camera and lens, `run`: where the frames come
  /// from. For a session to go on with, `before` is its metadata and `explorer` holds all that is in it (loadMemory());
  /// or all but the map (loadMemoryWithoutMap()), if limitMemory() comes next.
  SessionSink(std::unique_ptr<SessionWriter> writer, Explorer& explorer, CandidateOutliner outliner,
              const RunRecord& run, const SessionMetadata* before = nullptr,
              double checkpoint_interval_s = kCheckpointInterval_s);
  ~SessionSink() override;

  void accept(const RgbdFrame& frame, const FrameReport& report) override;
  /// The last checkpoint, which ends the session.
  void finish() override;

  /// From now on map and surface volume take at most about `bytes` of memory: what the session holds already and the
  /// camera is far from is dropped, and comes back when the camera does. What a look touches stays, whatever it takes.
  void limitMemory(std::size_t bytes);
  [[nodiscard]] PagingReport paging() const;

  /// As SessionWriter::limitSize(); when full(), the exploration has to end.
  void limitSize(std::uint64_t bytes);
  [[nodiscard]] bool full();

  /// Counts a frame of the input that could not be used.
  void noteSkipped() { ++metadata_.frames_skipped; }
  /// Frames are every `step`th of the input.
  void noteRangeStep(std::int64_t step) { metadata_.range_step = step; }
  /// The exploration ends by hand rather than by the end of the input.
  void noteInterrupted() { metadata_.state = SessionState::kInterrupted; }

 private:
  void fill();
  [[nodiscard]] bool makeRoom();

  Explorer& explorer_;
  std::filesystem::path path_;
  bool going_on_;
  CandidateOutliner outliner_;
  SessionMetadata metadata_;
  std::chrono::duration<double> interval_;
  std::chrono::steady_clock::time_point last_checkpoint_;
  std::int64_t next_ordinal_ = 0;
  std::unique_ptr<MapChanges> changes_;
  std::size_t saved_reference_ = 0;  ///< changes of the photometric reference up to the last checkpoint
  std::unique_ptr<Checkpoint> checkpoint_;
  std::unique_ptr<SessionPager> pager_;
  std::unique_ptr<CheckpointThread> thread_;
};

/// All that an explorer has to know to go on with a session (Explorer::restore) as if it had never stopped. Throws
/// IoError if the session is damaged, or was not made by exploring.
[[nodiscard]] ExplorerMemory loadMemory(const SessionReader& session);
/// The same with an empty map at the session's tick and an empty surface volume, for SessionSink::limitMemory().
[[nodiscard]] ExplorerMemory loadMemoryWithoutMap(const SessionReader& session);

}  // namespace saccade
