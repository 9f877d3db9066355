#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

namespace saccade {

/// Bytes as they lie in a session: compressed with zstd, guarded by a CRC32C of the compressed bytes.
struct PackedBlob {
  std::string bytes;
  std::uint32_t crc32c = 0;
  std::uint64_t unpacked_size = 0;
};

/// CRC32C (Castagnoli) of `bytes`, by the processor's own instruction where it has one.
[[nodiscard]] std::uint32_t crc32c(std::string_view bytes);
/// The same on any processor.
[[nodiscard]] std::uint32_t crc32cByTable(std::string_view bytes);

[[nodiscard]] PackedBlob packBlob(std::string_view bytes);

/// The bytes again. Throws IoError(path, ...) naming `what` if the CRC is wrong, the stream is damaged, or its size is
/// not `unpacked_size`, which itself may be at most `largest_size`: a forged size cannot exhaust the memory.
[[nodiscard]] std::string unpackBlob(std::string_view packed, std::uint32_t crc, std::uint64_t unpacked_size,
                                     std::uint64_t largest_size, const std::filesystem::path& path,
                                     const std::string& what);

}  // namespace saccade
