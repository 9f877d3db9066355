#include "sources/oni_file.hpp"

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <optional>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

constexpr std::array<char, 4> kFileMagic = {'N', 'I', '1', '0'};
constexpr std::array<char, 4> kRecordMagic = {'N', 'I', 'R', '\0'};
constexpr std::uint64_t kFileHeadBytes = 24;  // magic, version, last stamp, number of nodes, 4 bytes unused
constexpr std::uint32_t kNodeAdded = 13, kNewData = 10, kEnd = 11;
constexpr std::uint32_t kUnknownFrames = 0xffffffff;  // what a head says until its recording is finished

/// Little-endian, as the players of all machines write it.
struct RecordHead {
  std::array<char, 4> magic;
  std::uint32_t type, node, fields_bytes, payload_bytes;
  std::array<std::uint32_t, 2> undo_position;
};
constexpr std::uint32_t kRecordHeadBytes = sizeof(RecordHead);
static_assert(kRecordHeadBytes == 28);

template <typename T>
bool readAt(std::ifstream& file, std::uint64_t position, T& value) {
  file.clear();
  file.seekg(static_cast<std::streamoff>(position));
  file.read(reinterpret_cast<char*>(&value), sizeof value);
  return file.gcount() == sizeof value;
}

/// The number of frames in a record that adds a node: behind its name, its kind and its codec.
std::optional<std::uint32_t> promisedFrames(std::ifstream& file, std::uint64_t record) {
  constexpr std::uint32_t kLongestName = 256;
  std::uint32_t name_bytes = 0, frames = 0;
  if (!readAt(file, record + kRecordHeadBytes, name_bytes) || name_bytes > kLongestName) return std::nullopt;
  const std::uint64_t behind_name = record + kRecordHeadBytes + sizeof name_bytes + name_bytes;
  if (!readAt(file, behind_name + 2 * sizeof(std::uint32_t), frames)) return std::nullopt;
  return frames;
}

}  // namespace

bool OniFileExtent::isWhole() const {
  return std::all_of(streams.begin(), streams.end(), [](const OniStreamExtent& stream) {
    return stream.promised_frames != kUnknownFrames && stream.frames == stream.promised_frames;
  });
}

OniFileExtent readOniExtent(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::array<char, 4> magic{};
  if (!file || !readAt(file, 0, magic) || magic != kFileMagic) {
    throw IoError(path, "an OpenNI recording", "a file of another kind, or none");
  }
  OniFileExtent extent;
  const std::uint64_t file_bytes = std::filesystem::file_size(path);
  extent.records_end = kFileHeadBytes;
  RecordHead head{};
  while (readAt(file, extent.records_end, head) && head.magic == kRecordMagic &&
         head.fields_bytes >= kRecordHeadBytes) {
    const std::uint64_t next = extent.records_end + head.fields_bytes + head.payload_bytes;
    if (next > file_bytes) break;
    if (head.type == kNodeAdded) {
      const std::optional<std::uint32_t> promised = promisedFrames(file, extent.records_end);
      if (promised) extent.streams.push_back({head.node, *promised, 0});
    } else if (head.type == kNewData) {
      for (OniStreamExtent& stream : extent.streams) stream.frames += stream.node == head.node ? 1 : 0;
    } else if (head.type == kEnd) {
      break;
    }
    extent.records_end = next;
  }
  extent.is_known_format = !extent.streams.empty();
  return extent;
}

void closeOniGap(const std::filesystem::path& path, const OniFileExtent& extent) {
  const RecordHead end{kRecordMagic, kEnd, 0, kRecordHeadBytes, 0, {}};
  std::fstream file(path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<std::streamoff>(extent.records_end));
  file.write(reinterpret_cast<const char*>(&end), kRecordHeadBytes);
  file.close();
  std::error_code error;
  std::filesystem::resize_file(path, extent.records_end + kRecordHeadBytes, error);
  if (!file || error) throw IoError(path, "a recording that can be written", error ? error.message() : "none");
}

}  // namespace saccade
