#include "saccade/session/session_repair.hpp"

#include <functional>
#include <limits>
#include <optional>
#include <set>

#include "saccade/core/errors.hpp"
#include "saccade/map/map_tiles.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_snapshot.hpp"
#include "saccade/session/session_writer.hpp"
#include "session/blob_table_name.hpp"
#include "session/map_blobs.hpp"
#include "session/motion_state.hpp"
#include "session/part_tables.hpp"
#include "session/readable_keys.hpp"
#include "session/reference_state.hpp"

namespace saccade {
namespace {

/// Goes through a session row by row, complains of what is damaged, and copies the rest if there is a copy.
class SessionSurvey {
 public:
  SessionSurvey(const SessionReader& session, SessionWriter* copy) : session_(session), copy_(copy) {}

  SessionFindings run() {
    checkStructure();
    surveySettings();
    surveyFrames();
    surveyCandidates();
    surveyKeyframes();
    surveyTiles();
    surveyBricks();
    surveyAttendLog();
    surveyState();
    surveyParts();
    return std::move(findings_);
  }

  /// Of the whole rows: what a repaired session says about itself.
  [[nodiscard]] SessionMetadata metadata() const {
    SessionMetadata metadata = session_.metadata();
    metadata.leaves = leaves_;
    if (metadata.state == SessionState::kExploring) metadata.state = SessionState::kInterrupted;
    return metadata;
  }

 private:
  void complain(const std::string& complaint) {
    if (findings_.complaints.size() < SessionFindings::kLargestCount) {
      findings_.complaints.push_back(complaint);
    } else {
      ++findings_.more_complaints;
    }
  }

  /// Calls `visit` with every key of the table; an IoError from it is a complaint and a damaged row.
  void surveyTable(const std::string& table, const std::string& column,
                   const std::function<void(std::int64_t)>& visit) {
    TableFindings found{table};
    const ReadableKeys keys = readableKeys(session_.database(), table, column);
    if (!keys.complete) {
      complain(IoError(session_.path(), "a whole table " + table, "pages that cannot be read").what());
      ++found.damaged;
    }
    for (const std::int64_t key : keys.keys) {
      try {
        visit(key);
        ++found.whole;
      } catch (const IoError& error) {
        complain(error.what());
        ++found.damaged;
      }
    }
    findings_.tables.push_back(found);
  }

  void require(bool sound, const std::string& expected, const std::string& found) const {
    if (!sound) throw IoError(session_.path(), expected, found);
  }

  void checkStructure() {
    try {
      SQLite::Statement query(session_.database().sqlite(), "PRAGMA integrity_check(20)");
      while (query.executeStep()) {
        const std::string answer = query.getColumn(0).getString();
        if (answer != "ok") complain(IoError(session_.path(), "a sound SQLite file", answer).what());
      }
    } catch (const SQLite::Exception& error) {
      complain(IoError(session_.path(), "a sound SQLite file", error.what()).what());
    }
  }

  void surveySettings() {
    try {
      (void)loadConfig(session_);
    } catch (const IoError& error) {
      complain(error.what());
    }
  }

  void surveyFrames() {
    std::vector<RunRecord> runs;
    try {
      runs = session_.runs();
    } catch (const IoError& error) {
      complain(error.what());
    }
    std::size_t next_run = 0;
    const auto beginRuns = [&](std::int64_t before) {
      for (; next_run < runs.size() && runs[next_run].first.value <= before; ++next_run) {
        if (copy_ != nullptr) copy_->addRun(runs[next_run]);
      }
    };
    std::uint32_t last_tick = 0;
    surveyTable("frames", "ordinal", [&](std::int64_t ordinal) {
      const std::optional<FrameRecord> frame = session_.frame({ordinal});
      require(frame.has_value(), "frame " + std::to_string(ordinal), "none");
      require(frame->tracking == "tracked" || frame->tracking == "weak" || frame->tracking == "lost",
              "how frame " + std::to_string(ordinal) + " was tracked", "\"" + frame->tracking + "\"");
      require(frame->tick >= last_tick, "rising ticks, of at least " + std::to_string(last_tick),
              std::to_string(frame->tick) + " at frame " + std::to_string(ordinal));
      last_tick = frame->tick;
      beginRuns(ordinal);
      frames_.insert(ordinal);
      if (copy_ != nullptr) copy_->addFrame(*frame);
    });
    beginRuns(std::numeric_limits<std::int64_t>::max());
    for (const MetricsRecord& metrics : readMetrics()) {
      if (copy_ != nullptr && frames_.count(metrics.ordinal.value) != 0) copy_->addMetrics(metrics);
    }
    if (!frames_.empty() && last_tick != session_.metadata().tick) {
      complain(IoError(session_.path(), "frames up to tick " + std::to_string(session_.metadata().tick),
                       "tick " + std::to_string(last_tick))
                   .what());
    }
  }

  std::vector<MetricsRecord> readMetrics() {
    try {
      return session_.metrics();
    } catch (const IoError& error) {
      complain(error.what());
      return {};
    }
  }

  void requireFrame(std::int64_t ordinal, const std::string& what) const {
    require(frames_.count(ordinal) != 0, "the frame of " + what, "none of ordinal " + std::to_string(ordinal));
  }

