#include "pipeline/frame_looks.hpp"

#include "pipeline/stage_clock.hpp"

namespace saccade {

FrameLook* FrameLooks::takeAhead(const RgbdFrame& frame) {
  const bool is_same = !ahead_.color.empty() && ahead_.index == frame.index && ahead_.color.data == frame.color.data &&
                       ahead_.depth_m.data == frame.depth_m.data;
  task_.wait();
  ahead_ = {};
  if (!is_same) return nullptr;
  current_ = 1 - current_;
  return &looks_[current_];
}

FrameLook& FrameLooks::prepare(const RgbdFrame& frame) {
  FrameLook& look = looks_[current_];
  prepareDepth(frame, look);
  return look;
}

void FrameLooks::prepareDepth(const RgbdFrame& frame, FrameLook& look) {
  look.times.clear();
  look.has_depth = !frame.depth_m.empty();
  look.depth.depth_m.resize(0);
  if (!look.has_depth) return;
  StageClock clock;
  clock.time("prepare depth", [&] { preparation_.prepare(frame.depth_m, camera_, look.depth); });
  clock.time("grey values", [&] { look.intensity.build(frame.color, camera_); });
  look.times = clock.stages();
}

void FrameLooks::perceive(const RgbdFrame& frame, FrameLook& look) {
  perceiver_.perceive(frame.color, look.has_depth ? &look.depth : nullptr, look.seen);
  const Perceiver::Times& times = perceiver_.times();
  look.times.insert(look.times.end(), {{"saliency", times.saliency_ms},
                                       {"salient blobs", times.blobs_ms},
                                       {"colour segments", times.color_ms},
                                       {"surface segments", times.surface_ms},
                                       {"segment tables", times.tables_ms}});
  StageClock clock;
  look.pool = clock.time("propose", [&] { return proposeCandidates(look.seen, proposal_); });
  look.times.insert(look.times.end(), clock.stages().begin(), clock.stages().end());
}

void FrameLooks::beginAhead(const RgbdFrame& next) {
  ahead_ = next;
  depth_ahead_.emplace();
  task_.run([this] {
    prepareDepthAhead();
    perceive(ahead_, looks_[1 - current_]);
  });
}

void FrameLooks::prepareDepthAhead() {
  // Preparing starts no tasks: a thread that waited for some could run one that asks for these same maps.
  std::call_once(*depth_ahead_, [this] { prepareDepth(ahead_, looks_[1 - current_]); });
}

const FrameLook& FrameLooks::depthAhead() {
  prepareDepthAhead();
  return looks_[1 - current_];
}

}  // namespace saccade
