// Colour and surface segments, beside OpenCV's graph segmentation and its planes of depth images.

#include <cstddef>
#include <vector>

#include <benchmark/benchmark.h>
#include <opencv2/rgbd.hpp>
#include <opencv2/ximgproc/segmentation.hpp>

#include "bench/kitchen_frames.hpp"
#include "saccade/core/depth_maps.hpp"
#include "saccade/discovery/perceiver.hpp"
#include "saccade/segmentation/color_segments.hpp"
#include "saccade/segmentation/surface_segments.hpp"

namespace saccade::bench {
namespace {

void segmentColors(benchmark::State& state, const ColorSegmentsConfig& config) {
  ColorSegmenter segmenter(config);
  const std::vector<RgbdFrame>& frames = kitchenFrames().frames;
  segmenter.segment(frames[0].color);  // reserves its memory
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(segmenter.segment(frames[i++ % frames.size()].color).labels.data);
  }
}

/// As exploring asks for them: of the halved image.
void colorSegments(benchmark::State& state) {
  segmentColors(state, PerceptionConfig::fineColor());
}
BENCHMARK(colorSegments)->Unit(benchmark::kMillisecond);

/// The paper's, of the whole image.
void colorSegmentsOfThePaper(benchmark::State& state) {
  segmentColors(state, {});
}
BENCHMARK(colorSegmentsOfThePaper)->Unit(benchmark::kMillisecond);

void colorSegmentsOfOpenCv(benchmark::State& state) {
  const ColorSegmentsConfig config;
  const auto rival =
      cv::ximgproc::segmentation::createGraphSegmentation(config.sigma, static_cast<float>(config.k), config.min_size);
  cv::Mat labels;
  const std::vector<RgbdFrame>& frames = kitchenFrames().frames;
  std::size_t i = 0;
  for (auto _ : state) {
    rival->processImage(frames[i++ % frames.size()].color, labels);
    benchmark::DoNotOptimize(labels.data);
  }
}
BENCHMARK(colorSegmentsOfOpenCv)->Unit(benchmark::kMillisecond);

/// Depth images cut to the working range, as preparation hands them on.
std::vector<DepthMaps> preparedFrames() {
  std::vector<DepthMaps> prepared;
  for (const RgbdFrame& frame : kitchenFrames().frames) {
    prepared.push_back(prepareDepth(frame.depth_m, kitchenFrames().camera));
  }
  return prepared;
}

/// With the smoothed normals of its own that they are grown from.
void surfaceSegments(benchmark::State& state) {
  const std::vector<DepthMaps> prepared = preparedFrames();
  SurfaceSegmenter segmenter;
  segmenter.segment(prepared[0]);  // reserves its memory
  std::size_t i = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(segmenter.segment(prepared[i++ % prepared.size()]).labels.data);
  }
}
BENCHMARK(surfaceSegments)->Unit(benchmark::kMillisecond);

/// Normals and the planes grown from them; OpenCV makes planes only, of at least 40 x 40 pixels.
void surfaceSegmentsOfOpenCv(benchmark::State& state) {
  const std::vector<DepthMaps> prepared = preparedFrames();
  const PinholeCamera& camera = kitchenFrames().camera;
  const cv::Matx33f intrinsics(static_cast<float>(camera.fx), 0.0F, static_cast<float>(camera.cx), 0.0F,
                               static_cast<float>(camera.fy), static_cast<float>(camera.cy), 0.0F, 0.0F, 1.0F);
  const cv::rgbd::RgbdNormals normals(camera.height, camera.width, CV_32F, cv::Mat(intrinsics));
  cv::rgbd::RgbdPlane planes;
  planes.setSensorErrorA(0.0075);
  normals.initialize();
  cv::Mat found_normals, mask;
  std::vector<cv::Vec4f> coefficients;
  std::size_t i = 0;
  for (auto _ : state) {
    const cv::Mat3f& points = prepared[i++ % prepared.size()].vertices;
    normals(points, found_normals);
    planes(points, found_normals, mask, coefficients);
    benchmark::DoNotOptimize(mask.data);
  }
}
BENCHMARK(surfaceSegmentsOfOpenCv)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace saccade::bench
