#include "session/map_blobs.hpp"

#include <algorithm>
#include <bit>
#include <cstring>

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

}  // namespace saccade
