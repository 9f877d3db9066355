#pragma once

#include <functional>
#include <memory>
#include <utility>
#include <vector>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "saccade/map/attend_log.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/map/surface_volume.hpp"
#include "saccade/pipeline/explorer_config.hpp"
#include "saccade/session/session_reader.hpp"
#include "saccade/tracking/keyframe_set.hpp"

/// What a session holds, as the objects that it was made from. All throw IoError where the session is damaged.
namespace saccade {

/// Part of the world that is to be loaded.
class MapRegion {
 public:
  [[nodiscard]] static MapRegion everything();
  [[nodiscard]] static MapRegion nothing();
  /// What touches the box, in W, metres.
  [[nodiscard]] static MapRegion box(const Eigen::AlignedBox3d& box_W);
  /// What comes within `radius_m` of the point.
  [[nodiscard]] static MapRegion ball(const Eigen::Vector3d& centre_W, double radius_m);

  [[nodiscard]] bool touches(const Eigen::AlignedBox3d& box_W) const { return touches_(box_W); }

 private:
  explicit MapRegion(std::function<bool(const Eigen::AlignedBox3d&)> touches) : touches_(std::move(touches)) {}

  std::function<bool(const Eigen::AlignedBox3d&)> touches_;
};

/// The effective configuration of the session's last run.
[[nodiscard]] ExplorerConfig loadConfig(const SessionReader& session);

/// The map with its attention memory at the session's tick: the whole tiles that touch `region`.
[[nodiscard]] IorMap loadMap(const SessionReader& session, const MapRegion& region = MapRegion::everything());

/// Calls `visit` for each tile of the map, in any order, with its root and a map of nothing but this tile: for who asks
/// leaf by leaf and need not have the whole map in memory.
void visitMapTiles(const SessionReader& session,
                   const std::function<void(const NodeKey& root, const IorMap& tile)>& visit);

/// The surface volume: the whole bricks that touch `region`.
[[nodiscard]] SurfaceVolume loadSurface(const SessionReader& session,
                                        const MapRegion& region = MapRegion::everything());

/// The record of every attention. It grows with the length of an exploration: tens of KiB a frame.
[[nodiscard]] AttendLog loadAttendLog(const SessionReader& session);

/// Which leaves were ever attended, without the record: what going on needs. It grows with the map alone.
[[nodiscard]] AttendLog loadAttendedLeaves(const SessionReader& session);

/// Calls `visit` for each tick, oldest first, of a log that has one tick at hand at a time: the one with the number
/// `tick`. Returns what loadAttendedLeaves() does.
AttendLog visitAttendLog(const SessionReader& session,
                         const std::function<void(const AttendLog& log, std::size_t tick)>& visit);

/// The keyframes with their features, in the order in which they came; without images.
[[nodiscard]] std::vector<std::shared_ptr<const Keyframe>> loadKeyframes(const SessionReader& session);

}  // namespace saccade
