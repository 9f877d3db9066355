#include "saccade/sources/image_files.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <fstream>
#include <optional>
#include <string>

#include <opencv2/imgcodecs.hpp>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

constexpr std::array<unsigned char, 8> kPngSignature = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
// Some cameras write padding behind the end marker of a JPEG; a marker further from the end belongs to a thumbnail.
constexpr std::size_t kJpegTail = 4096;
constexpr const char* kSwapped = "; colour and depth look swapped";

std::uint32_t bigEndian(const unsigned char* p, int bytes) {
  std::uint32_t value = 0;
  for (int i = 0; i < bytes; ++i) value = value << 8 | p[i];
  return value;
}

bool isPng(const std::vector<unsigned char>& bytes) {
  return bytes.size() >= kPngSignature.size() && std::equal(kPngSignature.begin(), kPngSignature.end(), bytes.begin());
}

bool isJpeg(const std::vector<unsigned char>& bytes) {
  return bytes.size() >= 3 && bytes[0] == 0xff && bytes[1] == 0xd8 && bytes[2] == 0xff;
}

std::optional<ImageHeader> pngHeader(const std::vector<unsigned char>& bytes) {
  if (bytes.size() < 33 || std::memcmp(&bytes[12], "IHDR", 4) != 0) return std::nullopt;
  ImageHeader header;
  header.width = static_cast<int>(bigEndian(&bytes[16], 4));
  header.height = static_cast<int>(bigEndian(&bytes[20], 4));
  header.bits_per_channel = bytes[24];
  switch (bytes[25]) {
    case 0:
      header.channels = 1;
      break;
    case 4:
      header.channels = 2;
      break;
    case 6:
      header.channels = 4;
      break;
    default:
      header.channels = 3;
      break;
  }
  return header;
}

// Walks the chunks: their lengths must lead exactly to IEND.
bool pngIsComplete(const std::vector<unsigned char>& bytes) {
  std::size_t at = kPngSignature.size();
  while (at + 12 <= bytes.size()) {
    if (std::memcmp(&bytes[at + 4], "IEND", 4) == 0) return true;
    at += 12 + static_cast<std::size_t>(bigEndian(&bytes[at], 4));
  }
  return false;
}

// Walks the segments to the frame header (SOF0..SOF15 without DHT, JPG and DAC).
std::optional<ImageHeader> jpegHeader(const std::vector<unsigned char>& bytes) {
  std::size_t at = 2;
  while (at + 9 < bytes.size() && bytes[at] == 0xff) {
    const unsigned char marker = bytes[at + 1];
    if (marker == 0xff) {  // fill byte
      ++at;
      continue;
    }
    if (marker >= 0xc0 && marker <= 0xcf && marker != 0xc4 && marker != 0xc8 && marker != 0xcc) {
      ImageHeader header;
      header.bits_per_channel = bytes[at + 4];
      header.height = static_cast<int>(bigEndian(&bytes[at + 5], 2));
      header.width = static_cast<int>(bigEndian(&bytes[at + 7], 2));
      header.channels = bytes[at + 9];
      return header;
    }
    at += 2 + bigEndian(&bytes[at + 2], 2);
  }
  return std::nullopt;
}

bool jpegIsComplete(const std::vector<unsigned char>& bytes) {
  const std::array<unsigned char, 2> end_of_image = {0xff, 0xd9};
  const auto tail = bytes.size() > kJpegTail ? bytes.end() - static_cast<std::ptrdiff_t>(kJpegTail) : bytes.begin();
  return std::search(tail, bytes.end(), end_of_image.begin(), end_of_image.end()) != bytes.end();
}

std::string describe(const ImageHeader& header) {
  return "an image with " + std::to_string(header.channels) + " channel" + (header.channels == 1 ? "" : "s") + " of " +
         std::to_string(header.bits_per_channel) + " bits";
}

ImageHeader parseHeader(const std::filesystem::path& path, const std::vector<unsigned char>& bytes) {
  const std::optional<ImageHeader> header = isPng(bytes)    ? pngHeader(bytes)
                                            : isJpeg(bytes) ? jpegHeader(bytes)
                                                            : std::nullopt;
  if (header && header->width > 0 && header->height > 0) return *header;
  const bool known = isPng(bytes) || isJpeg(bytes);
  throw IoError(path, "a PNG or JPEG image",
                bytes.empty() ? "an empty file"
                : known       ? "a truncated or damaged header"
                              : "another kind of file (" + std::to_string(bytes.size()) + " bytes)");
}

}  // namespace

ImageHeader ImageReader::loadChecked(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary | std::ios::ate);
  const std::streamoff size = file ? static_cast<std::streamoff>(file.tellg()) : -1;
  if (size < 0 || std::filesystem::is_directory(path)) {
    throw IoError(path, "a PNG or JPEG image", "nothing that can be read");
  }
  bytes_.resize(static_cast<std::size_t>(size));
  file.seekg(0);
  file.read(reinterpret_cast<char*>(bytes_.data()), size);
  if (file.gcount() != size) throw IoError(path, std::to_string(size) + " bytes", "a read error");
  const ImageHeader header = parseHeader(path, bytes_);
  if (!(isPng(bytes_) ? pngIsComplete(bytes_) : jpegIsComplete(bytes_))) {
    throw IoError(path, std::string("a complete ") + (isPng(bytes_) ? "PNG" : "JPEG") + " image",
                  "a truncated one (" + std::to_string(bytes_.size()) + " bytes, no end marker)");
  }
  return header;
}

void ImageReader::decode(const std::filesystem::path& path, int flags, cv::Mat& image) {
  // The orientation tag is ignored: intrinsics and depth belong to the pixels as stored.
  const cv::Mat bytes(1, static_cast<int>(bytes_.size()), CV_8U, bytes_.data());
  bool decoded = false;
  try {
    decoded = !cv::imdecode(bytes, flags, &image).empty();
  } catch (const cv::Exception&) {
    decoded = false;
  }
  if (!decoded) throw IoError(path, "an image that can be decoded", "damaged data");
}

ImageHeader ImageReader::header(const std::filesystem::path& path) {
  return loadChecked(path);
}

void ImageReader::readColor(const std::filesystem::path& path, cv::Mat3b& color) {
  const ImageHeader header = loadChecked(path);
  if (header.bits_per_channel > 8) {
    throw IoError(path, "a colour image of 8 bits per channel",
                  describe(header) + (header.channels == 1 ? kSwapped : ""));
  }
  decode(path, cv::IMREAD_COLOR | cv::IMREAD_IGNORE_ORIENTATION, color);
}

void ImageReader::readDepth(const std::filesystem::path& path, cv::Mat1w& raw) {
  const ImageHeader header = loadChecked(path);
  if (header.channels != 1 || header.bits_per_channel != 16) {
    const std::string hint = header.channels > 1 ? kSwapped : "; 8-bit depth is a picture of depth, not a measurement";
    throw IoError(path, "a depth image with 1 channel of 16 bits", describe(header) + hint);
  }
  decode(path, cv::IMREAD_ANYDEPTH, raw);
}

void ImageReader::readLabel(const std::filesystem::path& path, cv::Mat1w& label) {
  const ImageHeader header = loadChecked(path);
  if (header.channels != 1 || header.bits_per_channel < 8) {
    throw IoError(path, "a label image with 1 channel of 8 or 16 bits", describe(header));
  }
  decode(path, cv::IMREAD_ANYDEPTH, decoded_);
  decoded_.convertTo(label, CV_16U);
}

}  // namespace saccade
