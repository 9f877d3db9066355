#include <ctime>
#include <filesystem>
#include <iostream>
#include <memory>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "commands.hpp"
#include "saccade/exchange/session_merge.hpp"
#include "saccade/objects/object_table.hpp"
#include "session_frames.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string first, second, output;
  SessionFrames frames;
  bool force = false;
};

void run(const Options& options) {
  const SessionReader first(options.first), second(options.second);
  const auto when_exists = options.force ? WhenSessionExists::kReplace : WhenSessionExists::kRefuse;
  const std::string now = fmt::format("{:%FT%TZ}", fmt::gmtime(std::time(nullptr)));
  const SessionMergeReport report =
      mergeSessions(first, second, options.frames.resolve(first, second), options.output, when_exists, now);
  const int objects = storeObjects(options.output);
  const auto count = [](auto n) { return grouped(static_cast<std::int64_t>(n)); };
  std::cerr << alignedTable({{"leaves", count(report.leaves)},
                             {"known to both", count(report.map.common)},
                             {"attention lifted where they disagree", count(report.map.lifted)},
                             {"surface bricks", count(report.bricks)},
                             {"frames", count(report.frames)},
                             {"keyframes", count(report.keyframes)},
                             {"objects", count(objects)},
                             {"tick", count(report.tick)}});
  std::cerr << "written: " << std::filesystem::absolute(options.output).lexically_normal().string() << "\n";
}

}  // namespace

void addMerge(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("merge", "Make one session of two");
  command->add_option("A", options->first, "the session whose world frame and settings are kept")->required();
  command->add_option("B", options->second, "the session that is added to it")->required();
  command->add_option("-o,--output", options->output, "the session to write (*.saccade)")->required();
  options->frames.addTo(*command);
  command->add_flag("--force", options->force, "replace a session that exists");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
