// How far our track and those of OpenCV's frame-to-frame odometries end up from the truth, on the same frames.
//
//   rival_tracks SEQUENCE [A:B:STEP]
//
// The truth are the poses of the dataset. Everyone gets the frames as Saccade reads them: without distortion, depth in
// the colour camera. OpenCV's methods run with the settings they come with; where one finds no motion, the camera is
// taken to stand still.

#include <algorithm>
#include <chrono>
#include <exception>
#include <functional>
#include <iostream>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd/depth.hpp>

#include "saccade/evaluation/trajectory_error.hpp"
#include "saccade/pipeline/explorer.hpp"
#include "saccade/sources/frame_source.hpp"

namespace {

using namespace saccade;

struct Track {
  std::vector<StampedPose> poses;
  int failures = 0;  ///< frames without a pose, or without a motion to them
  double ms = 0.0;   ///< of all frames
};

/// Calls `visit` with every frame that can be read.
void forEachFrame(const std::string& sequence, const FrameRange& range,
                  const std::function<void(const RgbdFrame&, const PinholeCamera&)>& visit) {
  const auto source = openSource(sequence, range);
  RgbdFrame frame;
  for (ReadStatus status = source->read(frame); status != ReadStatus::kEnd; status = source->read(frame)) {
    if (status == ReadStatus::kFrame) visit(frame, source->description().camera);
  }
}

template <typename Work>
void addTime(double& ms, const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  ms += std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

/// The whole system, as `saccade explore` runs it.
Track trackBySaccade(const std::string& sequence, const FrameRange& range) {
  Track track;
  std::unique_ptr<Explorer> explorer;
  forEachFrame(sequence, range, [&](const RgbdFrame& frame, const PinholeCamera& camera) {
    if (!explorer) explorer = std::make_unique<Explorer>(ExplorerConfig{}, camera);
    addTime(track.ms, [&] {
      const FrameReport report = explorer->process(frame);
      if (const auto T_WC = report.T_WC()) {
        track.poses.push_back({frame.stamp_s, *T_WC});
      } else {
        ++track.failures;
      }
    });
  });
  return track;
}

Track trackByOpenCv(const std::string& sequence, const FrameRange& range, const std::string& method) {
  Track track;
  cv::Ptr<cv::rgbd::Odometry> odometry;
  cv::Mat before_gray, before_m;
  Pose T_WC = Pose::Identity();
  forEachFrame(sequence, range, [&](const RgbdFrame& frame, const PinholeCamera& camera) {
    if (!odometry) {
      odometry = cv::rgbd::Odometry::create(method);
      odometry->setCameraMatrix(cv::Mat(cv::Matx33d(camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1)));
    }
    cv::Mat gray, depth_m = frame.depth_m.clone();
    cv::cvtColor(frame.color, gray, cv::COLOR_BGR2GRAY);
    depth_m.setTo(std::numeric_limits<float>::quiet_NaN(), depth_m <= 0.0F);
    if (!before_gray.empty()) {
      cv::Mat T_now_before;
      bool found = false;
      addTime(track.ms, [&] {
        found = odometry->compute(before_gray, before_m, before_m > 0.0F, gray, depth_m, depth_m > 0.0F, T_now_before);
      });
      if (found) {
        Pose motion;
        motion.matrix() = Eigen::Map<const Eigen::Matrix<double, 4, 4, Eigen::RowMajor>>(T_now_before.ptr<double>());
        T_WC = T_WC * motion.inverse();
      } else {
        ++track.failures;
      }
    }
    before_gray = gray;
    before_m = depth_m;
    track.poses.push_back({frame.stamp_s, T_WC});
  });
  return track;
}

void print(const std::string& method, const Track& track, const std::vector<StampedPose>& truth) {
  const AbsoluteError error = absoluteError(associate(track.poses, truth));
  std::cout << fmt::format("| {} | {} | {} | {:.1f} | {:.1f} | {:.1f} |\n", method, error.matched, track.failures,
                           1000.0 * error.rmse_m, 1000.0 * error.max_m,
                           track.ms / static_cast<double>(std::max<std::size_t>(1, track.poses.size())))
            << std::flush;
}

int run(const std::string& sequence, const FrameRange& range) {
  std::vector<StampedPose> truth;
  forEachFrame(sequence, range, [&](const RgbdFrame& frame, const PinholeCamera&) {
    if (frame.T_WC) truth.push_back({frame.stamp_s, *frame.T_WC});
  });
  std::cout << "| method | poses judged | frames without | ATE RMSE, mm | largest, mm | ms a frame |\n"
               "|---|---|---|---|---|---|\n";
  print("Saccade, the whole frame", trackBySaccade(sequence, range), truth);
  for (const char* method : {"RgbdOdometry", "RgbdICPOdometry", "ICPOdometry", "FastICPOdometry"}) {
    print(std::string("OpenCV ") + method, trackByOpenCv(sequence, range, method), truth);
  }
  return 0;
}

}  // namespace

int main(int count, char** arguments) {
  if (count < 2 || count > 3) {
    std::cerr << "usage: rival_tracks SEQUENCE [A:B:STEP]\n";
    return 2;
  }
  try {
    return run(arguments[1], count > 2 ? FrameRange::parse(arguments[2]) : FrameRange{});
  } catch (const std::exception& error) {
    std::cerr << "rival_tracks: " << error.what() << "\n";
    return 1;
  }
}
