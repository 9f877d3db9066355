#include "bench/prepared_frames.hpp"

namespace saccade::bench {

const std::vector<PreparedFrame>& preparedFrames() {
  static const std::vector<PreparedFrame> prepared = [] {
    const KitchenFrames& kitchen = kitchenFrames();
    std::vector<PreparedFrame> frames(kitchen.frames.size());
    DepthPreparation preparation;
    for (std::size_t i = 0; i < frames.size(); ++i) {
      preparation.prepare(kitchen.frames[i].depth_m, kitchen.camera, frames[i].depth);
      frames[i].color = kitchen.frames[i].color;
      frames[i].T_WC = kitchen.frames[i].T_WC.value();
    }
    return frames;
  }();
  return prepared;
}

SurfaceVolume surfaceOfKitchen() {
  SurfaceVolume volume;
  for (const PreparedFrame& frame : preparedFrames()) volume.integrate(frame.depth, frame.T_WC);
  return volume;
}

IorMap mapOfKitchen() {
  IorMap map;
  for (const PreparedFrame& frame : preparedFrames()) map.integrate(frame.depth, frame.color, frame.T_WC);
  return map;
}

}  // namespace saccade::bench
