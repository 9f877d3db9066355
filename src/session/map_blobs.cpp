#include "session/map_blobs.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

constexpr int kCornerBits = 48;
constexpr int kBrickBits = 21;
constexpr std::int64_t kBrickOffset = std::int64_t{1} << (kBrickBits - 1);
static_assert(std::endian::native == std::endian::little, "sessions are little-endian");

void appendNumber(std::string& bytes, std::uint64_t value) {
  while (value >= 0x80) {
    bytes.push_back(static_cast<char>(value | 0x80));
    value >>= 7;
  }
  bytes.push_back(static_cast<char>(value));
}

void appendKeys(std::string& bytes, std::vector<LeafKey> keys) {
  std::sort(keys.begin(), keys.end());
  appendNumber(bytes, keys.size());
  std::uint64_t last = 0;
  for (const LeafKey& key : keys) {
    appendNumber(bytes, key.packed() - last);
    last = key.packed();
  }
}

/// Reads what appendNumber() and appendKeys() wrote.
class NumberReader {
 public:
  NumberReader(std::string_view bytes, Tick tick, const std::filesystem::path& path)
      : rest_(bytes), tick_(tick), path_(path) {}

  std::uint64_t number() {
    std::uint64_t value = 0;
    for (int shift = 0; shift < 64; shift += 7) {
      if (rest_.empty()) fail("more bytes", "the end");
      const auto byte = static_cast<unsigned char>(rest_.front());
      rest_.remove_prefix(1);
      value |= static_cast<std::uint64_t>(byte & 0x7FU) << shift;
      if ((byte & 0x80U) == 0) return value;
    }
    fail("a number of 64 bits", "a longer one");
  }
  /// Number of things of which each takes at least one byte.
  std::size_t count() {
    const std::uint64_t count = number();
    if (count > rest_.size()) fail("at most " + std::to_string(rest_.size()) + " entries", std::to_string(count));
    return static_cast<std::size_t>(count);
  }
  std::vector<LeafKey> keys() {
    std::vector<LeafKey> keys(count());
    std::uint64_t packed = 0;
    for (LeafKey& key : keys) {
      packed += number();
      if (packed >> kCornerBits != 0) fail("the key of a leaf", std::to_string(packed));
      key = LeafKey::fromPacked(packed);
    }
    return keys;
  }
  void requireEnd() const {
    if (!rest_.empty()) fail("the end", std::to_string(rest_.size()) + " bytes more");
  }

 private:
  [[noreturn]] void fail(const std::string& expected, const std::string& found) const {
    throw IoError(path_, expected + " in the attend log of tick " + std::to_string(tick_.value), found);
  }

  std::string_view rest_;
  Tick tick_;
  const std::filesystem::path& path_;
};

}  // namespace

std::uint64_t tileKey(const NodeKey& root) {
  return static_cast<std::uint64_t>(root.depth) << kCornerBits | root.corner.packed();
}

NodeKey tileRoot(std::uint64_t key) {
  return {LeafKey::fromPacked(key & ((std::uint64_t{1} << kCornerBits) - 1)), static_cast<int>(key >> kCornerBits)};
}

std::uint64_t brickKey(const BrickPosition& position) {
  const auto part = [](std::int32_t value) { return static_cast<std::uint64_t>(value + kBrickOffset); };
  return part(position.x) << (2 * kBrickBits) | part(position.y) << kBrickBits | part(position.z);
}

BrickPosition brickPosition(std::uint64_t key) {
  const auto part = [&](int shift) {
    const auto value = static_cast<std::int64_t>(key >> shift & ((std::uint64_t{1} << kBrickBits) - 1));
    return static_cast<std::int32_t>(value - kBrickOffset);
  };
  return {part(2 * kBrickBits), part(kBrickBits), part(0)};
}

std::string bytesOf(const std::vector<std::byte>& data) {
  return {reinterpret_cast<const char*>(data.data()), data.size()};
}

std::string bytesOf(const SurfaceBrick& brick) {
  std::string bytes(sizeof brick.distance + sizeof brick.weight, '\0');
  std::memcpy(bytes.data(), brick.distance.data(), sizeof brick.distance);
  std::memcpy(bytes.data() + sizeof brick.distance, brick.weight.data(), sizeof brick.weight);
  return bytes;
}

std::string encodeTick(const AttendLog& log, std::size_t i) {
  const TickEvents& events = log.tick(i);
  std::string bytes;
  appendNumber(bytes, static_cast<std::uint64_t>(events.frame.value));
  appendNumber(bytes, log.candidateCount(i));
  for (std::size_t candidate = 0; candidate < log.candidateCount(i); ++candidate) {
    appendNumber(bytes, static_cast<std::uint64_t>(log.rank(i, candidate)));
    appendKeys(bytes, log.leaves(i, candidate));
  }
  appendKeys(bytes, events.flags_on);
  appendKeys(bytes, events.forgotten);
  return bytes;
}

SurfaceBrick brickFromBytes(std::string_view bytes, const std::filesystem::path& path) {
  SurfaceBrick brick;
  constexpr std::size_t kBytes = sizeof brick.distance + sizeof brick.weight;
  if (bytes.size() != kBytes) {
    throw IoError(path, "a surface brick of " + std::to_string(kBytes) + " bytes", std::to_string(bytes.size()));
  }
  std::memcpy(brick.distance.data(), bytes.data(), sizeof brick.distance);
  std::memcpy(brick.weight.data(), bytes.data() + sizeof brick.distance, sizeof brick.weight);
  return brick;
}

LoggedTick decodeTick(std::string_view bytes, Tick tick, const std::filesystem::path& path) {
  NumberReader in(bytes, tick, path);
  LoggedTick logged;
  logged.events.tick = tick;
  logged.events.frame.value = static_cast<std::int64_t>(in.number());
  const std::size_t candidates = in.count();
  for (std::size_t i = 0; i < candidates; ++i) {
    logged.ranks.push_back(static_cast<int>(in.number()));
    logged.leaves.push_back(in.keys());
  }
  logged.events.flags_on = in.keys();
  logged.events.forgotten = in.keys();
  in.requireEnd();
  return logged;
}

}  // namespace saccade
