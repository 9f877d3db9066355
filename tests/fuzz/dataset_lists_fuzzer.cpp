#include <algorithm>

#include "fuzz/fuzzed_file.hpp"
#include "saccade/core/errors.hpp"
#include "sources/frame_list.hpp"

/// A TUM folder whose lists hold any bytes (rgb.txt, depth.txt and groundtruth.txt, with a zero between) is listed, or
/// refused with an IoError.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const saccade::fuzz::FuzzedFiles files;
  const std::uint8_t* begin = data;
  const std::uint8_t* const end = data + size;
  for (const char* name : {"rgb.txt", "depth.txt", "groundtruth.txt"}) {
    const std::uint8_t* const stop = std::find(begin, end, std::uint8_t{0});
    (void)files.write(name, begin, static_cast<std::size_t>(stop - begin));
    begin = stop == end ? end : stop + 1;
  }
  try {
    (void)saccade::listTum(files.folder());
  } catch (const saccade::IoError&) {
    return 0;
  }
  return 0;
}
