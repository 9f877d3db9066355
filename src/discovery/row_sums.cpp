#include "discovery/row_sums.hpp"

#include <cstdint>
#include <cstring>

#include "saccade/core/multiversion.hpp"

namespace saccade {
namespace {

using FourFloats = float __attribute__((vector_size(16)));
using FourInts = std::int32_t __attribute__((vector_size(16)));
using FourDoubles = double __attribute__((vector_size(32)));

SACCADE_MULTIVERSION void sumColors(const float* saliency, const cv::Vec3b* color, int width, double* sums) {
  FourDoubles colors = {}, salient = {};
  for (int u = 0; u < width; ++u) {
    const int b = color[u][0], g = color[u][1], r = color[u][2];
    colors += __builtin_convertvector(FourInts{b, g, r, b * b + g * g + r * r}, FourDoubles);
    salient += FourDoubles{0.0, 0.0, static_cast<double>(saliency[u]), 0.0};
    double* next = sums + static_cast<std::size_t>(u + 1) * kRowSums;
    std::memcpy(next + kRowSaliency - 2, &salient, sizeof salient);
    std::memcpy(next + kRowColor, &colors, sizeof colors);
  }
}

SACCADE_MULTIVERSION void sumGeometry(const float* saliency, const cv::Vec3b* color, const cv::Vec3f* vertices,
                                      const cv::Vec3f* normals, int width, double* sums) {
  FourDoubles colors = {}, vertex = {}, normal = {}, scatter = {}, rest = {};
  for (int u = 0; u < width; ++u) {
    const int b = color[u][0], g = color[u][1], r = color[u][2];
    const float x = vertices[u][0], y = vertices[u][1], z = vertices[u][2];
    const float nx = normals[u][0], ny = normals[u][1], nz = normals[u][2];
    const float is_measured = z > 0.0F ? 1.0F : 0.0F;
    const float has_normal = nx != 0.0F || ny != 0.0F || nz != 0.0F ? 1.0F : 0.0F;
    colors += __builtin_convertvector(FourInts{b, g, r, b * b + g * g + r * r}, FourDoubles);
    vertex += __builtin_convertvector(FourFloats{x, y, z, is_measured}, FourDoubles);
    normal += __builtin_convertvector(FourFloats{nx, ny, nz, has_normal}, FourDoubles);
    scatter += __builtin_convertvector(FourFloats{x, x, x, y} * FourFloats{x, y, z, y}, FourDoubles);
    rest += __builtin_convertvector(FourFloats{y, z, saliency[u], 0.0F} * FourFloats{z, z, 1.0F, 0.0F}, FourDoubles);
    double* next = sums + static_cast<std::size_t>(u + 1) * kRowSums;
    std::memcpy(next + kRowVertex, &vertex, sizeof vertex);
    std::memcpy(next + kRowNormal, &normal, sizeof normal);
    std::memcpy(next + kRowScatter, &scatter, sizeof scatter);
    std::memcpy(next + kRowScatter + 4, &rest, sizeof rest);
    std::memcpy(next + kRowColor, &colors, sizeof colors);
  }
}

}  // namespace

void sumRow(int v, const cv::Mat1f& saliency, const cv::Mat3b& color, const DepthMaps* depth, double* sums) {
  std::memset(sums, 0, kRowSums * sizeof(double));
  if (depth == nullptr) {
    sumColors(saliency[v], color[v], color.cols, sums);
  } else {
    sumGeometry(saliency[v], color[v], depth->vertices[v], depth->normals[v], color.cols, sums);
  }
}

}  // namespace saccade
