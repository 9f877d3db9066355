#pragma once

#include "saccade/map/view_region.hpp"

namespace saccade {

/// Keeps parts of an exploration's map elsewhere while the camera is away from them.
class MapPager {
 public:
  MapPager() = default;
  virtual ~MapPager() = default;
  MapPager(const MapPager&) = delete;
  MapPager& operator=(const MapPager&) = delete;

  /// Afterwards every part of the octree and of the surface volume that `region` touches is in memory, exactly as it
  /// was when it was put away. Called on the mapping thread, before each look at the map.
  virtual void bringBack(const ViewRegion& region) = 0;
  /// Whether nothing is put away: the map in memory is all there is.
  [[nodiscard]] virtual bool holdsNothing() const = 0;
};

}  // namespace saccade
