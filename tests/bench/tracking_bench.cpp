#include <benchmark/benchmark.h>
#include <opencv2/imgproc.hpp>
#include <opencv2/rgbd/depth.hpp>

#include "bench/prepared_frames.hpp"
#include "saccade/tracking/tracker.hpp"

namespace saccade::bench {
namespace {

/// Frame to model: the view of the whole kitchen from the pose of the frame before, five frames of the video back, and
/// that frame's colour; with the frame's own grey values.
void trackFrameToModel(benchmark::State& state) {
  const SurfaceVolume volume = surfaceOfKitchen();
  const auto& frames = preparedFrames();
  Tracker tracker;
  ModelView model;
  PhotometricReference reference;
  IntensityPyramid intensity;
  std::size_t i = 0;
  double tracked = 0.0;
  for (auto _ : state) {
    state.PauseTiming();
    const PreparedFrame& before = frames[i % (frames.size() - 1)];
    const PreparedFrame& now = frames[i % (frames.size() - 1) + 1];
    ++i;
    volume.rayCast(before.depth.camera.reducedBy(2), before.T_WC, model);
    intensity.build(before.color, before.depth.camera);
    reference.take(before.depth, intensity, before.T_WC);
    state.ResumeTiming();
    intensity.build(now.color, now.depth.camera);
    const TrackedColor color{intensity, reference};
    tracked += tracker.track(now.depth, model, before.T_WC, &color).status == TrackingStatus::kTracked ? 1.0 : 0.0;
  }
  state.counters["tracked"] = benchmark::Counter(tracked, benchmark::Counter::kAvgIterations);
}
BENCHMARK(trackFrameToModel)->Unit(benchmark::kMillisecond);

/// OpenCV's odometry of a frame to the one before, with the settings it comes with.
template <typename Odometry>
void trackByOpenCv(benchmark::State& state) {
  const KitchenFrames& kitchen = kitchenFrames();
  const cv::Matx33d intrinsics(kitchen.camera.fx, 0, kitchen.camera.cx, 0, kitchen.camera.fy, kitchen.camera.cy, 0, 0,
                               1);
  const auto odometry = Odometry::create(cv::Mat(intrinsics));
  std::vector<cv::Mat> gray(kitchen.frames.size());
  for (std::size_t i = 0; i < gray.size(); ++i) cv::cvtColor(kitchen.frames[i].color, gray[i], cv::COLOR_BGR2GRAY);
  std::size_t i = 0;
  double tracked = 0.0;
  for (auto _ : state) {
    const std::size_t before = i++ % (gray.size() - 1);
    const cv::Mat before_m = kitchen.frames[before].depth_m, now_m = kitchen.frames[before + 1].depth_m;
    cv::Mat moved;
    const bool found =
        odometry->compute(gray[before], before_m, before_m > 0.0, gray[before + 1], now_m, now_m > 0.0, moved);
    tracked += found ? 1.0 : 0.0;
  }
  state.counters["tracked"] = benchmark::Counter(tracked, benchmark::Counter::kAvgIterations);
}
BENCHMARK(trackByOpenCv<cv::rgbd::RgbdOdometry>)->Unit(benchmark::kMillisecond)->Iterations(10);
BENCHMARK(trackByOpenCv<cv::rgbd::FastICPOdometry>)->Unit(benchmark::kMillisecond)->Iterations(10);

}  // namespace
}  // namespace saccade::bench
