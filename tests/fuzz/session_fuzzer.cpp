#include "fuzz/fuzzed_file.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/session/session_repair.hpp"

/// A session of any bytes is verified, or refused with an IoError.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const saccade::fuzz::FuzzedFiles files;
  const std::filesystem::path path = files.write("s.saccade", data, size);
  try {
    (void)saccade::verifySession(path);
  } catch (const saccade::IoError&) {
    return 0;  // what is no session says so
  }
  return 0;
}
