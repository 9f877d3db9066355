#include "saccade/simulation/sequence_writer.hpp"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>
#include <fmt/format.h>
#include <opencv2/imgcodecs.hpp>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

constexpr double kDepthUnitsPerMetre = 5000.0;
const char* const kFolders[] = {"rgb", "depth", "label"};
const char* const kFiles[] = {"rgb.txt", "depth.txt", "groundtruth.txt", "intrinsics.yaml", "objects.csv"};

void removeSequence(const std::filesystem::path& folder) {
  std::error_code error;
  for (const char* name : kFolders) std::filesystem::remove_all(folder / name, error);
  for (const char* name : kFiles) std::filesystem::remove(folder / name, error);
}

void prepareFolder(const std::filesystem::path& folder, WhenFolderExists when) {
  std::error_code error;
  if (std::filesystem::exists(folder, error)) {
    if (!std::filesystem::is_directory(folder, error)) throw IoError(folder, "a folder to write to", "a file");
    if (when == WhenFolderExists::kReplace) {
      removeSequence(folder);
    } else if (!std::filesystem::is_empty(folder, error) || error) {
      throw IoError(folder, "no folder of that name yet, or an empty one (--force replaces a sequence)",
                    error ? error.message() : "one that holds files");
    }
  }
  for (const char* name : kFolders) {
    std::filesystem::create_directories(folder / name, error);
    if (error) throw IoError(folder / name, "a folder that can be made", error.message());
  }
}

std::ofstream openText(const std::filesystem::path& path) {
  std::ofstream file(path);
  if (!file) throw IoError(path, "a file that can be written", "none");
  return file;
}

void requireWritten(std::ofstream& file, const std::filesystem::path& path) {
  file.flush();
  if (!file) throw IoError(path, "room for the file", "it could not be written in full");
}

}  // namespace

SequenceWriter::SequenceWriter(const std::filesystem::path& folder, WhenFolderExists when, const PinholeCamera& camera)
    : folder_(folder) {
  prepareFolder(folder, when);
  rgb_list_ = openText(folder / "rgb.txt");
  depth_list_ = openText(folder / "depth.txt");
  poses_ = openText(folder / "groundtruth.txt");
  appendLine(rgb_list_, "rgb.txt", "# timestamp filename");
  appendLine(depth_list_, "depth.txt", "# timestamp filename");
  appendLine(poses_, "groundtruth.txt", "# timestamp tx ty tz qx qy qz qw");
  std::ofstream intrinsics = openText(folder / "intrinsics.yaml");
  intrinsics << fmt::format("width: {}\nheight: {}\nfx: {}\nfy: {}\ncx: {}\ncy: {}\ndepth_units_per_metre: {}\n",
                            camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy,
                            kDepthUnitsPerMetre);
  requireWritten(intrinsics, folder / "intrinsics.yaml");
}

void SequenceWriter::appendLine(std::ofstream& list, const char* name, const std::string& line) {
  list << line << '\n';
  requireWritten(list, folder_ / name);
}

void SequenceWriter::writePng(const std::filesystem::path& path, const cv::Mat& image) {
  // The fastest compression: synthetic noise does not shrink further.
  cv::imencode(".png", image, bytes_, {cv::IMWRITE_PNG_COMPRESSION, 1});
  std::ofstream file(path, std::ios::binary);
  if (!file) throw IoError(path, "a file that can be written", "none");
  file.write(reinterpret_cast<const char*>(bytes_.data()), static_cast<std::streamsize>(bytes_.size()));
  requireWritten(file, path);
}

void SequenceWriter::countObjects(const cv::Mat1w& label) {
  std::vector<std::int64_t> pixels(seen_.size(), 0);
  for (const ushort id : label) {
    if (id >= pixels.size()) pixels.resize(id + 1u, 0);
    ++pixels[id];
  }
  seen_.resize(pixels.size());
  for (std::size_t id = 0; id < pixels.size(); ++id) {
    seen_[id].frames += pixels[id] > 0 ? 1 : 0;
    seen_[id].most_pixels = std::max(seen_[id].most_pixels, pixels[id]);
  }
}

void SequenceWriter::write(const RgbdFrame& frame) {
  raw_depth_.create(frame.depth_m.size());
  std::transform(frame.depth_m.begin(), frame.depth_m.end(), raw_depth_.begin(), [](float depth_m) {
    const double raw = std::round(static_cast<double>(depth_m) * kDepthUnitsPerMetre);
    return static_cast<ushort>(raw > 65535.0 ? 0.0 : raw);
  });
  const std::string file = frame.name + ".png";
  writePng(folder_ / "rgb" / file, frame.color);
  writePng(folder_ / "depth" / file, raw_depth_);
  writePng(folder_ / "label" / file, frame.label);
  countObjects(frame.label);

  appendLine(rgb_list_, "rgb.txt", fmt::format("{:.6f} rgb/{}", frame.stamp_s, file));
  appendLine(depth_list_, "depth.txt", fmt::format("{:.6f} depth/{}", frame.stamp_s, file));
  const Eigen::Vector3d& t = frame.T_WC->translation();
  const Eigen::Quaterniond q(frame.T_WC->linear());
  appendLine(poses_, "groundtruth.txt",
             fmt::format("{:.6f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f} {:.9f}", frame.stamp_s, t.x(), t.y(), t.z(),
                         q.x(), q.y(), q.z(), q.w()));
}

void SequenceWriter::finish(const std::vector<SceneObject>& objects) {
  std::ofstream file = openText(folder_ / "objects.csv");
  file << "id,kind,frames,most_pixels\n";
  for (const SceneObject& object : objects) {
    const auto id = static_cast<std::size_t>(object.id);
    const Seen seen = id < seen_.size() ? seen_[id] : Seen{};
    file << object.id << ',' << object.kind << ',' << seen.frames << ',' << seen.most_pixels << '\n';
  }
  requireWritten(file, folder_ / "objects.csv");
}

}  // namespace saccade
