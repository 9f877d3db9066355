#include "saccade/evaluation/sequence_evaluation.hpp"

#include <map>

#include "saccade/core/config_file.hpp"
#include "saccade/core/distorted_pixels.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/evaluation/discovery_evaluation.hpp"
#include "saccade/pipeline/explorer.hpp"
#include "saccade/sources/label_folder.hpp"
#include "saccade/sources/read_ahead.hpp"

namespace saccade {
namespace {

using PosesByFrame = std::map<std::int64_t, std::optional<Pose>>;

/// Reads a sequence for one run or pass.
std::unique_ptr<FrameSource> open(const std::string& input, const SequenceOptions& options) {
  return openSource(input, options.range, options.labels);
}

/// Collects the labels of the frames as they are read; each nth is given, all are kept as truth.
class LabelCollector {
 public:
  LabelCollector(const SequenceOptions& options, DistortedPixels pixels)
      : pixels_(std::move(pixels)), every_(options.labels_every) {
    if (!options.labels.empty()) folder_.emplace(options.labels);
  }

  void add(const RgbdFrame& frame) {
    const std::optional<cv::Mat1w> label = labelOf(frame);
    if (!label) return;
    truth_.add(frame.name, *label);
    if (count_++ % every_ == 0) given_.add(frame.name, *label);
  }

  [[nodiscard]] const LabelFrames& truth() const { return truth_; }
  [[nodiscard]] const LabelFrames& given() const { return given_; }

 private:
  /// The label in the pixels of the input's image, as it was drawn.
  std::optional<cv::Mat1w> labelOf(const RgbdFrame& frame) {
    if (folder_) return folder_->load(frame.name);
    if (frame.label.empty()) return std::nullopt;
    cv::Mat1w distorted;
    pixels_.distort(frame.label, distorted, std::uint16_t{0});
    return distorted;
  }

