#include <cmath>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "commands.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/objects/object_table.hpp"
#include "saccade/pipeline/candidate_sink.hpp"
#include "saccade/pipeline/placement.hpp"
#include "saccade/pipeline/trajectory_sink.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_sink.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/sources/read_ahead.hpp"
#include "session_run.hpp"
#include "source_talk.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string session, input, apart, trajectory, candidates, range;
  std::vector<double> pose;
  int limit = 300;
  int threads = 0;
  double map_memory_MiB = 0.0;
};

/// Frames seen before a place is known, the last ones; the oldest give way.
constexpr std::size_t kKeptFrames = 100;

struct Counts {
  std::int64_t frames = 0, tracked = 0, weak = 0, lost = 0, relocalised = 0, skipped = 0;

  void add(const FrameReport& report) {
    ++frames;
    if (report.relocalised) ++relocalised;
    (report.tracking.status == TrackingStatus::kTracked ? tracked
     : report.tracking.status == TrackingStatus::kWeak  ? weak
                                                        : lost) += 1;
  }
};

std::string absolute(const std::string& path) {
  return std::filesystem::absolute(path).lexically_normal().string();
}

/// Where the new part is kept if it finds no place in the session.
std::string pathApart(const Options& options) {
  if (!options.apart.empty()) return options.apart;
  std::filesystem::path path(options.session);
  path.replace_filename(path.stem().string() + "-apart" + path.extension().string());
  return path.string();
}

/// Reads frames and says why some are skipped.
class Frames {
 public:
  Frames(const std::string& input, const FrameRange& range) : source_(openSource(input, range)) {
    sayWhatWasUnderstood(source_.description());
  }

  [[nodiscard]] const SourceDescription& description() const { return source_.description(); }

  /// The next usable frame; none at the end or when the user ends the run.
  bool next(RgbdFrame& frame, Counts& counts) {
    while (!interrupted()) {
      const ReadStatus status = source_.read(frame);
      if (status == ReadStatus::kEnd) return false;
      if (status == ReadStatus::kFrame) return true;
      ++counts.skipped;
      std::cerr << "skipped: " << source_.skipReason() << "\n";
    }
    return false;
  }

 private:
  ReadAhead source_;
};

/// Explores on, from the frames in `first` and then from `frames`, and keeps it all by `sink` and the files asked for.
void explore(const Options& options, Explorer& explorer, std::unique_ptr<SessionSink> sink, std::deque<RgbdFrame> first,
             Frames& frames, Counts& counts) {
  const SourceDescription& description = frames.description();
  const CandidateOutliner outliner(DistortedPixels(description.camera, description.color_camera));
  SessionSink* session = sink.get();
  std::vector<std::unique_ptr<FrameSink>> sinks;
  sinks.push_back(std::move(sink));
  if (!options.trajectory.empty()) sinks.push_back(std::make_unique<TrajectorySink>(options.trajectory));
  if (!options.candidates.empty()) sinks.push_back(std::make_unique<CandidateSink>(options.candidates, outliner));
  ProgressLine progress(description.frames);
  const auto process = [&](const RgbdFrame& frame) {
    const FrameReport report = explorer.process(frame);
    counts.add(report);
    for (const auto& each : sinks) each->accept(frame, report);
    progress.show(counts.frames, nameOf(report.tracking.status));
  };
  for (; !first.empty(); first.pop_front()) process(first.front());
  RgbdFrame frame;
  while (frames.next(frame, counts)) process(frame);
  progress.clear();
  if (interrupted()) session->noteInterrupted();
  for (const auto& each : sinks) each->finish();
  std::cerr << fmt::format("{} frames: {} tracked, {} weak, {} lost, {} skipped, {} times found again\n", counts.frames,
                           counts.tracked, counts.weak, counts.lost, counts.skipped, counts.relocalised);
  if (options.map_memory_MiB > 0.0) sayPaging(session->paging());
}

std::unique_ptr<SessionSink> makeSink(const Options& options, std::unique_ptr<SessionWriter> writer, Explorer& explorer,
                                      const SourceDescription& description, std::int64_t range_step,
                                      const SessionMetadata* before) {
  const RunRecord run = runFrom(options.input, description);
  const CandidateOutliner outliner(DistortedPixels(description.camera, description.color_camera));
  auto sink = std::make_unique<SessionSink>(std::move(writer), explorer, outliner, run, before);
  sink->noteRangeStep(range_step);
  limitMapMemory(*sink, options.map_memory_MiB);
  return sink;
}

FrameOrdinal nextOrdinal(const SessionReader& session) {
  const std::vector<FrameRecord> frames = session.frames();
  return {frames.empty() ? 0 : frames.back().ordinal.value + 1};
}

/// Opens the session for writing, which touches its file, only now that its place is certain. `next`: the ordinal that
/// came next when it was loaded; the session must not have grown since.
std::unique_ptr<SessionWriter> openUnchanged(const std::string& path, FrameOrdinal next) {
  std::unique_ptr<SessionWriter> writer = SessionWriter::open(path);
  if (writer->nextOrdinal() == next) return writer;
  throw IoError(path, "the session as it was when the search for a place began", "one that was written meanwhile");
}

RgbdFrame copyOf(const RgbdFrame& frame) {
  RgbdFrame copy = frame;
  copy.color = frame.color.clone();
  copy.depth_m = frame.depth_m.clone();
  copy.label = frame.label.clone();
  return copy;
}

