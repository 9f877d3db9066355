#include <filesystem>
#include <iostream>
#include <memory>

#include <fmt/format.h>

#include "commands.hpp"
#include "evaluate_relocalisation.hpp"
#include "saccade/core/config_file.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/evaluation/discovery_evaluation.hpp"
#include "saccade/evaluation/evaluation_page.hpp"
#include "saccade/evaluation/evaluation_report.hpp"
#include "saccade/evaluation/sequence_evaluation.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/sources/label_folder.hpp"
#include "source_talk.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::vector<std::string> inputs;
  std::string frames, relocalisation, labels, truth, poses, range, config, model, output, masks;
  std::vector<std::string> settings, vary;
  int k = 20, every = 1;
  bool json = false, paper = false, print_config = false, no_depth = false;
  bool propagate = false, compare = false, rivals = false, baselines = false;
};

ExplorerConfig effectiveConfig(const Options& options) {
  ExplorerConfig config;
  if (options.paper) config.usePaperOnly();
  if (!options.config.empty()) applyConfigFile(options.config, describing(config));
  applyConfigSettings(options.settings, describing(config));
  config.discovery.ranking.top_k = options.k;
  return config;
}

ComparisonOptions comparisonOf(const Options& options) {
  return {options.compare, options.compare || options.baselines, options.compare || options.rivals};
}

FrameRange rangeOf(const Options& options) {
  return options.range.empty() ? FrameRange{} : FrameRange::parse(options.range);
}

/// "map.ior.mf=2,4,6"
Variation parseVariation(const std::string& text) {
  Variation variation;
  const std::size_t equals = text.find('=');
  variation.setting = text.substr(0, equals);
  for (std::size_t at = equals; at != std::string::npos && at < text.size();) {
    const std::size_t comma = text.find(',', at + 1);
    variation.values.push_back(text.substr(at + 1, comma == std::string::npos ? comma : comma - at - 1));
    at = comma;
  }
  if (equals == std::string::npos || variation.setting.empty() || variation.values.front().empty()) {
    throw std::invalid_argument("evaluate: expected --vary SETTING=VALUE,VALUE,..., found \"" + text + "\"");
  }
  return variation;
}

/// Single labelled frames, without memory.
SequenceEvaluation evaluateLabelledFrames(const std::string& input, const Options& options) {
  EvaluationOptions evaluation;
  evaluation.discovery = effectiveConfig(options).discovery;
  if (!options.model.empty()) evaluation.model = RankerModel::load(options.model);
  evaluation.use_depth = !options.no_depth;
  evaluation.compare = comparisonOf(options);
  const auto source = openSource(input, rangeOf(options), options.labels);
  sayWhatWasUnderstood(source->description());
  ProgressLine progress(source->description().frames);
  std::int64_t done = 0;
  evaluation.on_frame = [&](const EvaluatedFrame& frame) { progress.show(++done, frame.frame.name); };
  DiscoveryEvaluation result = evaluateFrames(*source, evaluation);
  progress.clear();
  if (result.frames == 0) throw IoError(input, "at least one labelled frame", "none");
  SequenceEvaluation sequence;
  sequence.input = input;
  sequence.frames = result.frames;
  sequence.ours = std::move(result.ours);
  sequence.others = std::move(result.others);
  return sequence;
}

/// A whole sequence, run with and without inhibition.
SequenceEvaluation evaluateInput(const std::string& input, const Options& options) {
  SequenceOptions sequence;
  sequence.config = effectiveConfig(options);
  if (!options.model.empty()) sequence.model = RankerModel::load(options.model);
  sequence.range = rangeOf(options);
  sequence.labels = options.labels;
  sequence.labels_every = options.every;
  sequence.propagate = options.propagate || !options.masks.empty();
  sequence.truth = options.truth;
  if (!options.poses.empty()) sequence.poses = GivenPoses::open(options.poses);
  sequence.compare = comparisonOf(options);
  if (options.compare) sequence.variations.push_back({"map.ior.mf", {"2", "4", "6"}});
  for (const std::string& text : options.vary) sequence.variations.push_back(parseVariation(text));
  std::optional<ProgressLine> progress;
  std::string shown;
  sequence.on_progress = [&](const std::string& run, std::int64_t done, std::int64_t total) {
    if (run != shown) progress.emplace(total);
    shown = run;
    progress->show(done, input + ": " + run);
  };
  SequenceEvaluation evaluation = evaluateSequence(input, sequence);
  progress.reset();
  if (!options.masks.empty()) evaluation.labels.save(options.masks, evaluation.ignore_from);
  return evaluation;
}

