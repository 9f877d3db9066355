#pragma once

#include "saccade/core/config_fields.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/discovery/discovery_config.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/surface_volume.hpp"
#include "saccade/rendering/depth_completion.hpp"
#include "saccade/rendering/renderer.hpp"
#include "saccade/tracking/frame_features.hpp"
#include "saccade/tracking/keyframe_set.hpp"
#include "saccade/tracking/motion_predictor.hpp"
#include "saccade/tracking/relocaliser.hpp"
#include "saccade/tracking/tracker.hpp"

namespace saccade {

/// Every setting of the pipeline, stage by stage; what `--config`, `--set` and `--print-config` speak of.
struct ExplorerConfig {
  DepthPreparationConfig depth;
  DiscoveryConfig discovery;
  IorMapConfig map;
  RendererConfig rendering;
  SurfaceVolumeConfig surface;
  DepthCompletionConfig completion;
  MotionPredictorConfig motion;
  TrackerConfig tracking;
  PhotometricReferenceConfig photometric;
  KeyframeConfig keyframes;
  FeatureExtractorConfig features;
  RelocaliserConfig relocalisation;
  PlaceVerifierConfig verification;

  void describe(ConfigVisitor& visitor) {
    visitor.section("depth", depth, "preparation of the depth image");
    discovery.describe(visitor);
    visitor.section("map", map, "the octree: leaves, sensor model, inhibition of return");
    visitor.section("rendering", rendering, "the 2D IOR map's rays");
    visitor.section("surface", surface, "the surface volume: what tracking aligns frames to");
    visitor.section("completion", completion, "depth where the depth camera's view ends, from the surface volume");
    visitor.section("motion", motion, "prediction of the camera's motion");
    visitor.section("tracking", tracking, "ICP, frame to model");
    visitor.section("photometric", photometric, "the earlier frame whose colour helps tracking");
    visitor.section("keyframes", keyframes, "which tracked frames are remembered, to find a place again");
    visitor.section("features", features, "point features of keyframes");
    visitor.section("relocalisation", relocalisation, "finding a lost camera by keyframes");
    visitor.section("verification", verification, "what the surface must say to a place that was found");
  }

  /// Switches off everything in discovery, attention and tracking that goes beyond the paper.
  void usePaperOnly() {
    tracking.grey_levels_per_mm = 0.0;
    discovery.usePaperOnly();
    completion.enabled = false;
    map.attend_blocks = false;
  }
};

}  // namespace saccade
