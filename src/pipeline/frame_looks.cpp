#include "pipeline/frame_looks.hpp"

#include <utility>

#include <tbb/task_arena.h>

#include "pipeline/stage_clock.hpp"

namespace saccade {

void FrameLooks::assign(Slot& slot, const RgbdFrame& frame) {
  slot.errand.settle();
  slot.of_color.settle();
  slot.frame = frame;
  slot.prepared.emplace();
  slot.is_color_begun = slot.is_begun = false;
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
    slot.prepared_times.clear();
    look.has_depth = !slot.frame.depth_m.empty();
    look.depth.depth_m.resize(0);
    if (!look.has_depth) return;
    StageClock clock;
    clock.time("prepare depth", [&] { slot.preparation.prepare(slot.frame.depth_m, camera_, look.depth); });
    clock.time("grey values", [&] { look.intensity.build(slot.frame.color, camera_); });
    slot.prepared_times = clock.stages();
  });
}

void FrameLooks::beginColor(Slot& slot) {
  const std::lock_guard lock(slot.color_mutex);  // a task that begins the rest may be here as well
  if (slot.frame.color.empty() || std::exchange(slot.is_color_begun, true)) return;
  // Isolated: whoever waits for a part of this does nothing else meanwhile, which would take as long as it takes.
  slot.of_color.offer([&slot] {
    tbb::this_task_arena::isolate([&] { slot.perceiver.perceiveColor(slot.frame.color, slot.look.seen); });
  });
}

void FrameLooks::begin(Slot& slot, const SurfaceVolume& surface, const std::optional<Pose>& T_WC) {
  const auto isThere = [](const std::optional<Pose>& a, const std::optional<Pose>& b) {
    return a.has_value() == b.has_value() && (!a || a->matrix() == b->matrix());
  };
  if (slot.frame.color.empty() || (slot.is_begun && isThere(slot.seen_from, T_WC))) return;
  slot.errand.settle();
  if (slot.is_begun) slot.is_color_begun = false;  // it may have failed, which nobody was told
  beginColor(slot);
  slot.is_begun = true;
  slot.seen_from = T_WC;
  slot.look.is_completed = false;
  slot.completion_times.clear();
  if (T_WC) complete(slot, surface);
  slot.errand.offer([this, &slot] { perceive(slot); });
}

void FrameLooks::complete(Slot& slot, const SurfaceVolume& surface) const {
  prepare(slot);
  FrameLook& look = slot.look;
  if (!look.has_depth) return;
  StageClock clock;
  look.is_completed = clock.time(
      "complete depth", [&] { return slot.completion.complete(look.depth, surface, *slot.seen_from, look.completed); });
  slot.completion_times = clock.stages();
}

void FrameLooks::perceive(Slot& slot) const {
  prepare(slot);
  FrameLook& look = slot.look;
  // Isolated: whoever waits for a part of this does nothing else meanwhile, which would take as long as it takes.
  tbb::this_task_arena::isolate([&] {
    slot.perceiver.perceiveSurface(look.perceivedDepth(), look.seen);
    slot.of_color.finish();
    slot.perceiver.relate(slot.frame.color, look.perceivedDepth(), look.seen);
  });
  look.times = slot.prepared_times;
  look.times.insert(look.times.end(), slot.completion_times.begin(), slot.completion_times.end());
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
  slot.errand.finish();
  slot.frame = {};
}

const FrameLook& FrameLooks::depthAhead() {
  Slot& slot = slots_[1 - current_];
  prepare(slot);
  return slot.look;
}

}  // namespace saccade
