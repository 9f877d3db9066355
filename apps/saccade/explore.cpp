#include <chrono>
#include <filesystem>
#include <iostream>
#include <map>
#include <memory>
#include <optional>
#include <sys/resource.h>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "commands.hpp"
#include "live_view.hpp"
#include "saccade/core/config_file.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/inspection/picture_sinks.hpp"
#include "saccade/objects/object_table.hpp"
#include "saccade/pipeline/candidate_sink.hpp"
#include "saccade/pipeline/explorer.hpp"
#include "saccade/pipeline/trajectory_sink.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/session/session_sink.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/sources/given_poses.hpp"
#include "saccade/sources/read_ahead.hpp"
#include "session_run.hpp"
#include "source_talk.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

constexpr double kMiB = 1048576.0;

struct Options {
  std::string input;
  std::string session, continued, trajectory, candidates, video, frames_folder;
  bool force = false;
  std::string range, poses, config, model;
  std::vector<std::string> settings;
  bool print_config = false, no_ior = false, paper = false, view = false;
  int threads = 0;
  double map_memory_MiB = 0.0;
  double max_session_MiB = 0.0;
  double checkpoint_interval_s = kCheckpointInterval_s;
};

/// The session that is gone on with: its file, kept from other writers, and what is in it.
struct ContinuedSession {
  explicit ContinuedSession(const std::string& path) : writer(SessionWriter::open(path)), reader(path) {}

  std::unique_ptr<SessionWriter> writer;
  SessionReader reader;
};

ExplorerConfig effectiveConfig(const Options& options, const std::optional<ContinuedSession>& continued) {
  if (continued) return loadConfig(continued->reader);
  ExplorerConfig config;
  if (options.paper) config.usePaperOnly();
  if (!options.config.empty()) applyConfigFile(options.config, describing(config));
  if (options.no_ior) config.discovery.inhibition.enabled = false;
  applyConfigSettings(options.settings, describing(config));
  return config;
}

/// Sums over a run, for the table at its end.
struct RunTotals {
  std::int64_t frames = 0, skipped = 0, tracked = 0, weak = 0, lost = 0;
  double open = 0.0, inhibited = 0.0;
  std::vector<std::pair<std::string, std::vector<double>>> stage_ms;
  std::vector<double> frame_ms;

  void add(const FrameReport& report) {
    ++frames;
    (report.tracking.status == TrackingStatus::kTracked ? tracked
     : report.tracking.status == TrackingStatus::kWeak  ? weak
                                                        : lost) += 1;
    open += static_cast<double>(report.open.size());
    inhibited += static_cast<double>(report.inhibited.size());
    frame_ms.push_back(report.total_ms);
    for (const StageTime& stage : report.stages) {
      const auto known =
          std::find_if(stage_ms.begin(), stage_ms.end(), [&](auto& s) { return s.first == stage.stage; });
      auto& times = known != stage_ms.end() ? known->second : stage_ms.emplace_back(stage.stage, 0).second;
      times.push_back(stage.ms);
    }
  }
};

double quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0.0;
  const auto index = static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + index, values.end());
  return values[static_cast<std::size_t>(index)];
}

double peakMemoryMiB() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1024.0;
}

