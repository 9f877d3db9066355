#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "saccade/core/config_file.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/evaluation/discovery_evaluation.hpp"
#include "saccade/pipeline/candidate_sink.hpp"
#include "saccade/sources/frame_source.hpp"
#include "source_talk.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string frames, labels, range, config, model, candidates;
  std::vector<std::string> settings;
  bool json = false, paper = false, print_config = false, no_depth = false;
};

constexpr int kFew = 20;
constexpr int kAll = 255;

nlohmann::ordered_json scores(const DiscoveryScore& score) {
  return {{"recall_all", score.recall(kAll)},
          {"recall_at_20", score.recall(kFew)},
          {"precision_at_20", score.precision(kFew)},
          {"precision_all", score.precision(kAll)},
          {"f_score", score.fScore(kFew)},
          {"f_score_all", score.fScore(kAll)},
          {"auc_recall", score.recallAuc()}};
}

double totalMs(const DiscoveryEvaluation& e) {
  const Perceiver::Times& t = e.perceive_ms;
  return t.saliency_ms + t.blobs_ms + t.color_ms + t.surface_ms + t.tables_ms + e.propose_ms + e.rank_ms;
}

void printJson(const DiscoveryEvaluation& e) {
  const nlohmann::ordered_json json = {{"frames", e.frames},
                                       {"boxes", scores(e.boxes)},
                                       {"masks", scores(e.masks)},
                                       {"candidates_per_frame", e.ranked},
                                       {"pool_per_frame", e.pool_size},
                                       {"ms_per_frame", totalMs(e)}};
  std::cout << json.dump(2) << "\n";
}

void printText(const DiscoveryEvaluation& e) {
  std::vector<std::vector<std::string>> rows = {
      {"Pascal criterion, " + std::to_string(e.frames) + " frames", "boxes", "masks"}};
  const nlohmann::ordered_json boxes = scores(e.boxes);
  const nlohmann::ordered_json masks = scores(e.masks);
  for (const auto& [key, value] : boxes.items()) {
    rows.push_back({key, fixed(value.get<double>(), 3), fixed(masks[key].get<double>(), 3)});
  }
  rows.push_back({"candidates a frame", fixed(e.ranked, 1)});
  rows.push_back({"ms a frame", fixed(totalMs(e), 1)});
  std::cout << alignedTable(rows);
}

void run(const Options& options) {
  EvaluationOptions evaluation;
  if (options.paper) evaluation.discovery.usePaperOnly();
  if (!options.config.empty()) applyConfigFile(options.config, describing(evaluation.discovery));
  applyConfigSettings(options.settings, describing(evaluation.discovery));
  if (options.print_config) {
    std::cout << printConfig(describing(evaluation.discovery), true);
    return;
  }
  if (options.frames.empty())
    throw std::invalid_argument("evaluate: expected --frames DIR; see saccade evaluate --help");
  if (!options.model.empty()) evaluation.model = RankerModel::load(options.model);
  evaluation.use_depth = !options.no_depth;

  const auto source =
      openSource(options.frames, options.range.empty() ? FrameRange{} : FrameRange::parse(options.range));
  sayWhatWasUnderstood(source->description());
  ProgressLine progress(source->description().frames);
  std::int64_t done = 0;
  evaluation.on_frame = [&](const EvaluatedFrame& frame) { progress.show(++done, frame.frame.name); };
  const DiscoveryEvaluation result = evaluateFrames(*source, evaluation);
  progress.clear();
  if (result.frames == 0) throw IoError(options.frames, "at least one labelled frame", "none");
  options.json ? printJson(result) : printText(result);
}

}  // namespace

void addEvaluate(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("evaluate", "Compare candidates with labels, frame by frame");
  command->add_option("--frames", options->frames, "a folder of labelled frames: color/ depth/ label/ camera.txt");
  command->add_flag("--json", options->json, "print JSON");
  command->add_option("--range", options->range, "frames A:B:STEP of the folder, B excluded");
  command->add_option("--config", options->config, "YAML file with settings, see --print-config");
  command->add_option("--set", options->settings, "one setting, for example ranking.top_k=10; may be repeated")
      ->expected(1)
      ->take_all();
  command->add_option("--model", options->model, "ranking model written by saccade train, instead of the built-in one");
  command->add_flag("--paper", options->paper, "the paper's method and nothing beyond it");
  command->add_flag("--no-depth", options->no_depth, "use colour alone");
  command->add_flag("--print-config", options->print_config, "print the effective settings with their help and stop");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
