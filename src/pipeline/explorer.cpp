#include "saccade/pipeline/explorer.hpp"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include <tbb/task_arena.h>

#include "pipeline/errand.hpp"
#include "pipeline/frame_looks.hpp"
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

/// What tracking found for the frame that comes next, ahead of its turn.
struct TrackedAhead {
  Pose prediction;  ///< what it began with
  Tracking tracking;
  StageClock clock;
};

/// The pose that the caller says a frame has, as tracking would say it; none: the frame counts as lost.
Tracking believing(const std::optional<Pose>& T_WC) {
  Tracking believed;
  believed.status = T_WC ? TrackingStatus::kTracked : TrackingStatus::kLost;
  if (T_WC) believed.T_WC = *T_WC;
  return believed;
}

}  // namespace

/// The frame that comes next, if it is known, and its pose, if that is to be believed.
struct Explorer::NextFrame {
  const RgbdFrame* frame = nullptr;
  std::optional<Tracking> believed;
};

/// The stages of figure 1 and what they keep from frame to frame.
struct Explorer::Stages {
  Stages(const ExplorerConfig& c, const PinholeCamera& camera_, const std::optional<RankerModel>& model)
      : config(c),
        camera(camera_),
        looks(c, camera_),
        ranker(model ? Ranker(c.discovery.ranking, *model) : Ranker(c.discovery.ranking)),
        map(c.map),
        surface(c.surface),
        motion(c.motion),
        tracker(c.tracking),
        reference(c.photometric),
        keyframes(c.keyframes),
        extractor(c.features),
        relocaliser(c.relocalisation, c.verification, c.tracking),
        verifier(c.verification, c.tracking),
        renderer(c.rendering) {}

  ExplorerConfig config;
  PinholeCamera camera;
  FrameLooks looks;
  Ranker ranker;
  IorMap map;
  SurfaceVolume surface;
  MotionPredictor motion;
  Tracker tracker;
  PhotometricReference reference;  ///< what the colour of the next frame is compared with
  KeyframeSet keyframes;
  FeatureExtractor extractor;
  Relocaliser relocaliser;
  PlaceVerifier verifier;
  Renderer renderer;
  BackProjector projector;
  AttendLog log;

  MapPager* pager = nullptr;

  ModelView model;
  std::optional<TrackedAhead> ahead;                  ///< void once the surface or the motion is changed from outside
  std::vector<LeafKey> forgotten;                     ///< leaves that this frame's integration freed
  std::vector<std::vector<LeafKey>> attended_leaves;  ///< recycled: leaves by candidate, and their union
  std::vector<LeafKey> together;
  StageClock surface_clock;  ///< of what is done to the surface volume beside the rest
  Errand of_surface, of_keyframe;

  /// Whatever happens, nothing goes on beside when a frame is over.
  struct Settling {
    Stages& stages;
    ~Settling() {
      stages.of_surface.settle();
      stages.of_keyframe.settle();
    }
  };

  void bringBack(const Pose& T_WC);
  Tracking track(const FrameLook& look, double stamp_s, StageClock& clock);
  Tracking follow(const FrameLook& look, const Pose& prediction, StageClock& clock);
  void trackAhead(const Pose& prediction);
  [[nodiscard]] std::optional<Pose> completedFrom(const Tracking& tracking) const;
  void relocalise(const RgbdFrame& frame, const DepthMaps& depth, FrameReport& report, StageClock& clock);
  void renewReference(const FrameLook& look, const Tracking& tracking);
  void remember(std::shared_ptr<const Keyframe> keyframe);
  void lookAhead(const NextFrame& next);
  const IorView* mapFrame(const RgbdFrame& frame, const FrameLook& look, const Tracking& tracking,
                          const NextFrame& next, StageClock& clock);
  FrameLook& lookAndMap(const RgbdFrame& frame, const std::optional<Tracking>& believed, const NextFrame& next,
                        FrameReport& report, StageClock& clock);
  [[nodiscard]] bool becomesKeyframe(const FrameLook& look, const Tracking& tracking) const;
  InhibitionSplit inhibit(FrameLook& look, const IorView* ior) const;
  void attend(FrameReport& report);
};

/// Has everything in memory that a look or an integration at `T_WC` can touch.
void Explorer::Stages::bringBack(const Pose& T_WC) {
  if (pager == nullptr) return;
  const double band_m = config.surface.band_cells * config.surface.cell_m;
  const double brick_m = SurfaceBrick::kSide * config.surface.cell_m;
  const double farthest_m =
      std::max({config.map.max_range_m, config.surface.max_range_m + band_m, config.rendering.far_m});
  // Points at the image's edge have leaves, and bands of bricks, that reach beyond the frustum.
  const double margin_m = band_m + 2.0 * brick_m + config.map.leaf_size_m;
  pager->bringBack(ViewRegion(camera, T_WC, farthest_m, margin_m));
}