void printTotals(const RunTotals& totals, const Explorer& explorer, double elapsed_s) {
  const double frames = std::max<double>(1.0, static_cast<double>(totals.frames));
  std::cerr << fmt::format("{} frames in {:.1f} s ({:.1f} frames/s): {} tracked, {} weak, {} lost, {} skipped\n",
                           totals.frames, elapsed_s, static_cast<double>(totals.frames) / std::max(elapsed_s, 1e-9),
                           totals.tracked, totals.weak, totals.lost, totals.skipped);
  std::cerr << fmt::format("a frame has {:.0f} open and {:.0f} inhibited candidates\n\n", totals.open / frames,
                           totals.inhibited / frames);
  std::vector<std::vector<std::string>> rows = {{"stage", "median ms", "99 % ms"}};
  for (const auto& [stage, times] : totals.stage_ms) {
    rows.push_back({stage, fixed(quantile(times, 0.5), 1), fixed(quantile(times, 0.99), 1)});
  }
  rows.push_back({"whole frame", fixed(quantile(totals.frame_ms, 0.5), 1), fixed(quantile(totals.frame_ms, 0.99), 1)});
  std::cerr << alignedTable(rows) << "\n";
  std::cerr << alignedTable({
      {"map", grouped(static_cast<std::int64_t>(explorer.map().leafCount())) + " leaves",
       fixed(static_cast<double>(explorer.map().memoryBytes()) / kMiB, 0) + " MiB"},
      {"surface volume", grouped(static_cast<std::int64_t>(explorer.surface().bricks().size())) + " bricks",
       fixed(static_cast<double>(explorer.surface().memoryBytes()) / kMiB, 0) + " MiB"},
      {"attended leaves", grouped(static_cast<std::int64_t>(explorer.attendLog().leafCount())),
       fixed(static_cast<double>(explorer.attendLog().memoryBytes()) / kMiB, 0) + " MiB"},
      {"peak memory", "", fixed(peakMemoryMiB(), 0) + " MiB"},
  });
}

void refuseExisting(const Options& options) {
  std::error_code ignored;
  if (options.session.empty() || options.force || !std::filesystem::exists(options.session, ignored)) return;
  throw IoError(options.session, "no session of that name yet (--force replaces it)", "one that exists");
}

std::string progressText(const FrameReport& report, double frames_per_second) {
  return fmt::format("{:.1f} frames/s  {}  {} open, {} inhibited", frames_per_second, nameOf(report.tracking.status),
                     report.open.size(), report.inhibited.size());
}

/// The sinks that the options ask for. `session` is set if there is one among them.
std::vector<std::unique_ptr<FrameSink>> makeSinks(const Options& options, Explorer& explorer,
                                                  const SourceDescription& description, std::int64_t range_step,
                                                  std::optional<ContinuedSession>& continued, SessionSink*& session) {
  const CandidateOutliner outliner(DistortedPixels(description.camera, description.color_camera));
  std::vector<std::unique_ptr<FrameSink>> sinks;
  if (!options.session.empty()) {
    const auto when_exists = options.force ? WhenSessionExists::kReplace : WhenSessionExists::kRefuse;
    const RunRecord run = runFrom(options.input, description);
    auto writer =
        continued ? std::move(continued->writer) : std::make_unique<SessionWriter>(options.session, when_exists);
    auto sink = std::make_unique<SessionSink>(std::move(writer), explorer, outliner, run,
                                              continued ? &continued->reader.metadata() : nullptr,
                                              options.checkpoint_interval_s);
    sink->noteRangeStep(range_step);
    session = sink.get();
    sinks.push_back(std::move(sink));
  }
  if (!options.trajectory.empty()) sinks.push_back(std::make_unique<TrajectorySink>(options.trajectory));
  if (!options.candidates.empty()) sinks.push_back(std::make_unique<CandidateSink>(options.candidates, outliner));
  constexpr double kVideoFramesPerSecond = 30.0;
  if (!options.video.empty()) sinks.push_back(std::make_unique<VideoSink>(options.video, kVideoFramesPerSecond));
  if (!options.frames_folder.empty()) sinks.push_back(std::make_unique<PictureFolderSink>(options.frames_folder));
  return sinks;
}

void printFiles(const Options& options) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const char* what, const std::string& path) {
    if (!path.empty())
      rows.push_back({fmt::format("{:<12}{}", what, std::filesystem::absolute(path).lexically_normal().string())});
  };
  add("session", options.session);
  add("trajectory", options.trajectory);
  add("candidates", options.candidates);
  add("video", options.video);
  add("pictures", options.frames_folder);
  if (!rows.empty()) std::cerr << "\nwritten:\n" << alignedTable(rows);
  if (!options.session.empty()) std::cerr << "next: saccade inspect " << options.session << "\n";
}

/// The next usable frame of a source, if there is one, and why those before it were skipped.
struct Reading {
  RgbdFrame frame;
  bool has_frame = false;
  std::vector<std::string> skipped;
};

void readFrame(FrameSource& source, Reading& reading) {
  reading.skipped.clear();
  ReadStatus status = source.read(reading.frame);
  for (; status == ReadStatus::kSkip; status = source.read(reading.frame)) {
    reading.skipped.push_back(source.skipReason());
  }
  reading.has_frame = status == ReadStatus::kFrame;
}

