#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "commands.hpp"
#include "saccade/core/config_file.hpp"
#include "saccade/evaluation/ranker_training.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::vector<std::string> inputs;
  std::string output, config;
  std::vector<std::string> settings;
  bool paper = false, print_config = false;
};

void run(const Options& options) {
  RankerTrainingConfig config;
  if (options.paper) config.usePaperOnly();
  if (!options.config.empty()) applyConfigFile(options.config, describing(config));
  applyConfigSettings(options.settings, describing(config));
  if (options.print_config) {
    std::cout << printConfig(describing(config), true);
    return;
  }
  if (options.inputs.empty() || options.output.empty()) {
    throw std::invalid_argument("train: expected folders of labelled frames and -o MODEL; see saccade train --help");
  }
  const RankerTraining training = trainRanker(options.inputs, config);
  training.model.save(options.output);

  std::vector<std::vector<std::string>> rows = {{"cross-validation", "AUC", "recall at 5", "at 10", "at 20"}};
  for (const RankerTrial& trial : training.trials) {
    rows.push_back({trial.settings, fixed(trial.auc, 4), fixed(trial.recall_at_5, 3), fixed(trial.recall_at_10, 3),
                    fixed(trial.recall_at_20, 3)});
  }
  std::cerr << alignedTable(rows);
  std::cerr << fmt::format("chosen: {}; {} candidates that show objects and {} that do not, from {} frames\n",
                           training.chosen.settings, training.objects, training.others, training.frames);
  if (!training.ablation.empty()) {
    std::vector<std::vector<std::string>> values = {{"without", "AUC lost", "mean recall lost"}};
    for (const FeatureValue& value : training.ablation) {
      values.push_back({std::string(value.name), fixed(value.auc_lost, 4), fixed(value.merit_lost, 3)});
    }
    std::cerr << alignedTable(values);
  }
  std::cerr << "written: " << options.output << "\nnext: saccade evaluate --frames DIR --model " << options.output
            << "\n";
}

}  // namespace

void addTrain(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("train", "Train the ranker on labelled frames");
  command->add_option(
      "FOLDER", options->inputs,
      "labelled frames: color/ depth/ label/ camera.txt, or sim:SCENE; with @A:B:STEP after it only these frames");
  command->add_option("-o,--output", options->output, "the model file to write");
  command->add_option("--config", options->config, "YAML file with settings, see --print-config");
  command->add_option("--set", options->settings, "one setting, for example folds=10; may be repeated")
      ->expected(1)
      ->take_all();
  command->add_flag("--paper", options->paper, "the paper's candidates, twelve features and SVM, nothing beyond");
  command->add_flag("--print-config", options->print_config, "print the effective settings with their help and stop");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