  DistortedPixels pixels_;
  std::optional<LabelFolder> folder_;
  int every_;
  int count_ = 0;
  LabelFrames truth_, given_;
};

/// What the first run leaves for the others.
struct FirstRun {
  RunRecording recording;
  PosesByFrame poses;
  LabelFrames given, truth, all;
  std::vector<StampedPose> estimate, true_poses;
  std::optional<LabelAgreement> propagation;
};

RunRecording run(FrameSource& source, const std::string& name, const ExplorerConfig& config,
                 const SequenceOptions& options, const std::function<std::optional<Pose>(const RgbdFrame&)>& poseOf,
                 const std::function<void(const RgbdFrame&, const FrameReport&)>& note,
                 const std::function<void(const Explorer&)>& finish) {
  const SourceDescription& description = source.description();
  Explorer explorer(config, description.camera, options.model);
  RecordingSink sink(CandidateOutliner(DistortedPixels(description.camera, description.color_camera)));
  RgbdFrame frame, next;
  std::int64_t done = 0;
  const auto readFrame = [&](RgbdFrame& into) {
    for (ReadStatus status = source.read(into); status != ReadStatus::kEnd; status = source.read(into)) {
      ++done;
      if (status == ReadStatus::kFrame) return true;
    }
    return false;
  };
  bool more = readFrame(frame);
  for (; more; std::swap(frame, next)) {
    more = readFrame(next);
    const RgbdFrame* ahead = more ? &next : nullptr;
    const FrameReport report =
        poseOf ? explorer.processAt(frame, poseOf(frame), ahead, ahead != nullptr ? poseOf(*ahead) : std::nullopt)
               : explorer.process(frame, ahead);
    sink.accept(frame, report);
    if (note) note(frame, report);
    if (options.on_progress) options.on_progress(name, done, description.frames);
  }
  if (finish) finish(explorer);
  return sink.recording();
}

FirstRun runWithoutInhibition(const std::string& input, const SequenceOptions& options) {
  ReadAhead source(open(input, options));
  const SourceDescription& description = source.description();
  const DistortedPixels pixels(description.camera, description.color_camera);
  LabelCollector labels(options, pixels);
  FirstRun first;
  std::vector<PosedFrame> posed;
  ExplorerConfig config = options.config;
  config.discovery.inhibition.enabled = false;

  std::function<std::optional<Pose>(const RgbdFrame&)> poseOf;
  if (options.poses) poseOf = [&](const RgbdFrame& frame) { return options.poses->find(frame); };
  const auto note = [&](const RgbdFrame& frame, const FrameReport& report) {
    labels.add(frame);
    first.poses[frame.index.value] = report.T_WC();
    if (frame.T_WC) first.true_poses.push_back({frame.stamp_s, *frame.T_WC});
    if (!report.T_WC()) return;
    first.estimate.push_back({frame.stamp_s, *report.T_WC()});
    posed.push_back({frame.name, *report.T_WC()});
  };
  const auto finish = [&](const Explorer& explorer) {
    first.given = labels.given();
    first.truth = labels.truth();
    if (first.given.empty()) throw IoError(input, "labels for some frames (--gt DIR)", "none");
    first.all = first.given;
    if (!options.propagate && options.labels_every == 1) return;
    first.all = propagateLabels(explorer.map(), description.camera, pixels, posed, first.given);
    if (options.labels_every > 1) {
      first.propagation = compareLabels(first.all, first.truth, first.given, posed, options.rules.min_object_area);
    }
  };
  first.recording = run(source, "without IOR", config, options, poseOf, note, finish);
  return first;
}

std::vector<std::pair<std::string, ExplorerConfig>> runsWithInhibition(const SequenceOptions& options) {
  std::vector<std::pair<std::string, ExplorerConfig>> runs = {{"with IOR", options.config}};
  for (const Variation& variation : options.variations) {
    for (const std::string& value : variation.values) {
      ExplorerConfig config = options.config;
      applyConfigSettings({variation.setting + "=" + value}, describing(config));
      runs.emplace_back(variation.setting + " = " + value, config);
    }
  }
  return runs;
}

void judgeTracking(const FirstRun& first, const SequenceOptions& options, SequenceEvaluation& evaluation) {
  std::vector<StampedPose> truth = first.true_poses;
  if (!options.truth.empty()) {
    truth.clear();
    const StampedPoses file = StampedPoses::loadStrictly(options.truth);
    for (std::size_t i = 0; i < file.size(); ++i) truth.push_back({file.stamp(i), file.pose(i)});
  }
  const std::vector<PosePair> pairs = associate(first.estimate, truth);
  constexpr std::size_t kFewestPairs = 3;  // fewer can always be aligned
  if (pairs.size() < kFewestPairs) return;
  evaluation.ate = absoluteError(pairs);
  evaluation.rpe = relativeError(pairs);
}

}  // namespace

SequenceEvaluation evaluateSequence(const std::string& input, const SequenceOptions& options) {
  const auto inhibiting = runsWithInhibition(options);  // first of all: a setting may be wrong

  // 1. Run without inhibition: poses, map, labels for the other frames.
  const FirstRun first = runWithoutInhibition(input, options);
  SequenceEvaluation evaluation;
  evaluation.input = input;
  evaluation.labels = first.all;
  evaluation.propagation = first.propagation;
  for (const RecordedFrame& frame : first.recording.frames) evaluation.lost += frame.tracking == "lost" ? 1 : 0;
  evaluation.frames = static_cast<std::int64_t>(first.recording.frames.size());
  if (!options.poses) judgeTracking(first, options, evaluation);

  // 2. Single labelled frames, by our and by other methods.
  const auto frames = open(input, options);
  evaluation.ignore_from = frames->description().ignore_from;
  EvaluationOptions single;
  single.discovery = options.config.discovery;
  single.model = options.model;
  single.rules = options.rules;
  single.compare = options.compare;
  single.accept = [&](const RgbdFrame& frame) { return first.given.has(frame.name); };
  std::int64_t judged = 0;
  single.on_frame = [&](const EvaluatedFrame&) {
    if (options.on_progress) options.on_progress("single frames", ++judged, std::int64_t(first.given.size()));
  };
  DiscoveryEvaluation discovery = evaluateFrames(*frames, single);
  evaluation.ours = std::move(discovery.ours);
  evaluation.others = std::move(discovery.others);

  // 3. The runs, by the labels of all frames.
  DiscoveryRules rules = options.rules;
  if (evaluation.ignore_from) rules.ignore_from = *evaluation.ignore_from;
  evaluation.runs.push_back({"without IOR", scoreRun(first.recording, evaluation.labels, rules)});
  for (const auto& [name, config] : inhibiting) {
    ReadAhead source(open(input, options));
    const auto poseOf = [&](const RgbdFrame& frame) {
      const auto known = first.poses.find(frame.index.value);
      return known != first.poses.end() ? known->second : std::nullopt;
    };
    const RunRecording recording = run(source, name, config, options, poseOf, {}, {});
    evaluation.runs.push_back({name, scoreRun(recording, evaluation.labels, rules)});
  }
  return evaluation;
}

}  // namespace saccade