Tracking Explorer::Stages::track(const FrameLook& look, double stamp_s, StageClock& clock) {
  if (!look.has_depth) return {};  // colour alone cannot be tracked: lost
  const Pose prediction = motion.predict(stamp_s);
  if (const auto done = std::exchange(ahead, std::nullopt); done && done->prediction.matrix() == prediction.matrix()) {
    clock.add(done->clock.stages());
    return done->tracking;
  }
  bringBack(prediction);
  const bool all_here = pager == nullptr || pager->holdsNothing();
  if (surface.empty() && all_here) {  // the first frame: W is its camera
    Tracking first;
    first.T_WC = prediction;
    first.status = TrackingStatus::kTracked;
    return first;
  }
  return follow(look, prediction, clock);
}

Tracking Explorer::Stages::follow(const FrameLook& look, const Pose& prediction, StageClock& clock) {
  clock.time("model view", [&] { surface.rayCast(camera.reducedBy(kModelReduction), prediction, model); });
  const TrackedColor color{look.intensity, reference};
  return clock.time("track", [&] { return tracker.track(look.depth, model, prediction, &color); });
}

/// Tracks the frame that the looks have ahead. That needs the surface volume, which has learnt from the frame before it
/// long before the octree has.
void Explorer::Stages::trackAhead(const Pose& prediction) {
  ahead.reset();
  const FrameLook& look = looks.depthAhead();
  if (!look.has_depth || surface.empty()) return;
  TrackedAhead found{prediction, {}, {}};
  found.tracking = follow(look, prediction, found.clock);
  ahead = found;
}

/// Where the map is asked to complete a frame's depth: it must be as sure of the pose as to learn from the frame.
std::optional<Pose> Explorer::Stages::completedFrom(const Tracking& tracking) const {
  if (!config.completion.enabled || tracking.status != TrackingStatus::kTracked) return std::nullopt;
  return tracking.T_WC;
}

/// Tracks and perceives the frame that comes next, as far as that can be done before its turn. Beside the octree.
void Explorer::Stages::lookAhead(const NextFrame& next) {
  // Who pages brings parts of the surface back to where the map is looked at, too.
  const bool sees_surface = pager == nullptr;
  if (next.frame == nullptr || (!sees_surface && config.completion.enabled)) return;
  if (next.believed) {
    looks.perceiveAhead(surface, completedFrom(*next.believed));
    return;
  }
  if (sees_surface) trackAhead(motion.predict(next.frame->stamp_s));
  looks.perceiveAhead(surface, ahead ? completedFrom(ahead->tracking) : std::nullopt);
}

/// Looks for a lost camera among the keyframes. If the surface verifies a place, tracking goes on from there.
void Explorer::Stages::relocalise(const RgbdFrame& frame, const DepthMaps& depth, FrameReport& report,
                                  StageClock& clock) {
  if (report.tracking.status != TrackingStatus::kLost || depth.depth_m.empty() || keyframes.all().empty()) return;
  const auto place =
      clock.time("relocalise", [&] { return relocaliser.find(extractor.extract(frame.color, depth), depth, surface); });
  if (!place) return;
  report.tracking = place->tracking;
  report.relocalised = true;
}

/// Lets the frame be what the colour of later ones is compared with, if another is due and its pose is good.
void Explorer::Stages::renewReference(const FrameLook& look, const Tracking& tracking) {
  const bool compares = config.tracking.grey_levels_per_mm > 0.0 && look.has_depth;
  if (!compares || tracking.status != TrackingStatus::kTracked || !reference.wants(tracking.T_WC)) return;
  reference.take(look.depth, look.intensity, tracking.T_WC);
}

void Explorer::Stages::remember(std::shared_ptr<const Keyframe> keyframe) {
  relocaliser.add(keyframe);
  keyframes.add(std::move(keyframe));
}

/// Learns from the frame what its tracking allows, and looks at the map from its pose. Null if the frame is lost. The
/// surface volume, which knows nothing of attention, learns beside the octree; then the next frame is looked at there.
const IorView* Explorer::Stages::mapFrame(const RgbdFrame& frame, const FrameLook& look, const Tracking& tracking,
                                          const NextFrame& next, StageClock& clock) {
  const bool is_lost = tracking.status == TrackingStatus::kLost;
  const bool integrates = tracking.status == TrackingStatus::kTracked && look.has_depth;
  if (!is_lost) motion.observe(frame.stamp_s, tracking.T_WC);
  surface_clock = StageClock();
  of_surface.offer([this, &look, T_WC = tracking.T_WC, integrates, &next] {
    if (integrates) surface_clock.time("integrate surface", [&] { surface.integrate(look.depth, T_WC); });
    lookAhead(next);
  });
  if (next.frame != nullptr) looks.perceiveColorAhead();  // after the surface, which more waits for
  if (is_lost) return nullptr;
  if (integrates) {
    forgotten =
        clock.time("integrate map", [&] { return map.integrate(look.depth, frame.color, tracking.T_WC).forgotten; });
  }
  return clock.time("2D IOR map", [&] { return &renderer.renderIor(map.view(), camera, tracking.T_WC); });
}

