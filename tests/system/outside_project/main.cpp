#include <iostream>

#include "saccade/pipeline/explorer.hpp"
#include "saccade/sources/frame_source.hpp"
#include "saccade/version.hpp"

int main() {
  const auto source = saccade::openSource("sim:desk", saccade::FrameRange::parse(":2"));
  saccade::Explorer explorer({}, source->description().camera);
  saccade::RgbdFrame frame;
  std::size_t candidates = 0;
  while (source->read(frame) == saccade::ReadStatus::kFrame) candidates += explorer.process(frame).open.size();
  std::cout << "saccade " << saccade::kVersion << ": " << candidates << " candidates\n";
  return candidates > 0 ? 0 : 1;
}
