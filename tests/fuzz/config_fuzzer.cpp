#include <cstddef>
#include <cstdint>
#include <string>

#include "saccade/core/config_file.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/pipeline/explorer_config.hpp"

/// A configuration of any text is applied and survives being printed and read again, or is refused with an IoError.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  saccade::ExplorerConfig config;
  try {
    saccade::applyConfigText({reinterpret_cast<const char*>(data), size}, "fuzzed.yaml", saccade::describing(config));
  } catch (const saccade::IoError&) {
    return 0;
  }
  const std::string printed = saccade::printConfig(saccade::describing(config), true);
  saccade::ExplorerConfig again;
  saccade::applyConfigText(printed, "printed.yaml", saccade::describing(again));  // throws: a finding
  if (saccade::printConfig(saccade::describing(again), true) != printed) __builtin_trap();
  return 0;
}
