#include "session_frames.hpp"

#include <cmath>
#include <iostream>
#include <stdexcept>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "saccade/core/errors.hpp"
#include "saccade/exchange/session_alignment.hpp"

namespace saccade::app {
namespace {

Pose givenTransform(const std::vector<double>& numbers) {
  const Eigen::Quaterniond q(numbers[6], numbers[3], numbers[4], numbers[5]);
  constexpr double kRounding = 1e-3;  // of numbers typed from a file
  if (!(std::abs(q.norm() - 1.0) < kRounding)) {
    throw std::invalid_argument(
        "--transform expects tx ty tz qx qy qz qw with a quaternion of length 1, found length " +
        std::to_string(q.norm()));
  }
  return Pose(Eigen::Translation3d(numbers[0], numbers[1], numbers[2]) * q.normalized());
}

}  // namespace

void SessionFrames::addTo(CLI::App& command) {
  CLI::Option* given =
      command
          .add_option("--transform", transform,
                      "tx ty tz qx qy qz qw that takes points of B's world frame to A's (default: the same frame)")
          ->expected(7);
  command.add_flag("--align", align, "find that transform: relocalise B's keyframes in A")->excludes(given);
}

Pose SessionFrames::resolve(const SessionReader& a, const SessionReader& b) const {
  if (!transform.empty()) return givenTransform(transform);
  if (!align) return Pose::Identity();
  const auto alignment = alignSessions(a, b);
  if (!alignment) {
    throw IoError(b.path(), "keyframes that are found in " + a.path().string() + " (or --transform)", "too few");
  }
  const Eigen::Vector3d t = alignment->T_AB.translation();
  const Eigen::Quaterniond q(alignment->T_AB.linear());
  std::cerr << fmt::format("{} of {} keyframes found agree: --transform {} {} {} {} {} {} {}\n", alignment->agreeing,
                           alignment->found, t.x(), t.y(), t.z(), q.x(), q.y(), q.z(), q.w());
  return alignment->T_AB;
}

}  // namespace saccade::app