  void surveyCandidates() {
    TableFindings found{"candidates"};
    for (const std::int64_t ordinal : frames_) {
      try {
        const std::vector<CandidateRecord> candidates = session_.candidates({ordinal});
        found.whole += static_cast<std::int64_t>(candidates.size());
        for (const CandidateRecord& candidate : candidates) {
          if (copy_ != nullptr) copy_->addCandidate(candidate);
        }
      } catch (const IoError& error) {
        complain(error.what());
        ++found.damaged;
      }
    }
    std::int64_t orphans = 0;
    try {
      orphans = session_.candidateCount() - found.whole;
    } catch (const IoError&) {
      orphans = 0;  // complained of above
    }
    if (orphans > 0 && found.damaged == 0) {
      complain(
          IoError(session_.path(), "a frame for each candidate", std::to_string(orphans) + " candidates without one")
              .what());
      found.damaged += orphans;
    }
    findings_.tables.push_back(found);
  }

  void surveyKeyframes() {
    surveyTable("keyframes", "ordinal", [&](std::int64_t ordinal) {
      const std::optional<KeyframeRecord> keyframe = session_.keyframe({ordinal});
      require(keyframe.has_value(), "keyframe " + std::to_string(ordinal), "none");
      requireFrame(ordinal, "keyframe " + std::to_string(ordinal));
      if (copy_ != nullptr) copy_->addKeyframe(*keyframe);
    });
  }

  /// The blob of a key that is known to be there.
  BlobRecord blobOf(BlobTable table, std::int64_t key) {
    std::optional<BlobRecord> blob = session_.blob(table, static_cast<std::uint64_t>(key));
    require(blob.has_value(), "part " + std::to_string(key) + " of table " + nameOf(table), "none");
    return *std::move(blob);
  }

  void surveyTiles() {
    std::set<NodeKey> kept;
    surveyTable("tiles", "key", [&](std::int64_t key) {
      BlobRecord blob = blobOf(BlobTable::kTiles, key);
      const auto* bytes = reinterpret_cast<const std::byte*>(blob.bytes.data());
      const MapTile tile{tileRoot(blob.key), {bytes, bytes + blob.bytes.size()}};
      blob.items = checkTile(tile, session_.path());
      require(isApart(tile.root, kept), "tiles that do not overlap", "tile " + std::to_string(key) + " over another");
      kept.insert(tile.root);
      leaves_ += static_cast<std::int64_t>(blob.items);
      if (copy_ != nullptr) copy_->putBlob(BlobTable::kTiles, blob);
    });
  }

  /// Whether no tile of `kept` holds `root`. Keys rise with the depth, so larger tiles come first.
  static bool isApart(const NodeKey& root, const std::set<NodeKey>& kept) {
    for (int depth = 0; depth < root.depth; ++depth) {
      const int bits = MapTree::kDepth - depth;
      const auto corner = [bits](std::uint16_t k) {
        return static_cast<std::uint16_t>(static_cast<unsigned>(k) >> bits << bits);
      };
      if (kept.count({{corner(root.corner.x), corner(root.corner.y), corner(root.corner.z)}, depth}) != 0) return false;
    }
    return true;
  }

  void surveyBricks() {
    surveyTable("bricks", "key", [&](std::int64_t key) {
      const BlobRecord blob = blobOf(BlobTable::kBricks, key);
      (void)brickFromBytes(blob.bytes, session_.path());
      if (copy_ != nullptr) copy_->putBlob(BlobTable::kBricks, blob);
    });
  }

  void surveyAttendLog() {
    surveyTable("attend_log", "key", [&](std::int64_t key) {
      const BlobRecord blob = blobOf(BlobTable::kAttendLog, key);
      require(blob.key < session_.metadata().tick, "ticks before " + std::to_string(session_.metadata().tick),
              "tick " + std::to_string(blob.key) + " in the attend log");
      (void)decodeTick(blob.bytes, Tick{static_cast<std::uint32_t>(blob.key)}, session_.path());
      if (copy_ != nullptr) copy_->putBlob(BlobTable::kAttendLog, blob);
    });
  }

  void surveyState() {
    try {
      for (const std::string& name : session_.stateNames()) {
        const std::optional<std::string> bytes = session_.state(name);
        if (name == kMotionState && bytes) (void)decodeMotion(*bytes, session_.path());
        if (name == kReferenceState && bytes) (void)decodeReference(*bytes, session_.path());
        if (copy_ != nullptr && bytes) copy_->putState(name, *bytes);
      }
    } catch (const IoError& error) {
      complain(error.what());
    }
  }

  void surveyParts() {
    try {
      visitPartTables(session_.database(), copy_ != nullptr ? &copy_->database() : nullptr);
    } catch (const IoError& error) {
      complain(error.what());
    }
  }

  const SessionReader& session_;
  SessionWriter* copy_;
  SessionFindings findings_;
  std::set<std::int64_t> frames_;  // ordinals of the whole ones
  std::int64_t leaves_ = 0;
};

}  // namespace

SessionFindings verifySession(const std::filesystem::path& path) {
  const SessionReader session(path);
  const SessionSnapshot still(session);
  return SessionSurvey(session, nullptr).run();
}

SessionFindings repairSession(const std::filesystem::path& damaged, const std::filesystem::path& repaired) {
  const SessionReader session(damaged);
  const SessionSnapshot still(session);
  SessionWriter copy(repaired, WhenSessionExists::kRefuse);
  SessionSurvey survey(session, &copy);
  SessionFindings findings = survey.run();
  copy.finish(survey.metadata());
  return findings;
}

}  // namespace saccade
