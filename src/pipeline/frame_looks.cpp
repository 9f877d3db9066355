#include "pipeline/frame_looks.hpp"

#include <utility>

#include <tbb/task_arena.h>

#include "pipeline/stage_clock.hpp"

namespace saccade {

void FrameLooks::assign(Slot& slot, const RgbdFrame& frame) {
  slot.errand.settle();
  slot.frame = frame;
  slot.prepared.emplace();
  slot.is_begun = false;
}

void FrameLooks::announce(const RgbdFrame& next) {
  assign(slots_[1 - current_], next);
}

bool FrameLooks::isAnnounced(const RgbdFrame& frame) const {
  const RgbdFrame& announced = slots_[1 - current_].frame;
  return !announced.color.empty() && announced.index == frame.index && announced.color.data == frame.color.data &&
         announced.depth_m.data == frame.depth_m.data;
}

FrameLook& FrameLooks::take(const RgbdFrame& frame) {
  Slot& slot = slots_[1 - current_];
  if (!isAnnounced(frame)) assign(slot, frame);
  current_ = 1 - current_;
  prepare(slot);
  return slot.look;
}

void FrameLooks::prepare(Slot& slot) const {
  // Preparing starts no tasks: a thread that waited for some could run one that asks for these same maps.
  std::call_once(*slot.prepared, [&] {
    FrameLook& look = slot.look;
    look.times.clear();
    look.has_depth = !slot.frame.depth_m.empty();
    look.depth.depth_m.resize(0);
    if (!look.has_depth) return;
    StageClock clock;
    clock.time("prepare depth", [&] { slot.preparation.prepare(slot.frame.depth_m, camera_, look.depth); });
    clock.time("grey values", [&] { look.intensity.build(slot.frame.color, camera_); });
    look.times = clock.stages();
  });
}

void FrameLooks::begin(Slot& slot) {
  if (slot.frame.color.empty() || std::exchange(slot.is_begun, true)) return;
  slot.errand.offer([this, &slot] { perceive(slot); });
}

void FrameLooks::perceive(Slot& slot) const {
  prepare(slot);
  FrameLook& look = slot.look;
  // Isolated: whoever waits for a part of this does nothing else meanwhile, which would take as long as it takes.
  tbb::this_task_arena::isolate(
      [&] { slot.perceiver.perceive(slot.frame.color, look.has_depth ? &look.depth : nullptr, look.seen); });
  const Perceiver::Times& times = slot.perceiver.times();
  look.times.insert(look.times.end(), {{"saliency", times.saliency_ms},
                                       {"salient blobs", times.blobs_ms},
                                       {"colour segments", times.color_ms},
                                       {"surface segments", times.surface_ms},
                                       {"segment tables", times.tables_ms}});
  StageClock clock;
  look.pool = clock.time("propose", [&] { return slot.proposer.propose(look.seen); });
  look.times.insert(look.times.end(), clock.stages().begin(), clock.stages().end());
}

void FrameLooks::waitUntilPerceived() {
  Slot& slot = slots_[current_];
  begin(slot);
  slot.errand.finish();
  slot.frame = {};
}

const FrameLook& FrameLooks::depthAhead() {
  Slot& slot = slots_[1 - current_];
  prepare(slot);
  return slot.look;
}

}  // namespace saccade
