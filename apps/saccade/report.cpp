#include <filesystem>
#include <iostream>
#include <memory>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "commands.hpp"
#include "saccade/exchange/output_file.hpp"
#include "saccade/reporting/session_report.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string session, output, truth;
  bool force = false;
};

void run(const Options& options) {
  OutputFile file(options.output, options.force ? WhenFileExists::kReplace : WhenFileExists::kRefuse);
  const SessionReader session(options.session);
  const std::string page = makeSessionReport(
      session, options.truth.empty() ? std::nullopt : std::optional<std::filesystem::path>(options.truth));
  file.stream() << page;
  file.finish();
  std::cerr << fmt::format("written: {} ({:.1f} MB)\n",
                           std::filesystem::absolute(options.output).lexically_normal().string(),
                           static_cast<double>(page.size()) * 1e-6);
}

}  // namespace

void addReport(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("report", "Write one page (HTML) that shows a session and opens anywhere, offline");
  command->add_option("SESSION", options->session, "a session (*.saccade)")->required();
  command->add_option("-o,--output", options->output, "the page to write, at most 20 MB")->required();
  command->add_option("--truth", options->truth,
                      "true poses (TUM format): adds the true path and the trajectory error");
  command->add_flag("--force", options->force, "replace a file that exists");
  command->footer("Example:\n  saccade report my.saccade -o my.html --truth groundtruth.txt");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
