#include "fuzz/fuzzed_file.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/evaluation/run_recording.hpp"

/// Candidate lines of any bytes are read, or refused with an IoError.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const saccade::fuzz::FuzzedFiles files;
  const std::filesystem::path path = files.write("c.jsonl", data, size);
  try {
    (void)saccade::loadRecording(path);
  } catch (const saccade::IoError&) {
    return 0;
  }
  return 0;
}
