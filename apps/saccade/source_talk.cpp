#include "source_talk.hpp"

#include <iostream>

#include <fmt/format.h>

#include "terminal.hpp"

namespace saccade::app {

void sayWhatWasUnderstood(const SourceDescription& d) {
  std::cerr << d.location << ": " << d.kind << "\n";
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const char* what, const std::string& text) {
    rows.push_back({fmt::format("{:<12}{}", what, text)});
  };
  add("frames", (d.is_live      ? std::string("live")
                 : d.frames < 0 ? std::string("as many as it holds")
                                : grouped(d.frames)) +
                    (d.dropped > 0 ? fmt::format(", {} images without a partner dropped", d.dropped) : ""));
  add("size", fmt::format("{} x {}", d.camera.width, d.camera.height));
  add("intrinsics", fmt::format("fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f} from {}", d.camera.fx, d.camera.fy,
                                d.camera.cx, d.camera.cy, d.intrinsics_origin));
  if (d.has_depth) {
    add("depth", fmt::format("{:g} units a metre ({}), {}", d.depth_units_per_metre, d.depth_scale_origin,
                             d.depth_was_registered ? "registered to colour" : "rendered into the colour camera"));
  } else {
    add("depth", "none: colour alone");
  }
  if (d.has_poses) add("poses", "in the dataset; not used unless --poses dataset");
  for (const std::string& remark : d.remarks) add("note", remark);
  std::cerr << alignedTable(rows) << "\n";
}

void sayHowItEnded(const SourceProgress& progress) {
  if (!progress.end_reason.empty()) std::cerr << "ended early: " << progress.end_reason << "\n";
  if (progress.dropped > 0) {
    std::cerr << fmt::format("dropped: {} frames that came faster than they were explored\n", progress.dropped);
  }
}

}  // namespace saccade::app
