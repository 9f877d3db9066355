// What a user of PCL would take instead: registration, normals, region growing, convex hulls. Seconds a call: few
// repetitions.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <pcl/features/integral_image_normal.h>
#include <pcl/features/normal_3d.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/registration/gicp.h>
#include <pcl/registration/icp.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/region_growing.h>
#include <pcl/surface/convex_hull.h>
#include <random>
#include <vector>

#include <benchmark/benchmark.h>

#include "bench/prepared_frames.hpp"
#include "saccade/discovery/convex_hull.hpp"

namespace saccade::bench {
namespace {

using Cloud = pcl::PointCloud<pcl::PointXYZ>;

/// All pixels of a frame, in rows; those without measurement are NaN.
Cloud::Ptr organisedCloud(const DepthMaps& depth) {
  const auto cloud =
      pcl::make_shared<Cloud>(static_cast<unsigned>(depth.vertices.cols), static_cast<unsigned>(depth.vertices.rows));
  std::size_t i = 0;
  for (const cv::Vec3f& p : depth.vertices) {
    const float hole = std::numeric_limits<float>::quiet_NaN();
    (*cloud)[i++] = p[2] > 0.0F ? pcl::PointXYZ(p[0], p[1], p[2]) : pcl::PointXYZ(hole, hole, hole);
  }
  cloud->is_dense = false;
  return cloud;
}

/// The measured pixels of every `step`-th row and column.
Cloud::Ptr measuredCloud(const DepthMaps& depth, int step) {
  const auto cloud = pcl::make_shared<Cloud>();
  for (int v = 0; v < depth.vertices.rows; v += step) {
    for (int u = 0; u < depth.vertices.cols; u += step) {
      const cv::Vec3f& p = depth.vertices(v, u);
      if (p[2] > 0.0F) cloud->push_back({p[0], p[1], p[2]});
    }
  }
  return cloud;
}

/// Frame to the frame before, of every second pixel as our tracker takes them.
template <typename Registration>
void trackByPcl(benchmark::State& state) {
  const auto& frames = preparedFrames();
  std::size_t i = 0;
  for (auto _ : state) {
    const std::size_t before = i++ % (frames.size() - 1);
    Registration registration;
    registration.setInputSource(measuredCloud(frames[before + 1].depth, 2));
    registration.setInputTarget(measuredCloud(frames[before].depth, 2));
    registration.setMaxCorrespondenceDistance(0.1);
    Cloud aligned;
    registration.align(aligned);
    benchmark::DoNotOptimize(aligned.size());
  }
}
BENCHMARK(trackByPcl<pcl::IterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>>)
    ->Name("trackByPclIcp")
    ->Unit(benchmark::kMillisecond)
    ->Iterations(2);
BENCHMARK(trackByPcl<pcl::GeneralizedIterativeClosestPoint<pcl::PointXYZ, pcl::PointXYZ>>)
    ->Name("trackByPclGicp")
    ->Unit(benchmark::kMillisecond)
    ->Iterations(2);

void normalsOfPcl(benchmark::State& state) {
  const auto& frames = preparedFrames();
  std::size_t i = 0;
  for (auto _ : state) {
    state.PauseTiming();
    const Cloud::Ptr cloud = organisedCloud(frames[i++ % frames.size()].depth);
    state.ResumeTiming();
    pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setNormalEstimationMethod(estimation.AVERAGE_3D_GRADIENT);
    estimation.setMaxDepthChangeFactor(0.02F);
    estimation.setNormalSmoothingSize(10.0F);
    estimation.setInputCloud(cloud);
    pcl::PointCloud<pcl::Normal> normals;
    estimation.compute(normals);
    benchmark::DoNotOptimize(normals.size());
  }
}
BENCHMARK(normalsOfPcl)->Unit(benchmark::kMillisecond)->Iterations(5);

/// Region growing (Rabbani et al. 2006) with the normals that it needs.
void surfaceSegmentsOfPcl(benchmark::State& state) {
  const auto& frames = preparedFrames();
  std::size_t i = 0;
  for (auto _ : state) {
    const Cloud::Ptr cloud = measuredCloud(frames[i++ % frames.size()].depth, 1);
    const auto tree = pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>();
    const auto normals = pcl::make_shared<pcl::PointCloud<pcl::Normal>>();
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
    estimation.setSearchMethod(tree);
    estimation.setInputCloud(cloud);
    estimation.setKSearch(30);
    estimation.compute(*normals);
    pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
    growing.setSearchMethod(tree);
    growing.setInputCloud(cloud);
    growing.setInputNormals(normals);
    growing.setMinClusterSize(150);
    std::vector<pcl::PointIndices> clusters;
    growing.extract(clusters);
    benchmark::DoNotOptimize(clusters.size());
  }
}
BENCHMARK(surfaceSegmentsOfPcl)->Unit(benchmark::kMillisecond)->Iterations(2);

std::vector<Eigen::Vector3f> pointsInABall(std::int64_t count) {
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  std::vector<Eigen::Vector3f> points;
  for (std::int64_t i = 0; i < count; ++i) points.emplace_back(normal(random), normal(random), normal(random));
  return points;
}

void convexHull(benchmark::State& state) {
  const std::vector<Eigen::Vector3f> points = pointsInABall(state.range(0));
  ConvexHull hull;
  for (auto _ : state) benchmark::DoNotOptimize(hull.build(points));
}
BENCHMARK(convexHull)->Arg(32)->Arg(200)->Arg(1000)->Unit(benchmark::kMicrosecond);

void convexHullOfPcl(benchmark::State& state) {
  const auto cloud = pcl::make_shared<Cloud>();
  for (const Eigen::Vector3f& p : pointsInABall(state.range(0))) cloud->push_back({p.x(), p.y(), p.z()});
  for (auto _ : state) {
    pcl::ConvexHull<pcl::PointXYZ> hull;
    hull.setDimension(3);
    hull.setInputCloud(cloud);
    Cloud corners;
    hull.reconstruct(corners);
    benchmark::DoNotOptimize(corners.size());
  }
}
BENCHMARK(convexHullOfPcl)->Arg(32)->Arg(200)->Arg(1000)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace saccade::bench
