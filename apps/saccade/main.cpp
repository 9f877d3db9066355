#include <exception>
#include <iostream>
#include <malloc.h>
#include <stdexcept>

#include <CLI/CLI.hpp>

#include "commands.hpp"
#include "examples.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/version.hpp"

namespace {

enum ExitCode { kDone = 0, kFailed = 1, kUsage = 2 };

}  // namespace

int main(int argc, char** argv) {
  // Keep freed memory: the default gives every image-sized block back to the system and pays for fresh pages each
  // frame.
  mallopt(M_MMAP_THRESHOLD, 1 << 30);
  mallopt(M_TRIM_THRESHOLD, 1 << 30);
  CLI::App program{
      "Saccade explores a scene through an RGB-D camera the way an eye does: it tracks the camera, maps the\n"
      "scene, proposes objects, and remembers in the map what it has attended, so that it looks elsewhere next.",
      "saccade"};
  program.set_version_flag("--version", std::string("saccade ") + saccade::kVersion);
  program.require_subcommand(1);
  program.option_defaults()->always_capture_default();
  program.get_formatter()->column_width(34);
  saccade::app::addExplore(program);
  saccade::app::addResume(program);
  saccade::app::addInspect(program);
  saccade::app::addRender(program);
  saccade::app::addView(program);
  saccade::app::addReport(program);
  saccade::app::addSaliency(program);
  saccade::app::addSimulate(program);
  saccade::app::addEvaluate(program);
  saccade::app::addVerify(program);
  saccade::app::addRepair(program);
  saccade::app::addTrain(program);
  saccade::app::addExport(program);
  saccade::app::addImport(program);
  saccade::app::addForget(program);
  saccade::app::addDiff(program);
  saccade::app::addMerge(program);
  saccade::app::addRecord(program);
  saccade::app::addPreflight(program);
  saccade::app::addExamples(program);
  saccade::app::hideEmptyDefaults(program);
  program.footer(
      "saccade COMMAND --help says more of each. Begin with:\n"
      "  saccade explore FOLDER -o my.saccade\n"
      "  saccade inspect my.saccade");
  try {
    program.parse(argc, argv);
    return kDone;
  } catch (const CLI::ParseError& error) {
    return program.exit(error) == 0 ? kDone : kUsage;
  } catch (const std::invalid_argument& error) {
    std::cerr << "saccade: " << error.what() << "\n";
    return kUsage;
  } catch (const std::exception& error) {
    std::cerr << "saccade: " << error.what() << "\n";
    return kFailed;
  }
}