bool Explorer::Stages::becomesKeyframe(const FrameLook& look, const Tracking& tracking) const {
  return tracking.status == TrackingStatus::kTracked && look.has_depth && keyframes.wants(tracking.T_WC);
}

/// Splits the look's pool by what the map remembers at the frame's pose; a lost frame has no `ior`.
InhibitionSplit Explorer::Stages::inhibit(FrameLook& look, const IorView* ior) const {
  const InhibitionConfig& inhibition = config.discovery.inhibition;
  if (ior == nullptr) return {std::move(look.pool), {}};
  InhibitionSplit split = withoutInhibited(std::move(look.pool), look.seen, ior->inhibited, inhibition);
  if (inhibition.enabled) noteFamiliar(split.open, look.seen, ior->familiar);
  return split;
}

/// Attends the leaves that the masks of the best candidates show, which closes the tick (paper, "3D IOR map update").
void Explorer::Stages::attend(FrameReport& report) {
  const Tick closing = map.now();
  if (attended_leaves.size() < report.attended) attended_leaves.resize(report.attended);
  std::vector<CandidateLeaves> logged;
  projector.begin(*report.ior);
  for (std::size_t rank = 0; rank < report.attended; ++rank) {
    std::vector<LeafKey>& leaves = attended_leaves[rank];
    projector.beginMask();
    forEachMaskRun(report.open[rank], *report.seen,
                   [&](int v, int begin_u, int end_u) { projector.addRun(v, begin_u, end_u); });
    projector.keys(leaves);
    report.revisited_share.push_back(log.revisitedShare(leaves, closing));
    logged.push_back({static_cast<int>(rank), leaves});
  }
  projector.allKeys(together);
  AttentionReport attention = map.attend(together);
  log.record({closing, report.index, std::move(attention.flags_on), std::move(forgotten)}, logged);
  forgotten.clear();
}

Explorer::Explorer(const ExplorerConfig& config, const PinholeCamera& camera, const std::optional<RankerModel>& model)
    : stages_(std::make_unique<Stages>(config, camera, model)) {}

Explorer::~Explorer() = default;

void Explorer::restore(ExplorerMemory memory) {
  stages_->ahead.reset();
  stages_->map = std::move(memory.map);
  stages_->surface = std::move(memory.surface);
  stages_->log = std::move(memory.log);
  stages_->motion.restore(memory.motion);
  stages_->reference = PhotometricReference(config().photometric);
  if (memory.reference) stages_->reference.restore(std::move(*memory.reference));
  stages_->keyframes = KeyframeSet(config().keyframes);
  stages_->relocaliser = Relocaliser(config().relocalisation, config().verification, config().tracking);
  for (std::shared_ptr<const Keyframe>& keyframe : memory.keyframes) stages_->remember(std::move(keyframe));
  pageBy(stages_->pager);
}

void Explorer::pageBy(MapPager* pager) {
  Stages& s = *stages_;
  s.ahead.reset();
  s.pager = pager;
  s.relocaliser.beforeEachLook([&s](const Pose& T_WC) { s.bringBack(T_WC); });
  s.verifier.beforeEachLook([&s](const Pose& T_WC) { s.bringBack(T_WC); });
}

std::optional<VerifiedPlace> Explorer::findPlace(const RgbdFrame& frame) {
  requireImages(frame);
  Stages& s = *stages_;
  const FrameLook& look = s.looks.take(frame);
  if (!look.has_depth) return std::nullopt;
  return s.relocaliser.find(s.extractor.extract(frame.color, look.depth), look.depth, s.surface);
}

std::optional<VerifiedPlace> Explorer::verifyPlace(const RgbdFrame& frame, const Pose& guess) {
  requireImages(frame);
  Stages& s = *stages_;
  const FrameLook& look = s.looks.take(frame);
  if (!look.has_depth) return std::nullopt;
  return s.verifier.verify(look.depth, s.surface, guess);
}

