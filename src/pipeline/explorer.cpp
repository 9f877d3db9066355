#include "saccade/pipeline/explorer.hpp"

#include <stdexcept>
#include <string>
#include <utility>

#include <tbb/parallel_invoke.h>
#include <tbb/task_group.h>

#include "pipeline/stage_clock.hpp"
#include "saccade/discovery/candidate_mask.hpp"
#include "saccade/rendering/back_project.hpp"

namespace saccade {

const char* nameOf(TrackingStatus status) {
  switch (status) {
    case TrackingStatus::kTracked:
      return "tracked";
    case TrackingStatus::kWeak:
      return "weak";
    case TrackingStatus::kLost:
      return "lost";
  }
  return "";
}

namespace {

/// The model is looked at with a camera of half the resolution: tracking uses every second pixel.
constexpr int kModelReduction = 2;

}  // namespace

/// The stages of figure 1 and what they keep from frame to frame.
struct Explorer::Stages {
  Stages(const ExplorerConfig& c, const PinholeCamera& camera_, const std::optional<RankerModel>& model)
      : config(c),
        camera(camera_),
        preparation(c.depth),
        perceiver(c.discovery.perception),
        ranker(model ? Ranker(c.discovery.ranking, *model) : Ranker(c.discovery.ranking)),
        map(c.map),
        surface(c.surface),
        motion(c.motion),
        tracker(c.tracking),
        keyframes(c.keyframes),
        extractor(c.features),
        relocaliser(c.relocalisation, c.verification, c.tracking),
        verifier(c.verification, c.tracking),
        renderer(c.rendering) {}

  ExplorerConfig config;
  PinholeCamera camera;
  DepthPreparation preparation;
  Perceiver perceiver;
  Ranker ranker;
  IorMap map;
  SurfaceVolume surface;
  MotionPredictor motion;
  Tracker tracker;
  KeyframeSet keyframes;
  FeatureExtractor extractor;
  Relocaliser relocaliser;
  PlaceVerifier verifier;
  Renderer renderer;
  BackProjector projector;
  AttendLog log;

  DepthMaps depth;
  ModelView model;
  Perception seen;
  std::vector<LeafKey> forgotten;  ///< leaves that this frame's integration freed

