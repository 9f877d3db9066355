#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

namespace saccade {

/// Image files (PNG, JPEG, `.depth`) of a folder by the stem of their names.
[[nodiscard]] std::map<std::string, std::filesystem::path> imagesByName(const std::filesystem::path& folder);

/// The same by the first number in their names, which is what orders `2.png` before `10.png`; images without a number
/// are left out. Of two with the same number the first by name stays.
[[nodiscard]] std::map<std::int64_t, std::filesystem::path> imagesByNumber(const std::filesystem::path& folder);

/// The first run of digits of a name: 12 for "0000012-000000345678"; none if there is none.
[[nodiscard]] std::optional<std::int64_t> firstNumber(const std::string& name);

/// The number that a name ends with: 12 for "learn_12".
[[nodiscard]] std::optional<double> trailingNumber(const std::string& name);

}  // namespace saccade
