#include "sources/bag_images.hpp"

#include <cstring>
#include <limits>

#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

namespace saccade {
namespace {

/// The pixels of a message without a copy; empty if it holds fewer than it says.
cv::Mat pixelsOf(const ImageMessage& message, int type) {
  const std::size_t row = static_cast<std::size_t>(message.width) * CV_ELEM_SIZE(type);
  constexpr std::uint32_t kMostPixels = 32768;
  if (message.width == 0 || message.height == 0 || message.width > kMostPixels || message.height > kMostPixels ||
      message.step < row || message.data.size() < static_cast<std::size_t>(message.step) * message.height) {
    return {};
  }
  return cv::Mat(static_cast<int>(message.height), static_cast<int>(message.width), type,
                 const_cast<unsigned char*>(message.data.data()), message.step);
}

cv::Mat decoded(const std::uint8_t* bytes, std::size_t size, int flags) {
  try {
    return cv::imdecode(cv::Mat(1, static_cast<int>(size), CV_8U, const_cast<std::uint8_t*>(bytes)), flags);
  } catch (const cv::Exception&) {
    return {};
  }
}

/// What image_transport's compressedDepth puts before the PNG: how inverse depth was quantised (32FC1 only).
struct DepthCompression {
  std::int32_t format = 0;
  float a = 0.0f, b = 0.0f;
};

}  // namespace

std::string readColor(const ImageMessage& message, cv::Mat3b& color) {
  const std::string& encoding = message.encoding;
  const bool grey = encoding == "mono8" || encoding == "8UC1";
  const bool four = encoding == "bgra8" || encoding == "rgba8";
  if (!grey && !four && encoding != "bgr8" && encoding != "rgb8" && encoding != "8UC3") {
    return "the encoding \"" + encoding + "\" instead of bgr8, rgb8, bgra8, rgba8 or mono8";
  }
  const cv::Mat pixels = pixelsOf(message, grey ? CV_8UC1 : four ? CV_8UC4 : CV_8UC3);
  if (pixels.empty()) return "fewer pixels than the message says";
  if (grey) {
    cv::cvtColor(pixels, color, cv::COLOR_GRAY2BGR);
  } else if (four) {
    cv::cvtColor(pixels, color, encoding == "bgra8" ? cv::COLOR_BGRA2BGR : cv::COLOR_RGBA2BGR);
  } else if (encoding == "rgb8") {
    cv::cvtColor(pixels, color, cv::COLOR_RGB2BGR);
  } else {
    pixels.copyTo(color);
  }
  return "";
}

std::string readColor(const CompressedImageMessage& message, cv::Mat3b& color) {
  const cv::Mat image = decoded(message.data.data(), message.data.size(), cv::IMREAD_COLOR);
  if (image.empty()) return "an image that cannot be decoded";
  image.copyTo(color);
  return "";
}

std::string readDepth(const ImageMessage& message, cv::Mat1w& raw_mm, cv::Mat1f& depth_m) {
  const bool metres = message.encoding == "32FC1";
  if (!metres && message.encoding != "16UC1" && message.encoding != "mono16") {
    return "the encoding \"" + message.encoding + "\" instead of 16UC1 or 32FC1";
  }
  if (message.is_bigendian != 0) return "big-endian depth";
  const cv::Mat pixels = pixelsOf(message, metres ? CV_32FC1 : CV_16UC1);
  if (pixels.empty()) return "fewer pixels than the message says";
  raw_mm.release();
  depth_m.release();
  if (metres) {
    pixels.copyTo(depth_m);
  } else {
    pixels.copyTo(raw_mm);
  }
  return "";
}

std::string readDepth(const CompressedImageMessage& message, cv::Mat1w& raw_mm, cv::Mat1f& depth_m) {
  DepthCompression header;
  const bool with_header = message.format.find("compressedDepth") != std::string::npos;
  const std::size_t skipped = with_header ? sizeof header : 0;
  if (message.data.size() <= skipped) return "an empty image";
  if (with_header) std::memcpy(&header, message.data.data(), sizeof header);
  const cv::Mat image = decoded(message.data.data() + skipped, message.data.size() - skipped, cv::IMREAD_UNCHANGED);
  if (image.type() != CV_16UC1) return "no 16-bit image of one channel";
  raw_mm.release();
  depth_m.release();
  if (message.format.find("32FC1") == std::string::npos) {
    image.copyTo(raw_mm);
    return "";
  }
  depth_m.create(image.size());
  for (int i = 0; i < static_cast<int>(image.total()); ++i) {
    const auto quantised = image.at<std::uint16_t>(i / image.cols, i % image.cols);
    depth_m(i / image.cols, i % image.cols) = quantised == 0 ? std::numeric_limits<float>::quiet_NaN()
                                                             : header.a / (static_cast<float>(quantised) - header.b);
  }
  return "";
}

}  // namespace saccade
