#pragma once

#include <atomic>
#include <filesystem>
#include <fstream>
#include <string>
#include <unistd.h>

#include <opencv2/imgcodecs.hpp>

#include "support/temporary_folder.hpp"

namespace saccade::test {

/// A temporary folder that a test fills with small files.
class TinyFolder : public TemporaryFolder {
 public:
  void write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories((path() / name).parent_path());
    std::ofstream(path() / name, std::ios::binary) << text;
  }
  void write(const std::string& name, const cv::Mat& image) const {
    std::filesystem::create_directories((path() / name).parent_path());
    cv::imwrite((path() / name).string(), image);
  }
  /// Cuts the last part of a file off, as a full disk or a broken download does.
  void truncate(const std::string& name, double kept_share) const {
    const auto size = static_cast<double>(std::filesystem::file_size(path() / name));
    std::filesystem::resize_file(path() / name, static_cast<std::uintmax_t>(size * kept_share));
  }
};

constexpr int kTinyWidth = 32;
constexpr int kTinyHeight = 24;

/// A colour image with some structure; `seed` makes frames differ.
inline cv::Mat3b tinyColor(int seed = 0, int width = kTinyWidth, int height = kTinyHeight) {
  cv::Mat3b color(height, width);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) {
      color(v, u) = cv::Vec3b(static_cast<uchar>(7 * u + seed), static_cast<uchar>(9 * v), static_cast<uchar>(u * v));
    }
  }
  return color;
}

/// A depth image in raw units: a slanted plane from `raw` on, with one unmeasured and one saturated pixel.
inline cv::Mat1w tinyDepth(int raw = 1000, int width = kTinyWidth, int height = kTinyHeight) {
  cv::Mat1w depth(height, width);
  for (int v = 0; v < height; ++v) {
    for (int u = 0; u < width; ++u) depth(v, u) = static_cast<ushort>(raw + 2 * u + v);
  }
  depth(0, 0) = 0;
  depth(0, 1) = 65535;
  return depth;
}

/// Three frames in 7-Scenes layout, numbers 10, 11 and 12, with a 3x3 intrinsic matrix.
inline void writeSevenScenes(const TinyFolder& folder) {
  folder.write("camera-intrinsics.txt", std::string("40 0 16\n0 41 12\n0 0 1\n"));
  for (int i = 0; i < 3; ++i) {
    const std::string stem = "frame-00001" + std::to_string(i);
    folder.write(stem + ".color.png", tinyColor(i));
    folder.write(stem + ".depth.png", tinyDepth(1000 + 100 * i));
    folder.write(stem + ".pose.txt", "1 0 0 " + std::to_string(i) + "\n0 1 0 0.5\n0 0 1 -2\n0 0 0 1\n");
  }
}

/// Three frames in TUM layout with a camera.txt and ground truth twice as dense as the images.
inline void writeTum(const TinyFolder& folder) {
  std::string rgb = "# colour\n", depth = "# depth\n", truth = "# truth\n";
  for (int i = 0; i < 3; ++i) {
    const std::string stamp = "100." + std::to_string(i) + "00";
    rgb += stamp + " rgb/" + stamp + ".png\n";
    depth += "100." + std::to_string(i) + "05 depth/" + stamp + ".png\n";
    folder.write("rgb/" + stamp + ".png", tinyColor(i));
    folder.write("depth/" + stamp + ".png", tinyDepth(5000 + 100 * i));
    truth += "100." + std::to_string(i) + "10 " + std::to_string(i) + " 0 0 0 0 0 1\n";
  }
  folder.write("rgb.txt", rgb);
  folder.write("depth.txt", depth);
  folder.write("groundtruth.txt", truth);
  folder.write("camera.txt", std::string("# fx ...\n40 41 16 12 32 24 5000\n"));
}

/// Three labelled frames a_1, a_2, a_3 of which a_2 has no label.
inline void writeLabelled(const TinyFolder& folder) {
  for (int i = 1; i <= 3; ++i) {
    const std::string name = "a_" + std::to_string(i) + ".png";
    folder.write("color/" + name, tinyColor(i));
    folder.write("depth/" + name, tinyDepth(1000 + i));
    cv::Mat label(kTinyHeight, kTinyWidth, i == 1 ? CV_8U : CV_16U, cv::Scalar(i == 1 ? 7 : 700));
    if (i != 2) folder.write("label/" + name, label);
  }
  folder.write("camera.txt", std::string("40 41 16 12 32 24 1000\n"));
}

}  // namespace saccade::test