  [[nodiscard]] std::vector<StageTime> perceptionTimes() const;
  Tracking track(double stamp_s, StageClock& clock);
  void relocalise(const RgbdFrame& frame, FrameReport& report, StageClock& clock);
  void remember(std::shared_ptr<const Keyframe> keyframe);
  const IorView* mapFrame(const RgbdFrame& frame, const Tracking& tracking, StageClock& clock);
  [[nodiscard]] bool becomesKeyframe(const Tracking& tracking) const;
  void attend(FrameReport& report);
};

Tracking Explorer::Stages::track(double stamp_s, StageClock& clock) {
  if (depth.depth_m.empty()) return {};  // colour alone cannot be tracked: lost
  const Pose prediction = motion.predict(stamp_s);
  if (surface.empty()) {  // the first frame: W is its camera
    Tracking first;
    first.T_WC = prediction;
    first.status = TrackingStatus::kTracked;
    return first;
  }
  clock.time("model view", [&] { surface.rayCast(camera.reducedBy(kModelReduction), prediction, model); });
  return clock.time("track", [&] { return tracker.track(depth, model, prediction); });
}

/// Looks for a lost camera among the keyframes. If the surface verifies a place, tracking goes on from there.
void Explorer::Stages::relocalise(const RgbdFrame& frame, FrameReport& report, StageClock& clock) {
  if (report.tracking.status != TrackingStatus::kLost || depth.depth_m.empty() || keyframes.all().empty()) return;
  const auto place =
      clock.time("relocalise", [&] { return relocaliser.find(extractor.extract(frame.color, depth), depth, surface); });
  if (!place) return;
  report.tracking = place->tracking;
  report.relocalised = true;
}

void Explorer::Stages::remember(std::shared_ptr<const Keyframe> keyframe) {
  relocaliser.add(keyframe);
  keyframes.add(std::move(keyframe));
}

/// Learns from the frame what its tracking allows, and looks at the map from its pose. Null if the frame is lost.
const IorView* Explorer::Stages::mapFrame(const RgbdFrame& frame, const Tracking& tracking, StageClock& clock) {
  if (tracking.status == TrackingStatus::kLost) return nullptr;
  motion.observe(frame.stamp_s, tracking.T_WC);
  if (tracking.status == TrackingStatus::kTracked && !depth.depth_m.empty()) {
    clock.time("integrate surface", [&] { surface.integrate(depth, tracking.T_WC); });
    forgotten = clock.time("integrate map", [&] { return map.integrate(depth, frame.color, tracking.T_WC).forgotten; });
  }
  return clock.time("2D IOR map", [&] { return &renderer.renderIor(map.view(), camera, tracking.T_WC); });
}

bool Explorer::Stages::becomesKeyframe(const Tracking& tracking) const {
  return tracking.status == TrackingStatus::kTracked && !depth.depth_m.empty() && keyframes.wants(tracking.T_WC);
}

/// Attends the leaves that the masks of the best candidates show, which closes the tick (paper, "3D IOR map update").
void Explorer::Stages::attend(FrameReport& report) {
  const Tick closing = map.now();
  std::vector<std::vector<LeafKey>> leaves(report.attended);
  std::vector<CandidateLeaves> logged;
  std::vector<LeafKey> together;
  for (std::size_t rank = 0; rank < report.attended; ++rank) {
    projector.begin(*report.ior);
    forEachMaskRun(report.open[rank], seen,
                   [&](int v, int begin_u, int end_u) { projector.addRun(v, begin_u, end_u); });
    leaves[rank] = projector.keys();
    report.revisited_share.push_back(log.revisitedShare(leaves[rank], closing));
    logged.push_back({static_cast<int>(rank), leaves[rank]});
    together.insert(together.end(), leaves[rank].begin(), leaves[rank].end());
  }
  AttentionReport attention = map.attend(together);
  log.record({closing, report.index, std::move(attention.flags_on), std::move(forgotten)}, logged);
  forgotten.clear();
}

std::vector<StageTime> Explorer::Stages::perceptionTimes() const {
  const Perceiver::Times& times = perceiver.times();
  return {{"saliency", times.saliency_ms},
          {"salient blobs", times.blobs_ms},
          {"colour segments", times.color_ms},
          {"surface segments", times.surface_ms},
          {"segment tables", times.tables_ms}};
}

Explorer::Explorer(const ExplorerConfig& config, const PinholeCamera& camera, const std::optional<RankerModel>& model)
    : stages_(std::make_unique<Stages>(config, camera, model)) {}

Explorer::~Explorer() = default;

void Explorer::restore(ExplorerMemory memory) {
  stages_->map = std::move(memory.map);
  stages_->surface = std::move(memory.surface);
  stages_->log = std::move(memory.log);
  stages_->motion.restore(memory.motion);
  stages_->keyframes = KeyframeSet(config().keyframes);
  stages_->relocaliser = Relocaliser(config().relocalisation, config().verification, config().tracking);
  for (std::shared_ptr<const Keyframe>& keyframe : memory.keyframes) stages_->remember(std::move(keyframe));
}

std::optional<VerifiedPlace> Explorer::findPlace(const RgbdFrame& frame) {
  if (!prepare(frame)) return std::nullopt;
  Stages& s = *stages_;
  return s.relocaliser.find(s.extractor.extract(frame.color, s.depth), s.depth, s.surface);
}

std::optional<VerifiedPlace> Explorer::verifyPlace(const RgbdFrame& frame, const Pose& guess) {
  if (!prepare(frame)) return std::nullopt;
  return stages_->verifier.verify(stages_->depth, stages_->surface, guess);
}

void Explorer::placeAt(double stamp_s, const Pose& T_WC) {
  MotionPredictor::State state;
  state.known = true;
  state.stamp_s = stamp_s;
  state.T_WC = T_WC;
  stages_->motion.restore(state);
}

const IorMap& Explorer::map() const {
  return stages_->map;
}
IorMap& Explorer::map() {
  return stages_->map;
}
const SurfaceVolume& Explorer::surface() const {
  return stages_->surface;
}
const KeyframeSet& Explorer::keyframes() const {
  return stages_->keyframes;
}
const AttendLog& Explorer::attendLog() const {
  return stages_->log;
}
const MotionPredictor::State& Explorer::motion() const {
  return stages_->motion.state();
}
const ExplorerConfig& Explorer::config() const {
  return stages_->config;
}
const PinholeCamera& Explorer::camera() const {
  return stages_->camera;
}

FrameReport Explorer::process(const RgbdFrame& frame) {
  return processFrame(frame, std::nullopt);
}

FrameReport Explorer::processAt(const RgbdFrame& frame, const std::optional<Pose>& T_WC) {
  Tracking believed;
  believed.status = T_WC ? TrackingStatus::kTracked : TrackingStatus::kLost;
  if (T_WC) believed.T_WC = *T_WC;
  return processFrame(frame, believed);
}

/// Throws unless the frame has a colour image of the camera's size, and no depth image or one of the same size.
void Explorer::requireImages(const RgbdFrame& frame) const {
  const cv::Size expected(camera().width, camera().height);
  const auto text = [](const cv::Size& size) {
    return std::to_string(size.width) + " x " + std::to_string(size.height);
  };
  if (frame.color.size() != expected) {
    throw std::invalid_argument("Explorer: expected a colour image of " + text(expected) + ", found " +
                                text(frame.color.size()));
  }
  if (!frame.depth_m.empty() && frame.depth_m.size() != expected) {
    throw std::invalid_argument("Explorer: expected a depth image of " + text(expected) + ", found " +
                                text(frame.depth_m.size()));
  }
}

/// Fills the depth maps; false, and they are empty, for a frame of colour alone.
bool Explorer::prepare(const RgbdFrame& frame) {
  requireImages(frame);
  Stages& s = *stages_;
  s.depth.depth_m.resize(0);
  if (frame.depth_m.empty()) return false;
  s.preparation.prepare(frame.depth_m, s.camera, s.depth);
  return true;
}

/// Figure 1 of the paper. The attention branch needs only the frame and runs beside the map branch.
FrameReport Explorer::processFrame(const RgbdFrame& frame, const std::optional<Tracking>& believed) {
  Stages& s = *stages_;
  FrameReport report;
  report.index = frame.index;
  report.name = frame.name;
  report.stamp_s = frame.stamp_s;
  StageClock clock;

  const bool has_depth = clock.time("prepare depth", [&] { return prepare(frame); });
  tbb::parallel_invoke([&] { s.perceiver.perceive(frame.color, has_depth ? &s.depth : nullptr, s.seen); },
                       [&] {
                         report.tracking = believed ? *believed : s.track(frame.stamp_s, clock);
                         if (!believed) s.relocalise(frame, report, clock);
                         report.ior = s.mapFrame(frame, report.tracking, clock);
                         if (report.relocalised) s.motion.rest();  // the jump was no motion
                       });
  report.seen = &s.seen;
  report.depth = has_depth ? &s.depth : nullptr;

  tbb::task_group remembering;  // a keyframe's features: beside the ranking, which needs one thread
  if (s.becomesKeyframe(report.tracking)) {
    remembering.run([&] {
      report.keyframe = std::make_shared<const Keyframe>(
          Keyframe{frame.index, frame.stamp_s, report.tracking.T_WC, s.extractor.extract(frame.color, s.depth)});
    });
  }
  Candidates pool = clock.time("propose", [&] { return proposeCandidates(s.seen, s.config.discovery.proposal); });
  const cv::Mat1b inhibited_pixels = report.ior != nullptr ? report.ior->inhibited : cv::Mat1b();
  InhibitionSplit split = clock.time("inhibit", [&] {
    return withoutInhibited(std::move(pool), s.seen, inhibited_pixels, s.config.discovery.inhibition);
  });
  report.open = clock.time("rank", [&] { return s.ranker.rank(std::move(split.open), s.seen); });
  report.attended = std::min(report.open.size(), static_cast<std::size_t>(s.config.discovery.ranking.top_k));
  report.inhibited = std::move(split.inhibited);

  if (report.tracking.status != TrackingStatus::kLost) clock.time("attend", [&] { s.attend(report); });
  remembering.wait();
  if (report.keyframe) s.remember(report.keyframe);
  report.tick = s.map.now();
  report.stages = s.perceptionTimes();
  report.stages.insert(report.stages.end(), clock.stages().begin(), clock.stages().end());
  report.total_ms = clock.total_ms();
  return report;
}

}  // namespace saccade
