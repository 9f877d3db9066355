#include "saccade/sources/given_poses.hpp"

namespace saccade {
namespace {

constexpr double kMaxStampDifference_s = 0.01;

}  // namespace

GivenPoses GivenPoses::open(const std::string& file) {
  GivenPoses given;
  given.from_dataset_ = file == "dataset";
  if (!given.from_dataset_) given.poses_ = StampedPoses::loadStrictly(file);
  return given;
}

std::optional<Pose> GivenPoses::find(const RgbdFrame& frame) const {
  return from_dataset_ ? frame.T_WC : poses_.nearest(frame.stamp_s, kMaxStampDifference_s);
}

}  // namespace saccade