/// The frames of the input that were asked for; of a session that is gone on with, those behind its last one.
FrameRange effectiveRange(const Options& options, const std::optional<ContinuedSession>& continued) {
  if (!options.range.empty()) return FrameRange::parse(options.range);
  FrameRange range;
  if (!continued) return range;
  const std::vector<FrameRecord> frames = continued->reader.frames();
  range.step = continued->reader.metadata().range_step;
  if (!frames.empty()) range.first = frames.back().index.value + range.step;
  std::cerr << "going on at frame " << range.first << "\n";
  return range;
}

void goOn(const ContinuedSession& continued, Explorer& explorer, bool without_map) {
  requireCamera(continued.reader, explorer.camera());
  explorer.restore(without_map ? loadMemoryWithoutMap(continued.reader) : loadMemory(continued.reader));
}

void run(Options options) {
  std::optional<ContinuedSession> continued;
  if (!options.continued.empty()) {
    continued.emplace(options.continued);
    options.session = options.continued;
    if (options.input.empty()) options.input = continued->reader.metadata().input;
  }
  const ExplorerConfig config = effectiveConfig(options, continued);
  if (options.print_config) {
    ExplorerConfig printed = config;
    std::cout << printConfig(describing(printed), true);
    return;
  }
  if (options.input.empty()) throw std::invalid_argument("explore: expected an INPUT; see saccade explore --help");
  if (!continued) refuseExisting(options);
  std::optional<tbb::global_control> threads;
  if (options.threads > 0) {
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options.threads));
  }

  std::optional<GivenPoses> poses;
  if (!options.poses.empty()) poses = GivenPoses::open(options.poses);
  const FrameRange range = effectiveRange(options, continued);
  ReadAhead source(openSource(options.input, range));
  const SourceDescription& description = source.description();
  sayWhatWasUnderstood(description);
  if (poses && poses->fromDataset() && !description.has_poses) {
    throw IoError(options.input, "poses in the dataset (--poses dataset)", "none");
  }

  std::optional<RankerModel> model;
  if (!options.model.empty()) model = RankerModel::load(options.model);
  Explorer explorer(config, description.camera, model);
  if (continued) goOn(*continued, explorer, options.map_memory_MiB > 0.0);
  SessionSink* session = nullptr;
  const auto sinks = makeSinks(options, explorer, description, range.step, continued, session);
  continued.reset();  // a reader that stays would keep the session in two files
  if (options.map_memory_MiB > 0.0) {
    if (session == nullptr) throw std::invalid_argument("--map-memory needs a session to page to: give -o S");
    limitMapMemory(*session, options.map_memory_MiB);
  }

  if (options.max_session_MiB > 0.0) {
    if (session == nullptr) throw std::invalid_argument("--max-session-size bounds a session: give -o S");
    session->limitSize(static_cast<std::uint64_t>(options.max_session_MiB * kMiB));
  }
  std::optional<LiveView> live;
  if (options.view) {
    if (session == nullptr) throw std::invalid_argument("--view shows a session: give -o S");
    live.emplace(options.session, !options.continued.empty());
  }

  catchInterrupts();
  RunTotals totals;
  std::int64_t last_frame = 0;
  ProgressLine progress(description.frames);
  Reading reading, next;
  const auto start = std::chrono::steady_clock::now();
  const auto elapsed = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  const auto full = [&] { return session != nullptr && session->full(); };
  for (readFrame(source, reading); !interrupted() && !full(); std::swap(reading, next)) {
    for (const std::string& reason : reading.skipped) {
      ++totals.skipped;
      if (session != nullptr) session->noteSkipped();
      progress.clear();
      std::cerr << "skipped: " << reason << "\n";
    }
    if (!reading.has_frame) break;
    readFrame(source, next);
    const RgbdFrame& frame = reading.frame;
    const RgbdFrame* ahead = next.has_frame ? &next.frame : nullptr;
    const FrameReport report = poses ? explorer.processAt(frame, poses->find(frame), ahead,
                                                          ahead != nullptr ? poses->find(*ahead) : std::nullopt)
                                     : explorer.process(frame, ahead);
    totals.add(report);
    last_frame = report.index.value;
    for (const auto& sink : sinks) sink->accept(frame, report);
    if (live) live->serveIfReady();
    progress.show(totals.frames + totals.skipped,
                  progressText(report, static_cast<double>(totals.frames) / std::max(elapsed(), 1e-9)));
  }
  progress.clear();
  const double elapsed_s = elapsed();
  if (totals.frames == 0) throw IoError(options.input, "at least one usable frame", "none");

  if (session != nullptr && (interrupted() || full())) session->noteInterrupted();
  auto pause = live ? live->pause() : nullptr;  // a reader that stays would keep the session in two files
  for (const auto& sink : sinks) sink->finish();
  if (session != nullptr && options.map_memory_MiB > 0.0) sayPaging(session->paging());
  if (!options.session.empty()) storeObjects(options.session);
  pause.reset();
  if (full()) {
    std::cerr << fmt::format(
        "the session has grown to --max-session-size {:g} MiB: ended after frame {}, all that was "
        "explored is saved\n",
        options.max_session_MiB, last_frame);
  }
  if (interrupted()) std::cerr << "ended by hand; what was explored is saved\n";
  sayHowItEnded(source.progress());
  printTotals(totals, explorer, elapsed_s);
  printFiles(options);
  if (live) live->waitForInterrupt();
}

}  // namespace