/// The pose that seven numbers name, tx ty tz qx qy qz qw as in TUM files.
Pose givenPose(const std::vector<double>& numbers) {
  const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
  constexpr double kRounding = 1e-3;  // of numbers typed from a file
  if (!(std::abs(q.norm() - 1.0) < kRounding)) {
    throw std::invalid_argument("--pose expects tx ty tz qx qy qz qw with a quaternion of length 1, found length " +
                                std::to_string(q.norm()));
  }
  return Pose(Eigen::Translation3d(numbers[0], numbers[1], numbers[2]) * q.normalized());
}

void run(const Options& options) {
  std::optional<tbb::global_control> threads;
  if (options.threads > 0) {
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options.threads));
  }
  const std::string apart = pathApart(options);
  std::error_code ignored;
  if (std::filesystem::exists(apart, ignored)) {
    throw IoError(apart, "no file yet where the new part is kept if it finds no place (--apart names another)",
                  "one that exists");
  }
  auto session = std::make_unique<SessionReader>(options.session);
  const FrameRange range = options.range.empty() ? FrameRange{} : FrameRange::parse(options.range);
  Frames frames(options.input, range);
  requireCamera(*session, frames.description().camera);
  const ExplorerConfig config = loadConfig(*session);
  const SessionMetadata before = session->metadata();
  const FrameOrdinal next = nextOrdinal(*session);
  auto explorer = std::make_unique<Explorer>(config, frames.description().camera);
  explorer->restore(loadMemory(*session));
  session.reset();  // a reader that stays would keep the session in two files

  catchInterrupts();
  std::optional<Pose> guess;
  if (!options.pose.empty()) guess = givenPose(options.pose);
  Placement placement(*explorer, guess);
  Counts counts;
  std::int64_t offered = 0;
  std::deque<RgbdFrame> waiting;
  RgbdFrame frame;
  std::cerr << nameOf(placement.state()) << ": looking for the camera among " << explorer->keyframes().all().size()
            << " keyframes\n";
  while (placement.state() != PlacementState::kVerified && offered < options.limit && frames.next(frame, counts)) {
    const PlacementState last = placement.state();
    ++offered;
    waiting.push_back(copyOf(frame));
    if (waiting.size() > kKeptFrames) waiting.pop_front();
    const PlacementState state = placement.offer(frame);
    if (state != last) std::cerr << nameOf(state) << " at frame " << frame.index.value << "\n";
  }

  if (placement.state() == PlacementState::kVerified) {
    std::cerr << fmt::format("{} frames before the place was verified are dropped\n", offered - 1);
    auto sink =
        makeSink(options, openUnchanged(options.session, next), *explorer, frames.description(), range.step, &before);
    waiting.erase(waiting.begin(), waiting.end() - 1);
    explore(options, *explorer, std::move(sink), std::move(waiting), frames, counts);
    storeObjects(options.session);
    std::cerr << "resumed: " << absolute(options.session) << "\n";
    return;
  }
  if (offered == 0) throw IoError(options.input, "at least one usable frame", "none");
  const std::string reason =
      fmt::format("no place in {} was found for the first {} frames of {}", options.session, offered, options.input);
  if (interrupted()) throw std::runtime_error(reason + "; the session is as it was");
  std::cerr << reason << "; the session is as it was, the new part becomes a session of its own\n";
  explorer = std::make_unique<Explorer>(config, frames.description().camera);
  auto sink = makeSink(options, std::make_unique<SessionWriter>(apart, WhenSessionExists::kRefuse), *explorer,
                       frames.description(), range.step, nullptr);
  if (static_cast<std::size_t>(offered) > waiting.size()) {
    std::cerr << fmt::format("its first {} frames are dropped\n", static_cast<std::size_t>(offered) - waiting.size());
  }
  explore(options, *explorer, std::move(sink), std::move(waiting), frames, counts);
  storeObjects(apart);
  throw std::runtime_error(reason + "; it was explored as " + absolute(apart) + ", which saccade merge may join");
}

}  // namespace

void addResume(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "resume", "Find the camera in a session's scene and go on exploring; attention carries over");
  command->add_option("SESSION", options->session, "the session to go on with (*.saccade)")->required();
  command->add_option("INPUT", options->input, "new frames of its scene, as for explore")->required();
  command
      ->add_option("--pose", options->pose, "where the first frame was taken, tx ty tz qx qy qz qw in the session's W")
      ->expected(7);
  command->add_option("--limit", options->limit, "frames after which the search for a place is given up")
      ->check(CLI::PositiveNumber)
      ->capture_default_str();
  command->add_option("--apart", options->apart,
                      "the session that keeps the new part if it finds no place (SESSION-apart.saccade if not given)");
  addMapMemory(*command, options->map_memory_MiB, " once the place is verified; looking for it takes the whole map");
  command->add_option("--trajectory", options->trajectory, "write this run's poses in the session's W, TUM format");
  command->add_option("--candidates", options->candidates, "write the candidates, one JSON line a frame");
  command->add_option("--range", options->range, "frames A:B:STEP of the input, B excluded");
  command->add_option("--threads", options->threads, "threads to use (0: all)")->check(CLI::Range(0, 1024));
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
