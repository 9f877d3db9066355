#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "saccade/core/camera.hpp"
#include "saccade/core/frame.hpp"
#include "saccade/simulation/scene.hpp"

namespace saccade {

enum class WhenFolderExists {
  kRefuse,   ///< unless it is empty
  kReplace,  ///< what an earlier sequence wrote is removed, other files are kept
};

/// Writes labelled RGB-D frames in TUM layout: `rgb/` (8-bit PNG), `depth/` (16-bit PNG, 5000 units a metre), `label/`
/// (16-bit PNG of object ids), `rgb.txt`, `depth.txt`, `groundtruth.txt` (T_WC), `intrinsics.yaml` and `objects.csv`.
/// saccade's own TUM reader reads it back, labels included.
///
/// Every function throws IoError where something cannot be written, a full disk included.
class SequenceWriter {
 public:
  SequenceWriter(const std::filesystem::path& folder, WhenFolderExists when, const PinholeCamera& camera);

  /// Appends a frame with colour, depth, label, stamp and pose. Depth beyond 13.1 m is written as none.
  void write(const RgbdFrame& frame);
  /// Writes `objects.csv`: id, kind, the number of frames that show it with a pixel at least, and its most pixels.
  void finish(const std::vector<SceneObject>& objects);

 private:
  struct Seen {
    std::int64_t frames = 0;
    std::int64_t most_pixels = 0;
  };

  void writePng(const std::filesystem::path& path, const cv::Mat& image);
  void countObjects(const cv::Mat1w& label);
  void appendLine(std::ofstream& list, const char* name, const std::string& line);

  std::filesystem::path folder_;
  std::ofstream rgb_list_, depth_list_, poses_;
  std::vector<Seen> seen_;  // by object id
  std::vector<unsigned char> bytes_;
  cv::Mat1w raw_depth_;
};

}  // namespace saccade
