#pragma once

#include <span>
#include <vector>

#include <nlohmann/json.hpp>

#include "saccade/map/attend_log.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/session/session_records.hpp"

/// Answers to the page of `saccade view`, as apps/viewer/src/protocol.ts declares them.
namespace saccade {

[[nodiscard]] nlohmann::ordered_json cameraJson(const PinholeCamera& camera);

/// Columns over all frames; `revisit_rates` has one for each.
[[nodiscard]] nlohmann::ordered_json framesJson(std::span<const FrameRecord> frames,
                                                std::span<const double> revisit_rates);

/// A leaf of a map at tick `now`, asked for by the finest `key` inside it, and its attentions.
[[nodiscard]] nlohmann::ordered_json leafJson(const MapLeaf& leaf, LeafKey key, double leaf_size_m, Tick now,
                                              std::span<const AttendedBy> attentions);

}  // namespace saccade
