#pragma once

#include <filesystem>
#include <string>
#include <string_view>

#include "saccade/tracking/motion_predictor.hpp"

namespace saccade {

/// Name of the motion predictor's state in a session.
inline constexpr const char* kMotionState = "motion";

/// Everything the motion predictor knows, bit for bit.
[[nodiscard]] std::string encodeMotion(const MotionPredictor::State& state);

/// Inverse of encodeMotion(). Throws IoError naming `path` for bytes that it cannot have written.
[[nodiscard]] MotionPredictor::State decodeMotion(std::string_view bytes, const std::filesystem::path& path);

}  // namespace saccade
