#include "inspection/view_json.hpp"

#include <cmath>

namespace saccade {
namespace {

using nlohmann::ordered_json;

ordered_json poseJson(const Pose& T_WC) {
  const Eigen::Vector3d t = T_WC.translation();
  const Eigen::Quaterniond q(T_WC.rotation());
  return {t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w()};
}

}  // namespace

ordered_json cameraJson(const PinholeCamera& camera) {
  return {{"width", camera.width}, {"height", camera.height}, {"fx", camera.fx},
          {"fy", camera.fy},       {"cx", camera.cx},         {"cy", camera.cy}};
}

ordered_json framesJson(std::span<const FrameRecord> frames, std::span<const double> revisit_rates) {
  ordered_json json = {
      {"name", ordered_json::array()},      {"stamp_s", ordered_json::array()},  {"tracking", ordered_json::array()},
      {"pose", ordered_json::array()},      {"tick", ordered_json::array()},     {"open", ordered_json::array()},
      {"inhibited", ordered_json::array()}, {"attended", ordered_json::array()}, {"ms", ordered_json::array()},
      {"rms_m", ordered_json::array()},     {"revisit", ordered_json::array()}};
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const FrameRecord& frame = frames[i];
    json["name"].push_back(frame.name);
    json["stamp_s"].push_back(frame.stamp_s);
    json["tracking"].push_back(frame.tracking);
    json["pose"].push_back(frame.T_WC ? poseJson(*frame.T_WC) : ordered_json(nullptr));
    json["tick"].push_back(frame.tick);
    json["open"].push_back(frame.open);
    json["inhibited"].push_back(frame.inhibited);
    json["attended"].push_back(frame.attended);
    json["ms"].push_back(frame.processing_ms);
    json["rms_m"].push_back(frame.rms_m);
    json["revisit"].push_back(revisit_rates[i]);
  }
  return json;
}

ordered_json leafJson(const MapLeaf& leaf, LeafKey key, double leaf_size_m, Tick now,
                      std::span<const AttendedBy> attentions) {
  const double edge_m = leaf_size_m * (1 << (MapTree::kDepth - leaf.key.depth));
  const auto low = [&](std::uint16_t part) { return (part - MapTree::kCentreKey) * leaf_size_m; };
  const Eigen::Vector3f normal = leaf.surface.normal();
  ordered_json looks = ordered_json::array();
  for (const AttendedBy& look : attentions) {
    looks.push_back({{"tick", look.tick.value}, {"frame", look.frame.value}, {"rank", look.rank}});
  }
  return {{"key", {key.x, key.y, key.z}},
          {"low_m", {low(leaf.key.corner.x), low(leaf.key.corner.y), low(leaf.key.corner.z)}},
          {"edge_m", edge_m},
          {"state", leaf.occupied ? "occupied" : "free"},
          {"occupancy", 1.0 / (1.0 + std::exp(-static_cast<double>(leaf.log_odds)))},
          {"log_odds", leaf.log_odds},
          {"color", {leaf.surface.red, leaf.surface.green, leaf.surface.blue}},
          {"normal", {normal.x(), normal.y(), normal.z()}},
          {"observations", leaf.surface.observations},
          {"tick", now.value},
          {"ior_weight", weight(leaf.ior, now)},
          {"inhibited", inhibited(leaf.ior, now)},
          {"forgotten_at_tick", weight(leaf.ior, now) > 0 ? ordered_json(leaf.ior.expiry()) : ordered_json(nullptr)},
          {"attentions", looks}};
}

}  // namespace saccade