void addExplore(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("explore", "Explore a recorded sequence: track, map, propose, attend");
  command->add_option(
      "INPUT", options->input,
      "a 7-Scenes, TUM or labelled-frames folder (the kind is detected), or sim:SCENE, as saccade simulate makes");
  CLI::Option* output = command->add_option("-o,--output", options->session, "the session to write (*.saccade)");
  CLI::Option* force = command->add_flag("--force", options->force, "replace a session that exists");
  CLI::Option* go_on = command->add_option(
      "--continue", options->continued,
      "go on with this session as if it had never stopped, from the frame after its last one unless --range is given");
  command
      ->add_option("--checkpoint-interval", options->checkpoint_interval_s,
                   "seconds between two checkpoints of the session: what a crash can cost at most")
      ->check(CLI::Range(0.0, 86400.0))
      ->capture_default_str();
  addMapMemory(*command, options->map_memory_MiB);
  command
      ->add_option("--max-session-size", options->max_session_MiB,
                   "MiB that the session may take: images of keyframes are thinned first, then exploration ends "
                   "(0: no limit)")
      ->check(CLI::Range(0.0, 1e6))
      ->capture_default_str();
  command->add_option("--trajectory", options->trajectory, "write the poses in TUM format");
  command->add_option("--candidates", options->candidates, "write the candidates, one JSON line a frame");
  command->add_option("--video", options->video, "write a video (.mp4) of candidates, saliency, segments, 2D IOR map");
  command->add_option("--frames-dir", options->frames_folder, "write the same pictures as PNG files to a folder");
  command->add_flag("--view", options->view, "show the session in a browser while it grows, see saccade view");
  command->add_option("--range", options->range, "frames A:B:STEP of the input, B excluded");
  command->add_option("--poses", options->poses, "believe these poses instead of tracking: \"dataset\" or a TUM file");
  CLI::Option* config = command->add_option("--config", options->config, "YAML file with settings, see --print-config");
  CLI::Option* set =
      command->add_option("--set", options->settings, "one setting, for example inhibition.theta=0.4; may be repeated")
          ->expected(1)
          ->take_all();
  command->add_option("--model", options->model, "ranking model written by saccade train, instead of the built-in one");
  command->add_flag("--print-config", options->print_config, "print the effective settings with their help and stop");
  CLI::Option* no_ior = command->add_flag("--no-ior", options->no_ior, "attend and log, but inhibit nothing");
  CLI::Option* paper = command->add_flag("--paper", options->paper, "the paper's method and nothing beyond it");
  for (CLI::Option* fixed_by_session : {output, force, config, set, no_ior, paper}) go_on->excludes(fixed_by_session);
  command->add_option("--threads", options->threads, "threads to use (0: all)")->check(CLI::Range(0, 1024));
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
