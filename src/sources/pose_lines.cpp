#include "sources/pose_lines.hpp"

#include <array>
#include <cmath>
#include <fstream>
#include <sstream>

#include "saccade/core/errors.hpp"
#include "sources/text_numbers.hpp"

namespace saccade {
namespace {

constexpr double kMaxLengthError = 0.02;

PoseLine parsePoseLine(std::size_t line, const std::vector<std::string_view>& words, std::size_t most_words) {
  PoseLine parsed{line, std::string(words[0]), parseNumber(words[0]), std::nullopt, "", std::nullopt};
  if (words.size() < 8 || words.size() > most_words) {
    parsed.complaint = std::to_string(words.size()) + " words instead of 8";
    return parsed;
  }
  std::array<double, 7> numbers{};
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    const std::optional<double> number = parseNumber(words[i + 1]);
    if (!number || !std::isfinite(*number)) {
      parsed.complaint = inQuotes(words[i + 1]) + " where a finite number belongs";
      return parsed;
    }
    numbers[i] = *number;
  }
  const Eigen::Quaterniond rotation(numbers[6], numbers[3], numbers[4], numbers[5]);
  if (std::abs(rotation.norm() - 1.0) > kMaxLengthError) {
    std::ostringstream complaint;
    complaint << "a quaternion of length " << rotation.norm();
    parsed.complaint = complaint.str();
    return parsed;
  }
  Pose pose = Pose::Identity();
  pose.linear() = rotation.normalized().toRotationMatrix();
  pose.translation() = Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
  parsed.pose = pose;
  if (words.size() > 8) parsed.last = parseNumber(words[8]);
  return parsed;
}

}  // namespace

std::vector<PoseLine> readPoseLines(const std::filesystem::path& path, std::size_t most_words) {
  std::ifstream file(path);
  if (!file) throw IoError(path, "a trajectory (stamp tx ty tz qx qy qz qw)", "nothing that can be read");
  std::vector<PoseLine> lines;
  std::string text;
  for (std::size_t line = 1; std::getline(file, text); ++line) {
    const std::vector<std::string_view> words = splitWords(text);
    if (words.empty() || words[0].front() == '#') continue;
    lines.push_back(parsePoseLine(line, words, most_words));
  }
  return lines;
}

std::optional<Pose> rigidFromMatrix(const Eigen::Matrix4d& matrix) {
  if (!matrix.allFinite()) return std::nullopt;
  if (!matrix.row(3).isApprox(Eigen::RowVector4d(0, 0, 0, 1), kMaxLengthError)) return std::nullopt;
  const Eigen::Matrix3d rotation = matrix.topLeftCorner<3, 3>();
  const Eigen::Matrix3d gram = rotation.transpose() * rotation;
  for (int i = 0; i < 9; ++i) {
    // Lengths enter squared, hence twice the error.
    if (std::abs(gram(i / 3, i % 3) - (i % 4 == 0 ? 1.0 : 0.0)) > 2 * kMaxLengthError) return std::nullopt;
  }
  if (rotation.determinant() < 0) return std::nullopt;
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::Quaterniond(rotation).normalized().toRotationMatrix();
  pose.translation() = matrix.topRightCorner<3, 1>();
  return pose;
}

std::optional<Eigen::Matrix4d> readMatrix4(const std::filesystem::path& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  const std::string content = text.str();
  const std::vector<std::string_view> words = splitWords(content);
  if (words.size() != 16) return std::nullopt;
  Eigen::Matrix4d matrix;
  for (int i = 0; i < 16; ++i) {
    const std::optional<double> number = parseNumber(words[static_cast<std::size_t>(i)]);
    if (!number) return std::nullopt;
    matrix(i / 4, i % 4) = *number;
  }
  return matrix;
}

std::optional<Pose> readPoseMatrix(const std::filesystem::path& path) {
  const std::optional<Eigen::Matrix4d> matrix = readMatrix4(path);
  return matrix ? rigidFromMatrix(*matrix) : std::nullopt;
}

}  // namespace saccade
