#include <algorithm>
#include <ctime>
#include <iostream>
#include <memory>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/chrono.h>
#include <fmt/format.h>

#include "commands.hpp"
#include "saccade/objects/forgetting.hpp"
#include "saccade/session/session_map.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string session;
  int id = 0;
  std::vector<double> box;
  bool all = false;
};

ForgetSelection selectionOf(const Options& options) {
  if (options.all) return ForgetSelection::everything();
  if (!options.box.empty()) {
    const Eigen::Vector3d low(options.box[0], options.box[1], options.box[2]);
    const Eigen::Vector3d high(options.box[3], options.box[4], options.box[5]);
    const Eigen::AlignedBox3d box(low, high);
    if (box.isEmpty()) throw std::invalid_argument("forget: --box expects the lowest corner before the highest");
    return ForgetSelection::box(box);
  }
  const SessionReader session(options.session);
  const std::vector<AttendedObject> objects = findObjects(session, 1);
  const auto object =
      std::find_if(objects.begin(), objects.end(), [&](const AttendedObject& o) { return o.id.value == options.id; });
  if (object == objects.end()) {
    throw std::invalid_argument(
        fmt::format("forget: {} has objects 1 to {}, not {}", options.session, objects.size(), options.id));
  }
  return ForgetSelection::object(*object);
}

void run(const Options& options) {
  const std::string now = fmt::format("{:%FT%TZ}", fmt::gmtime(std::time(nullptr)));
  const ForgettingRecord record = forgetInSession(options.session, selectionOf(options), now);
  std::cerr << fmt::format("forgotten: {}, {} leaves that remembered an attention\n", record.what,
                           grouped(record.leaves));
}

}  // namespace

void addForget(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("forget", "Clear attention memory, so that it is looked at again");
  command->add_option("SESSION", options->session, "a session (*.saccade); edited in one step")->required();
  CLI::Option_group* what = command->add_option_group("what");
  what->add_option("--id", options->id, "an object, as inspect SESSION objects numbers them");
  what->add_option("--box", options->box, "min x y z and max x y z in the world frame, metres")->expected(6);
  what->add_flag("--all", options->all, "everything");
  what->require_option(1);
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
