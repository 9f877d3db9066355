#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/session/session_repair.hpp"
#include "session_talk.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string session;
  bool json = false;
};

void printJson(const SessionFindings& findings) {
  nlohmann::ordered_json tables = nlohmann::ordered_json::object();
  for (const TableFindings& table : findings.tables) {
    tables[table.table] = {{"whole", table.whole}, {"damaged", table.damaged}};
  }
  const nlohmann::ordered_json json = {{"whole", isWhole(findings)},
                                       {"tables", tables},
                                       {"complaints", findings.complaints},
                                       {"more_complaints", findings.more_complaints}};
  std::cout << json.dump(2) << "\n";
}

void run(const Options& options) {
  const SessionFindings findings = verifySession(options.session);
  options.json ? printJson(findings) : printFindings(findings, std::cout);
  if (!isWhole(findings)) {
    throw IoError(options.session, "a whole session",
                  "damage (saccade repair " + options.session + " -o NEW keeps what is whole)");
  }
  if (!options.json) std::cout << options.session << " is whole\n";
}

}  // namespace

void addVerify(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "verify", "Check everything in a session; exit code 1 and what is wrong if it is not whole");
  command->add_option("SESSION", options->session, "a *.saccade file")->required();
  command->add_flag("--json", options->json, "print JSON");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