/// The record of an earlier run.
SequenceEvaluation evaluateRecord(const std::string& path, const Options& options) {
  if (options.labels.empty()) throw std::invalid_argument("evaluate: expected --gt DIR with the labels of " + path);
  const RunRecording recording = loadRecording(path);
  LabelFolder folder(options.labels);
  LabelFrames labels;
  for (const RecordedFrame& frame : recording.frames) {
    if (const auto label = folder.load(frame.name)) labels.add(frame.name, *label);
  }
  if (labels.empty()) throw IoError(options.labels, "a label of some frame of " + path, "none");
  DiscoveryRules rules;
  if (folder.ignoreFrom()) rules.ignore_from = *folder.ignoreFrom();
  RunScore score = scoreRun(recording, labels, rules);
  SequenceEvaluation sequence;
  sequence.input = path;
  sequence.frames = score.frames;
  sequence.ours = {recording.only_attended ? "attended candidates" : "open candidates", score.boxes, score.masks};
  for (const RecordedFrame& frame : recording.frames) {
    sequence.lost += frame.tracking == "lost" ? 1 : 0;
    sequence.ours.candidates += static_cast<double>(frame.open.size()) / static_cast<double>(score.frames);
  }
  sequence.ours.ms = score.median_ms;
  sequence.runs.push_back({"recorded run", std::move(score)});
  return sequence;
}

bool isRecord(const std::string& input) {
  const std::string extension = std::filesystem::path(input).extension().string();
  return extension == ".saccade" || extension == ".jsonl";
}

void makeFolder(const std::string& folder) {
  std::error_code failure;
  std::filesystem::create_directories(folder, failure);
  if (failure) throw IoError(folder, "a folder for the report", failure.message());
}

void sayTracking(const SequenceEvaluation& sequence) {
  std::cout << fmt::format("{}: {} frames, {} lost", sequence.input, sequence.frames, sequence.lost);
  if (sequence.ate) {
    std::cout << fmt::format(", ATE {:.1f} mm (max {:.1f}, {} poses)", sequence.ate->rmse_m * 1000.0,
                             sequence.ate->max_m * 1000.0, sequence.ate->matched);
  }
  if (sequence.rpe) {
    constexpr double kDegrees = 57.29577951308232;
    std::cout << fmt::format(", RPE {:.1f} mm, {:.2f} degrees a second", sequence.rpe->translation_rmse_m * 1000.0,
                             sequence.rpe->rotation_rmse_rad * kDegrees);
  }
  if (sequence.propagation) {
    std::cout << fmt::format(", IoU of propagated masks {:.3f} ({} objects)", sequence.propagation->mean_iou,
                             sequence.propagation->objects);
  }
  std::cout << "\n";
}

void report(const std::vector<SequenceEvaluation>& sequences, const Options& options) {
  const bool single_frames = !options.frames.empty();
  if (options.json) {
    std::cout << (single_frames ? framesJson(sequences.front(), options.k) : evaluationJson(sequences, options.k))
              << "\n";
  } else if (single_frames) {
    std::cout << alignedTable(figureRows(sequences.front(), options.k));
    if (!sequences.front().others.empty()) std::cout << "\n" << alignedTable(methodRows(sequences, options.k));
  } else {
    for (const SequenceEvaluation& sequence : sequences) sayTracking(sequence);
    std::cout << "\n" << alignedTable(methodRows(sequences, options.k));
    if (!sequences.front().runs.empty()) std::cout << "\n" << alignedTable(runRows(sequences, options.k));
  }
  if (options.output.empty()) return;
  writeEvaluationPage(sequences, options.k, options.output);
  std::cerr << "written: " << std::filesystem::absolute(options.output) / "index.html"
            << "\n";
}

