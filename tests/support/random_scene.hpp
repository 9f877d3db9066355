#pragma once

#include <cmath>
#include <cstdint>
#include <random>

#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "saccade/core/depth_maps.hpp"
#include "saccade/discovery/perception.hpp"

namespace saccade::test {

/// Labels an image by the nearest of `sites` random points, about a tenth of them -1; every id has at least one pixel.
inline Segmentation randomSegmentation(cv::Size size, int sites, std::mt19937& random) {
  std::vector<cv::Point> points;
  for (int i = 0; i < sites; ++i) {
    points.emplace_back(static_cast<int>(random() % static_cast<unsigned>(size.width)),
                        static_cast<int>(random() % static_cast<unsigned>(size.height)));
  }
  Segmentation segmentation;
  segmentation.labels.create(size);
  std::vector<int> id_of(points.size(), -2);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      std::size_t nearest = 0;
      long best = -1;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const long du = points[i].x - u, dv = points[i].y - v, distance = du * du + dv * dv;
        if (best < 0 || distance < best) best = distance, nearest = i;
      }
      int& id = id_of[nearest];
      if (id == -2) id = nearest % 10 == 9 ? -1 : segmentation.count++;
      segmentation.labels(v, u) = id;
    }
  }
  return segmentation;
}

/// A wavy surface about 1 m away with random holes; vertices by the pinhole model, normals all towards the camera.
inline DepthMaps randomDepth(cv::Size size, std::mt19937& random) {
  DepthMaps depth;
  depth.camera = {size.width, size.height, 500.0, 500.0, (size.width - 1) / 2.0, (size.height - 1) / 2.0};
  depth.depth_m = cv::Mat1f::zeros(size);
  depth.vertices = cv::Mat3f::zeros(size);
  depth.normals = cv::Mat3f::zeros(size);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      if (random() % 8 == 0) continue;
      const double z =
          1.0 + 0.1 * std::sin(u * 0.2) + 0.1 * std::cos(v * 0.15) + 0.02 * static_cast<double>(random() % 5);
      const Eigen::Vector3d p = depth.camera.unproject(u, v, z);
      depth.depth_m(v, u) = static_cast<float>(z);
      depth.vertices(v, u) = {static_cast<float>(p.x()), static_cast<float>(p.y()), static_cast<float>(p.z())};
      depth.normals(v, u) = {0.0F, 0.0F, -1.0F};
    }
  }
  return depth;
}

struct RandomScene {
  cv::Mat3b image;
  DepthMaps depth;
  Perception seen;
};

/// A perception of random segments, saliency, colours and depth, with its tables made.
inline RandomScene randomScene(cv::Size size, int sites, unsigned seed, bool with_depth = true) {
  std::mt19937 random(seed);
  RandomScene scene;
  scene.image.create(size);
  cv::RNG fill(seed);
  fill.fill(scene.image, cv::RNG::UNIFORM, 0, 256);
  scene.seen.saliency.create(size);
  fill.fill(scene.seen.saliency, cv::RNG::UNIFORM, 0.0, 1.0);
  scene.seen.color = randomSegmentation(size, sites, random);
  scene.seen.surface = randomSegmentation(size, sites, random);
  scene.depth = randomDepth(size, random);
  scene.seen.makeTables(scene.image, with_depth ? &scene.depth : nullptr);
  return scene;
}

/// A candidate of the segments given, with box and area set.
inline Candidate candidateOf(const Perception& seen, CandidateSource source, std::vector<std::int32_t> segments) {
  Candidate candidate;
  candidate.source = source;
  SegmentSums sums;
  for (const std::int32_t segment : segments) sums += seen.table(source).sums(segment);
  candidate.segments = SegmentIds(std::move(segments));
  candidate.box = sums.box();
  candidate.area = sums.area;
  return candidate;
}

}  // namespace saccade::test
