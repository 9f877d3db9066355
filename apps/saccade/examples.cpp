#include "examples.hpp"

#include <map>
#include <string>

namespace saccade::app {
namespace {

/// Command lines as a user would type them, by command.
const std::map<std::string, std::string>& examples() {
  static const std::map<std::string, std::string> all = {
      {"explore",
       "  saccade explore FOLDER -o my.saccade --video my.mp4\n"
       "  saccade explore sim:coffee?seed=3 -o coffee.saccade --range 0:200 --set map.leaf_size_m=0.02\n"
       "  saccade explore --continue my.saccade"},
      {"resume", "  saccade resume my.saccade FOLDER --trajectory later.txt"},
      {"render",
       "  saccade render my.saccade -o all.png\n"
       "  saccade render my.saccade -o seen.png --frame 120 --layer flag\n"
       "  saccade render my.saccade -o round.mp4 --turntable --size 1280x720"},
      {"view",
       "  saccade view my.saccade\n"
       "  saccade view monday.saccade friday.saccade"},
      {"preflight", "  saccade preflight FOLDER"},
      {"saliency", "  saccade saliency photo.jpg -o photo-saliency.png"},
      {"simulate", "  saccade simulate desk -o desk --seed 2 --frames 60"},
      {"evaluate",
       "  saccade evaluate FOLDER --gt LABELS --propagate -o page\n"
       "  saccade evaluate --frames LABELLED"},
      {"verify", "  saccade verify my.saccade"},
      {"repair", "  saccade repair damaged.saccade -o whole.saccade"},
      {"train", "  saccade train LABELLED1 LABELLED2 -o my.model"},
      {"export",
       "  saccade export my.saccade my.ply\n"
       "  saccade export my.saccade my.ot --to color-ot --paint ior\n"
       "  saccade export my.saccade plan.pgm --height-band 0.1 1.8"},
      {"import", "  saccade import map.bt -o map.saccade"},
      {"forget",
       "  saccade forget my.saccade --id 7\n"
       "  saccade forget my.saccade --box -0.5 -0.2 1 0.5 0.3 2"},
      {"diff", "  saccade diff monday.saccade friday.saccade --align --ply changes.ply"},
      {"merge", "  saccade merge a.saccade b.saccade -o both.saccade --align"},
      {"record", "  saccade record openni2: -o walk.oni"},
  };
  return all;
}

}  // namespace

void hideEmptyDefaults(CLI::App& program) {
  for (CLI::App* command : program.get_subcommands([](CLI::App*) { return true; })) hideEmptyDefaults(*command);
  for (CLI::Option* option : program.get_options()) {
    if (option->get_default_str() == "[]") option->default_str("");
  }
}

void addExamples(CLI::App& program) {
  for (CLI::App* command : program.get_subcommands([](CLI::App*) { return true; })) {
    const auto example = examples().find(command->get_name());
    if (example == examples().end()) continue;
    const std::string before = command->get_footer();
    command->footer((before.empty() ? "Examples:\n" : before + "\n\nExamples:\n") + example->second);
  }
}

}  // namespace saccade::app