void Explorer::placeAt(double stamp_s, const Pose& T_WC) {
  stages_->ahead.reset();
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
SurfaceVolume& Explorer::surface() {
  stages_->ahead.reset();  // it may change
  return stages_->surface;
}
const KeyframeSet& Explorer::keyframes() const {
  return stages_->keyframes;
}
const AttendLog& Explorer::attendLog() const {
  return stages_->log;
}
AttendLog& Explorer::attendLog() {
  return stages_->log;
}
const MotionPredictor::State& Explorer::motion() const {
  return stages_->motion.state();
}
const PhotometricReference& Explorer::photometricReference() const {
  return stages_->reference;
}
const ExplorerConfig& Explorer::config() const {
  return stages_->config;
}
const PinholeCamera& Explorer::camera() const {
  return stages_->camera;
}

FrameReport Explorer::process(const RgbdFrame& frame, const RgbdFrame* next) {
  return processFrame(frame, std::nullopt, {next, std::nullopt});
}

FrameReport Explorer::processAt(const RgbdFrame& frame, const std::optional<Pose>& T_WC, const RgbdFrame* next,
                                const std::optional<Pose>& next_T_WC) {
  return processFrame(frame, believing(T_WC), {next, believing(next_T_WC)});
}

/// Whether the frame has a colour image of the camera's size, and no depth image or one of the same size.
bool Explorer::hasCameraSize(const RgbdFrame& frame) const {
  const cv::Size expected(camera().width, camera().height);
  return frame.color.size() == expected && (frame.depth_m.empty() || frame.depth_m.size() == expected);
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

/// Tracks and maps the frame beside the look at it, which waits for its pose only and was mostly begun ahead.
FrameLook& Explorer::Stages::lookAndMap(const RgbdFrame& frame, const std::optional<Tracking>& believed,
                                        const NextFrame& next, FrameReport& report, StageClock& clock) {
  if (!looks.isAnnounced(frame)) ahead.reset();  // of another frame
  FrameLook& look = looks.take(frame);
  if (!config.completion.enabled) looks.perceive(surface, std::nullopt);  // that need not wait for the pose
  if (next.frame != nullptr) looks.announce(*next.frame);
  report.tracking = believed ? *believed : track(look, frame.stamp_s, clock);
  if (!believed) {
    relocalise(frame, look.depth, report, clock);
    renewReference(look, report.tracking);
  }
  if (report.T_WC()) bringBack(report.tracking.T_WC);
  looks.perceive(surface, completedFrom(report.tracking));
  report.ior = mapFrame(frame, look, report.tracking, next, clock);
  if (report.relocalised) motion.rest();           // the jump was no motion
  if (!looks.isPerceived()) of_surface.attempt();  // better than to wait
  clock.time("wait for perception", [&] { looks.waitUntilPerceived(); });
  return look;
}

/// Figure 1 of the paper.
FrameReport Explorer::processFrame(const RgbdFrame& frame, const std::optional<Tracking>& believed, NextFrame next) {
  Stages& s = *stages_;
  requireImages(frame);
  if (next.frame != nullptr && !hasCameraSize(*next.frame)) next.frame = nullptr;  // its own call says what is wrong
  FrameReport report;
  report.index = frame.index;
  report.name = frame.name;
  report.stamp_s = frame.stamp_s;
  StageClock clock;
  const Stages::Settling at_end{s};

  FrameLook& look = s.lookAndMap(frame, believed, next, report, clock);
  report.seen = &look.seen;
  report.depth = look.perceivedDepth();

  if (s.becomesKeyframe(look, report.tracking)) {
    s.of_keyframe.offer([&] {
      report.keyframe = std::make_shared<const Keyframe>(
          Keyframe{frame.index, frame.stamp_s, report.tracking.T_WC, s.extractor.extract(frame.color, look.depth)});
    });
  }
  InhibitionSplit split = clock.time("inhibit", [&] { return s.inhibit(look, report.ior); });
  report.open = clock.time("rank", [&] {
    return tbb::this_task_arena::isolate([&] { return s.ranker.rank(std::move(split.open), look.seen); });
  });
  report.attended = std::min(report.open.size(), static_cast<std::size_t>(s.config.discovery.ranking.top_k));
  report.inhibited = std::move(split.inhibited);

  if (report.tracking.status != TrackingStatus::kLost) clock.time("attend", [&] { s.attend(report); });
  s.of_surface.finish();
  s.of_keyframe.finish();
  if (report.keyframe) s.remember(report.keyframe);
  report.tick = s.map.now();
  report.stages = look.times;
  for (const StageClock* branch : {&s.surface_clock, &clock}) {
    report.stages.insert(report.stages.end(), branch->stages().begin(), branch->stages().end());
  }
  report.total_ms = clock.total_ms();
  return report;
}

}  // namespace saccade
