#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "commands.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/sources/recording.hpp"
#include "source_talk.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string input, output, range, layout = "tum";
  bool force = false;
};

void run(const Options& options) {
  const RecordingKind kind = recordingKindOf(options.output, options.layout);
  const auto source =
      openSensorSource(options.input, options.range.empty() ? FrameRange{} : FrameRange::parse(options.range));
  sayWhatWasUnderstood(source->description());
  const auto writer = openRecording(options.output, kind, *source,
                                    options.force ? WhenRecordingExists::kReplace : WhenRecordingExists::kRefuse);
  catchInterrupts();
  ProgressLine progress(source->description().frames);
  SensorFrame frame;
  std::int64_t written = 0, skipped = 0;
  while (!interrupted()) {
    const ReadStatus status = source->read(frame);
    if (status == ReadStatus::kEnd) break;
    if (status == ReadStatus::kSkip) {
      ++skipped;
      progress.clear();
      std::cerr << "skipped: " << source->skipReason() << "\n";
      continue;
    }
    writer->write(frame);
    progress.show(++written + skipped, frame.name);
  }
  progress.clear();
  if (written == 0) throw IoError(options.input, "at least one usable frame", "none");
  writer->finish();
  const SourceProgress ended = source->progress();
  sayHowItEnded(ended);
  if (interrupted()) std::cerr << "ended by hand; the recording is whole up to there\n";
  for (const std::string& loss : writer->losses()) std::cerr << "not kept: " << loss << "\n";
  std::cerr << fmt::format("written: {} ({} frames, {} skipped, {} dropped)\nnext: saccade explore {}\n",
                           std::filesystem::absolute(options.output).lexically_normal().string(), written, skipped,
                           ended.dropped, options.output);
}

}  // namespace

void addRecord(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("record", "Write a camera or a recording as another recording, losslessly");
  command->add_option("INPUT", options->input, "any input of explore; openni2: for the first camera")->required();
  command->add_option("-o,--output", options->output, "the recording: NAME.oni, NAME.rawlog, NAME.bag or a folder")
      ->required();
  command->add_option("--layout", options->layout, "of a folder: tum (the default) or 7scenes");
  command->add_option("--range", options->range, "frames A:B:STEP of the input, B excluded");
  command->add_flag("--force", options->force, "replace a recording that exists");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
