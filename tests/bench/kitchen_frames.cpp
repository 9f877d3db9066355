#include "bench/kitchen_frames.hpp"

#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "saccade/sources/frame_source.hpp"

namespace saccade::bench {
namespace {

KitchenFrames readFrames() {
  const std::filesystem::path folder = std::filesystem::path(SACCADE_TEST_DATA_DIR) / "kitchen";
  if (!std::filesystem::exists(folder)) {
    std::cerr << folder.string() << ": expected the kitchen sequence, found no such folder\n";
    std::exit(EXIT_FAILURE);
  }
  const auto source = openSource(folder.string(), FrameRange::parse("0:250:5"));
  KitchenFrames kitchen;
  kitchen.camera = source->description().camera;
  RgbdFrame frame;
  for (ReadStatus status = source->read(frame); status != ReadStatus::kEnd; status = source->read(frame)) {
    if (status != ReadStatus::kFrame) continue;
    kitchen.frames.push_back(frame);
    kitchen.frames.back().color = frame.color.clone();
    kitchen.frames.back().depth_m = frame.depth_m.clone();
  }
  return kitchen;
}

}  // namespace

const KitchenFrames& kitchenFrames() {
  static const KitchenFrames kitchen = readFrames();
  return kitchen;
}

}  // namespace saccade::bench