void run(const Options& options) {
  if (options.print_config) {
    ExplorerConfig config = effectiveConfig(options);
    std::cout << printConfig(describing(config), true);
    return;
  }
  if (!options.relocalisation.empty()) {
    if (options.inputs.size() != 1) throw std::invalid_argument("evaluate: --relocalisation expects one INPUT");
    evaluateRelocalisation(options.relocalisation, options.inputs.front(), options.range, options.truth, options.json);
    return;
  }
  if (options.inputs.empty() == options.frames.empty()) {
    throw std::invalid_argument("evaluate: expected either INPUTs or --frames DIR; see saccade evaluate --help");
  }
  if (!options.output.empty()) makeFolder(options.output);
  std::vector<SequenceEvaluation> sequences;
  if (!options.frames.empty()) sequences.push_back(evaluateLabelledFrames(options.frames, options));
  for (const std::string& input : options.inputs) {
    sequences.push_back(isRecord(input) ? evaluateRecord(input, options) : evaluateInput(input, options));
    if (!options.output.empty()) writeCurves(sequences, options.k, options.output);
  }
  if (!options.output.empty()) writeCurves(sequences, options.k, options.output);
  report(sequences, options);
}

}  // namespace

void addEvaluate(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command =
      program.add_subcommand("evaluate", "Measure discovery, inhibition and tracking against the truth");
  command->add_option("INPUT", options->inputs,
                      "sequences to run (as for explore), or records of earlier runs: sessions (*.saccade), candidate "
                      "files (*.jsonl); of several the means are given");
  command->add_option("--frames", options->frames, "instead: single labelled frames, color/ depth/ label/ camera.txt");
  command->add_option("--relocalisation", options->relocalisation,
                      "instead: look for each frame of INPUT in this session; --truth has the true poses of both, "
                      "without it INPUT shows another place");
  command->add_option("--gt", options->labels, "folder of label images NAME.png for all or some frames");
  command->add_option("--gt-every", options->every, "use only each Nth label and propagate it to the frames between")
      ->check(CLI::Range(1, 1000000));
  command->add_flag("--propagate", options->propagate, "carry the labels to frames without any, through the map");
  command->add_option("--write-masks", options->masks, "write the labels of every frame to this folder (--propagate)");
  command->add_option("--truth", options->truth, "TUM trajectory to judge tracking by, instead of the input's poses");
  command->add_option("--poses", options->poses, "believe these poses instead of tracking: \"dataset\" or a TUM file");
  command->add_option("-k,--candidates", options->k, "candidates attended in a frame")->check(CLI::Range(1, 255));
  command->add_flag("--compare", options->compare,
                    "all of the paper's comparisons: colour, depth and both; mf 2, 4, 6; baselines and rivals");
  command->add_flag("--rivals", options->rivals, "OpenCV's Selective Search and Edge Boxes on the same frames");
  command->add_flag("--baselines", options->baselines, "our candidates in other orders: by area, saliency, at random");
  command
      ->add_option("--vary", options->vary, "a run for each value of a setting, for example inhibition.theta=0.2,0.4")
      ->expected(1)
      ->take_all();
  command->add_option("-o,--output", options->output,
                      "folder for index.html with all plots (SVG, PNG) and curves (CSV)");
  command->add_flag("--json", options->json, "print JSON");
  command->add_option("--range", options->range, "frames A:B:STEP of the input, B excluded");
  command->add_option("--config", options->config, "YAML file with settings, see --print-config");
  command->add_option("--set", options->settings, "one setting, for example ranking.max_open=100; may be repeated")
      ->expected(1)
      ->take_all();
  command->add_option("--model", options->model, "ranking model written by saccade train, instead of the built-in one");
  command->add_flag("--paper", options->paper, "the paper's method and nothing beyond it");
  command->add_flag("--no-depth", options->no_depth, "use colour alone (with --frames)");
  command->add_flag("--print-config", options->print_config, "print the effective settings and stop");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
