#include <iostream>
#include <memory>
#include <optional>

#include <fmt/format.h>
#include <tbb/global_control.h>

#include "commands.hpp"
#include "saccade/simulation/sequence_writer.hpp"
#include "saccade/simulation/simulated_source.hpp"
#include "source_talk.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string scene, output, range;
  std::uint64_t seed = 0;
  std::int64_t frames = 0;
  double noise = 1.0;
  bool force = false;
  int threads = 0;
};

std::string sceneList() {
  std::string list = "Scenes:\n";
  for (const SceneKind& kind : sceneKinds()) {
    list += fmt::format("  {:<8}{} ({} frames)\n", kind.name, kind.what, kind.default_frames);
  }
  return list;
}

SimulationRequest requestOf(const Options& options) {
  // One way in: the same text as an input of explore, so that both refuse the same things.
  std::string text = fmt::format("sim:{}?seed={}&noise={}", options.scene, options.seed, options.noise);
  if (options.frames != 0) text += fmt::format("&frames={}", options.frames);
  return SimulationRequest::parse(text);
}

void run(const Options& options) {
  std::optional<tbb::global_control> threads;
  if (options.threads > 0) {
    threads.emplace(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(options.threads));
  }
  const SimulationRequest request = requestOf(options);
  SimulatedSource source(request, options.range.empty() ? FrameRange{} : FrameRange::parse(options.range));
  SequenceWriter writer(options.output, options.force ? WhenFolderExists::kReplace : WhenFolderExists::kRefuse,
                        source.description().camera);
  sayWhatWasUnderstood(source.description());

  catchInterrupts();
  ProgressLine progress(source.description().frames);
  RgbdFrame frame;
  std::int64_t written = 0;
  while (!interrupted() && source.read(frame) == ReadStatus::kFrame) {
    writer.write(frame);
    progress.show(++written, frame.name);
  }
  writer.finish(source.objects());
  progress.clear();
  if (interrupted()) std::cerr << "ended by hand; the frames so far form a sequence\n";
  std::cerr << fmt::format("written: {} ({} frames, {} objects)\nnext: saccade explore {}\n", options.output, written,
                           source.objects().size(), options.output);
}

}  // namespace

void addSimulate(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("simulate", "Write a synthetic sequence with exact poses and object masks");
  command->footer(sceneList());
  command->add_option("SCENE", options->scene, "the kind of scene, see below")->required();
  command->add_option("-o,--output", options->output, "the folder to write, in TUM layout with label/")->required();
  command->add_option("--seed", options->seed, "which of the many scenes of the kind");
  command->add_option("--frames", options->frames, "frames to render, 30 a second; the scene's own number if not given")
      ->check(CLI::PositiveNumber);
  command->add_option("--noise", options->noise, "strength of the sensor's noise, 0 for ideal images");
  command->add_option("--range", options->range, "frames A:B:STEP of the sequence, B excluded");
  command->add_flag("--force", options->force, "replace a sequence that exists");
  command->add_option("--threads", options->threads, "threads to use (0: all)")->check(CLI::Range(0, 1024));
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
