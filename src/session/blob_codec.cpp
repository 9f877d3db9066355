#include "session/blob_codec.hpp"

#include <boost/crc.hpp>
#include <new>
#include <zstd.h>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

constexpr int kCompressionLevel = 1;  // the payload is near-random log-odds: higher levels cost time and gain little

}  // namespace

std::uint32_t crc32c(std::string_view bytes) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

PackedBlob packBlob(std::string_view bytes) {
  PackedBlob packed;
  packed.unpacked_size = bytes.size();
  packed.bytes.resize(ZSTD_compressBound(bytes.size()));
  const std::size_t size =
      ZSTD_compress(packed.bytes.data(), packed.bytes.size(), bytes.data(), bytes.size(), kCompressionLevel);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // the bound rules out every other error
  packed.bytes.resize(size);
  packed.crc32c = crc32c(packed.bytes);
  return packed;
}

std::string unpackBlob(std::string_view packed, std::uint32_t crc, std::uint64_t unpacked_size,
                       std::uint64_t largest_size, const std::filesystem::path& path, const std::string& what) {
  if (unpacked_size > largest_size) {
    throw IoError(path, what + " of at most " + std::to_string(largest_size) + " bytes",
                  std::to_string(unpacked_size) + " bytes");
  }
  if (crc32c(packed) != crc) throw IoError(path, "an undamaged " + what, "a wrong checksum");
  std::string bytes(unpacked_size, '\0');
  const std::size_t size = ZSTD_decompress(bytes.data(), bytes.size(), packed.data(), packed.size());
  if (ZSTD_isError(size) != 0 || size != unpacked_size) {
    throw IoError(path, what + " of " + std::to_string(unpacked_size) + " bytes",
                  ZSTD_isError(size) != 0 ? ZSTD_getErrorName(size) : std::to_string(size) + " bytes");
  }
  return bytes;
}

}  // namespace saccade
