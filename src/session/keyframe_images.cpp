#include "session/keyframe_images.hpp"

#include <cmath>
#include <optional>
#include <vector>

#include <opencv2/imgcodecs.hpp>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

constexpr int kJpegQuality = 90;
constexpr int kPngLevel = 1;  // noise of the sensor does not compress: higher levels cost five times as much for 5 %
constexpr double kFineUnit_m = 0.00025, kCoarseUnit_m = 0.001;
constexpr double kLargestStep = 65535.0;

std::string toString(const std::vector<unsigned char>& bytes) {
  return {bytes.begin(), bytes.end()};
}

unsigned bigEndian(std::string_view bytes, std::size_t at, int count) {
  unsigned value = 0;
  for (int i = 0; i < count; ++i) {
    value = value << 8U | static_cast<unsigned char>(bytes[at + static_cast<std::size_t>(i)]);
  }
  return value;
}

/// Width and height that the header of a PNG announces.
std::optional<cv::Size> pngSize(std::string_view png) {
  constexpr std::size_t kWidthAt = 16, kHeaderEnd = 24;
  if (png.size() < kHeaderEnd || png.substr(1, 3) != "PNG") return std::nullopt;
  return cv::Size(static_cast<int>(bigEndian(png, kWidthAt, 4)), static_cast<int>(bigEndian(png, kWidthAt + 4, 4)));
}

/// Width and height that the first frame header of a JPEG announces.
std::optional<cv::Size> jpegSize(std::string_view jpeg) {
  std::size_t at = 2;  // behind the start marker
  while (at + 9 <= jpeg.size() && bigEndian(jpeg, at, 1) == 0xFF) {
    const unsigned marker = bigEndian(jpeg, at + 1, 1);
    const bool frame = marker >= 0xC0 && marker <= 0xCF && marker != 0xC4 && marker != 0xC8 && marker != 0xCC;
    if (frame)
      return cv::Size(static_cast<int>(bigEndian(jpeg, at + 7, 2)), static_cast<int>(bigEndian(jpeg, at + 5, 2)));
    at += 2 + bigEndian(jpeg, at + 2, 2);
  }
  return std::nullopt;
}

cv::Mat decode(std::string_view bytes, const std::optional<cv::Size>& announced, cv::Size size, int type,
               const std::string& what, const std::filesystem::path& path) {
  const std::string expected = what + " of " + std::to_string(size.width) + " x " + std::to_string(size.height);
  if (!announced || *announced != size) {
    throw IoError(path, expected,
                  announced ? std::to_string(announced->width) + " x " + std::to_string(announced->height)
                            : "an image of another kind");
  }
  const std::vector<char> buffer(bytes.begin(), bytes.end());
  cv::Mat image;
  try {
    image = cv::imdecode(buffer, cv::IMREAD_UNCHANGED);
  } catch (const cv::Exception&) {
    image.release();
  }
  if (image.size() != size || image.type() != type) throw IoError(path, expected, "a damaged image");
  return image;
}

}  // namespace

std::string packColor(const cv::Mat3b& color) {
  if (color.empty()) return {};
  std::vector<unsigned char> bytes;
  cv::imencode(".jpg", color, bytes, {cv::IMWRITE_JPEG_QUALITY, kJpegQuality});
  return toString(bytes);
}

PackedDepth packDepth(const cv::Mat1f& depth_m) {
  PackedDepth packed;
  packed.unit_m = kFineUnit_m;
  if (depth_m.empty()) return packed;
  for (const float z : depth_m) {
    if (z > kFineUnit_m * kLargestStep) packed.unit_m = kCoarseUnit_m;
  }
  cv::Mat1w steps(depth_m.size());
  for (int v = 0; v < steps.rows; ++v) {
    for (int u = 0; u < steps.cols; ++u) {
      const double step = std::round(static_cast<double>(depth_m(v, u)) / packed.unit_m);
      steps(v, u) = step > 0.0 && step <= kLargestStep ? static_cast<std::uint16_t>(step) : std::uint16_t{0};
    }
  }
  std::vector<unsigned char> bytes;
  cv::imencode(".png", steps, bytes, {cv::IMWRITE_PNG_COMPRESSION, kPngLevel});
  packed.bytes = toString(bytes);
  return packed;
}

cv::Mat3b unpackColor(std::string_view jpeg, cv::Size size, const std::filesystem::path& path) {
  if (jpeg.empty()) return {};
  return decode(jpeg, jpegSize(jpeg), size, CV_8UC3, "a keyframe's colour image", path);
}

cv::Mat1f unpackDepth(std::string_view png, double unit_m, cv::Size size, const std::filesystem::path& path) {
  if (png.empty()) return {};
  if (!(unit_m > 0.0 && unit_m < 1.0)) throw IoError(path, "a unit of depth in metres", std::to_string(unit_m));
  const cv::Mat steps = decode(png, pngSize(png), size, CV_16UC1, "a keyframe's depth image", path);
  cv::Mat1f depth_m;
  steps.convertTo(depth_m, CV_32F, unit_m);
  return depth_m;
}

}  // namespace saccade
