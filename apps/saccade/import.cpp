#include <filesystem>
#include <iostream>
#include <memory>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include "commands.hpp"
#include "saccade/core/config_file.hpp"
#include "saccade/exchange/map_session.hpp"
#include "saccade/exchange/octomap_files.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string map, session, config;
  std::vector<std::string> settings;
  bool force = false;
};

void run(const Options& options) {
  ExplorerConfig config;
  if (!options.config.empty()) applyConfigFile(options.config, describing(config));
  applyConfigSettings(options.settings, describing(config));
  const ForeignMap foreign = readOctomap(options.map, config.map);
  config.map = foreign.map.config();
  const std::string kind = std::string("OctoMap ") + (foreign.binary ? ".bt" : ".ot") + " of type " + foreign.tree_type;
  const std::string now = fmt::format("{:%FT%TZ}", fmt::gmtime(std::time(nullptr)));
  const auto when_exists = options.force ? WhenSessionExists::kReplace : WhenSessionExists::kRefuse;
  writeMapSession(foreign.map, config, {options.map, kind, now}, options.session, when_exists);
  const auto count = [](std::size_t number) { return grouped(static_cast<std::int64_t>(number)); };
  std::cerr << fmt::format("{}: {}, {} leaves of {:.1f} cm, {} of them occupied\n", options.map, kind,
                           count(foreign.map.leafCount()), config.map.leaf_size_m * 100.0,
                           count(foreign.map.occupiedLeafCount()));
  std::cerr << "written: " << std::filesystem::absolute(options.session).lexically_normal().string() << "\n";
}

}  // namespace

void addImport(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("import", "Make a session of an OctoMap file");
  command->add_option("MAP", options->map, "an .ot file (OcTree, ColorOcTree, IorOcTree) or a .bt file")->required();
  command->add_option("-o,--output", options->session, "the session to write (*.saccade)")->required();
  command->add_option("--config", options->config, "YAML file with settings for explorations to come");
  command->add_option("--set", options->settings, "one setting, for example map.max_range_m=3; may be repeated")
      ->expected(1)
      ->take_all();
  command->add_flag("--force", options->force, "replace a session that exists");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
