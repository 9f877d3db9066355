#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "saccade/tracking/photometric_reference.hpp"

namespace saccade {

/// Name of the photometric reference in a session. Sessions of older programs have none, nor those
/// explored without tracking or without colour in it.
inline constexpr const char* kReferenceState = "photometric_reference";

/// Everything the photometric reference knows, bit for bit: its pose, the number of points as uint64, then for each
/// array of PhotometricReference::Points its numbers as float32, little-endian.
[[nodiscard]] std::string encodeReference(const PhotometricReference::State& state);

/// Inverse of encodeReference(). Throws IoError naming `path` for bytes that it cannot have written.
[[nodiscard]] PhotometricReference::State decodeReference(std::string_view bytes, const std::filesystem::path& path);

}  // namespace saccade
