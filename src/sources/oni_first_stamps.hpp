#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace saccade {

/// When the streams of an .oni recording begin. OpenNI2 stores stamps from the first frame of each stream on, so the
/// side file keeps where that was: without it a recording begins at 0.
struct OniFirstStamps {
  std::int64_t color_us = 0;
  std::int64_t depth_us = 0;
};

/// The lines of a side file for these stamps.
[[nodiscard]] std::string oniFirstStampsYaml(const OniFirstStamps& stamps);

/// The stamps in the side file `X.oni.yaml` of a recording `X.oni`; zeros where it says nothing. Throws IoError where
/// they are no numbers.
[[nodiscard]] OniFirstStamps findOniFirstStamps(const std::filesystem::path& recording);

}  // namespace saccade
