#include "saccade/exchange/session_alignment.hpp"

#include <algorithm>
#include <memory>
#include <vector>

#include "saccade/core/depth_maps.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/tracking/frame_features.hpp"
#include "saccade/tracking/relocaliser.hpp"

namespace saccade {
namespace {

constexpr double kAgreement_m = 0.05;
constexpr double kAgreement_rad = 3.0 * 3.14159265358979323846 / 180.0;
constexpr std::size_t kMostQueries = 60;

/// A relocaliser that knows the keyframes of a session.
Relocaliser relocaliserOf(const SessionReader& session, const ExplorerConfig& config) {
  Relocaliser relocaliser(config.relocalisation, config.verification, config.tracking);
  for (const KeyframeRecord& record : session.keyframes()) {
    auto features = decodeFeatures(record.features);
    if (!features) throw IoError(session.path(), "features that can be read in every keyframe", "others");
    auto keyframe = std::make_shared<Keyframe>();
    keyframe->index = {record.ordinal.value};
    keyframe->T_WC = record.T_WC;
    keyframe->features = std::move(*features);
    relocaliser.add(std::move(keyframe));
  }
  return relocaliser;
}

bool agree(const Pose& a, const Pose& b) {
  const Pose between = a.inverse() * b;
  return between.translation().norm() <= kAgreement_m && Eigen::AngleAxisd(between.linear()).angle() <= kAgreement_rad;
}

}  // namespace

std::optional<SessionAlignment> alignSessions(const SessionReader& a, const SessionReader& b) {
  const ExplorerConfig config = loadConfig(a);
  Relocaliser relocaliser = relocaliserOf(a, config);
  const SurfaceVolume surface = loadSurface(a);
  DepthPreparation preparation(config.depth);
  std::vector<Pose> found;
  const std::vector<KeyframeRecord> queries = b.keyframes();
  const std::size_t step = 1 + queries.size() / kMostQueries;
  for (std::size_t i = 0; i < queries.size(); i += step) {
    const auto features = decodeFeatures(queries[i].features);
    if (!features) throw IoError(b.path(), "features that can be read in every keyframe", "others");
    const auto images = b.keyframe(queries[i].ordinal);
    if (!images || images->depth_m.empty()) continue;  // thinned to save room
    DepthMaps depth;
    preparation.prepare(images->depth_m, b.metadata().camera, depth);
    const auto place = relocaliser.find(*features, depth, surface);
    if (place) found.push_back(place->tracking.T_WC * queries[i].T_WC.inverse());
  }
  SessionAlignment best;
  best.found = static_cast<int>(found.size());
  for (const Pose& T_AB : found) {
    const auto agreeing =
        std::count_if(found.begin(), found.end(), [&](const Pose& other) { return agree(T_AB, other); });
    if (agreeing <= best.agreeing) continue;
    best.agreeing = static_cast<int>(agreeing);
    best.T_AB = T_AB;
  }
  if (best.agreeing < 2 || 2 * best.agreeing <= best.found) return std::nullopt;
  return best;
}

}  // namespace saccade
