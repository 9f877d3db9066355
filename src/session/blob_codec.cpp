#include "session/blob_codec.hpp"

#include <boost/crc.hpp>
#include <cstring>
#include <memory>
#include <new>
#include <zstd.h>

#if defined(__x86_64__)
#include <immintrin.h>
#endif

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

constexpr int kCompressionLevel = -1;  // near-random log-odds and distances: 1 takes twice the time and saves a tenth

/// A compressor's tables are larger than most blobs: each thread keeps its own instead of making them anew.
ZSTD_CCtx* compressor() {
  struct Freeing {
    void operator()(ZSTD_CCtx* context) const { ZSTD_freeCCtx(context); }
  };
  thread_local const std::unique_ptr<ZSTD_CCtx, Freeing> context(ZSTD_createCCtx());
  if (context == nullptr) throw std::bad_alloc();
  return context.get();
}

#if defined(__x86_64__)
__attribute__((target("sse4.2"))) std::uint32_t crc32cByProcessor(std::string_view bytes) {
  std::uint64_t crc = 0xFFFFFFFF;
  const char* at = bytes.data();
  std::size_t left = bytes.size();
  for (; left >= sizeof(std::uint64_t); at += sizeof(std::uint64_t), left -= sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, at, sizeof word);
    crc = _mm_crc32_u64(crc, word);
  }
  auto rest = static_cast<std::uint32_t>(crc);
  for (; left > 0; ++at, --left) rest = _mm_crc32_u8(rest, static_cast<unsigned char>(*at));
  return ~rest;
}
#endif

}  // namespace

std::uint32_t crc32c(std::string_view bytes) {
#if defined(__x86_64__)
  static const bool has_instruction = __builtin_cpu_supports("sse4.2") != 0;
  if (has_instruction) return crc32cByProcessor(bytes);
#endif
  return crc32cByTable(bytes);
}

std::uint32_t crc32cByTable(std::string_view bytes) {
  boost::crc_optimal<32, 0x1EDC6F41, 0xFFFFFFFF, 0xFFFFFFFF, true, true> crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

PackedBlob packBlob(std::string_view bytes) {
  PackedBlob packed;
  packed.unpacked_size = bytes.size();
  packed.bytes.resize(ZSTD_compressBound(bytes.size()));
  const std::size_t size = ZSTD_compressCCtx(compressor(), packed.bytes.data(), packed.bytes.size(), bytes.data(),
                                             bytes.size(), kCompressionLevel);
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
