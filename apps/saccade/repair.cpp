#include <iostream>
#include <memory>

#include "commands.hpp"
#include "saccade/session/session_repair.hpp"
#include "session_talk.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string session, repaired;
};

void run(const Options& options) {
  const SessionFindings findings = repairSession(options.session, options.repaired);
  printFindings(findings, std::cerr);
  std::cerr << (isWhole(findings) ? "nothing was lost; " : "kept what is whole; ") << "written to "
            << std::filesystem::absolute(options.repaired).lexically_normal().string() << "\n";
}

}  // namespace

void addRepair(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "repair", "Copy what is whole in a damaged session to a new one and say what was lost; also updates old formats");
  command->add_option("SESSION", options->session, "a *.saccade file")->required();
  command->add_option("-o,--output", options->repaired, "the session to write")->required();
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
