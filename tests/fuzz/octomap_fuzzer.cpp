#include "fuzz/fuzzed_file.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/exchange/octomap_files.hpp"

/// A map file of any bytes is read, or refused with an IoError, in bounded memory.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const saccade::fuzz::FuzzedFiles files;
  saccade::OctomapLimits limits;
  limits.nodes = std::size_t{1} << 20;
  for (const char* name : {"m.ot", "m.bt"}) {
    const std::filesystem::path path = files.write(name, data, size);
    try {
      (void)saccade::readOctomap(path, {}, limits);
    } catch (const saccade::IoError&) {
      continue;  // what is no map says so
    }
  }
  return 0;
}
