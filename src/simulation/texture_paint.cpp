#include "simulation/texture_paint.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <opencv2/imgproc.hpp>

namespace saccade {
namespace {

/// Noise of about +-`reach` that repeats at the image's edges, smooth over size / cells pixels.
cv::Mat1f smoothNoise(cv::Size size, cv::Size cells, double reach, RandomStream& random) {
  cv::Mat1f coarse(cells);
  for (float& value : coarse) value = static_cast<float>(random.between(-reach, reach));
  cv::Mat1f repeated, smooth;
  cv::repeat(coarse, 3, 3, repeated);
  cv::resize(repeated, smooth, cv::Size(3 * size.width, 3 * size.height), 0, 0, cv::INTER_CUBIC);
  return smooth(cv::Rect(cv::Point(size.width, size.height), size)).clone();
}

cv::Vec3b shaded(const cv::Scalar& color, double grey_levels) {
  cv::Vec3b result;
  for (int channel = 0; channel < 3; ++channel) {
    result[channel] = cv::saturate_cast<uchar>(color[channel] * (1.0 + grey_levels / 160.0));
  }
  return result;
}

cv::Mat3b shadedBy(const cv::Scalar& color, const cv::Mat1f& grey_levels) {
  cv::Mat3b image(grey_levels.size());
  for (int v = 0; v < image.rows; ++v) {
    for (int u = 0; u < image.cols; ++u) image(v, u) = shaded(color, static_cast<double>(grey_levels(v, u)));
  }
  return image;
}

}  // namespace

cv::Scalar vividColor(RandomStream& random) {
  const double hue = random.between(0, 6), value = random.between(105, 225), saturation = random.between(0.4, 0.85);
  cv::Scalar color;
  for (int channel = 0; channel < 3; ++channel) {
    const double wave = std::clamp(0.5 + std::cos(std::numbers::pi / 3 * (hue - 2 * channel)), 0.0, 1.0);
    color[channel] = value * (1 - saturation + saturation * wave);
  }
  return color;
}

cv::Scalar quietColor(RandomStream& random) {
  static const cv::Scalar kQuiet[] = {{225, 232, 235}, {200, 205, 205}, {150, 155, 158}, {170, 200, 220},
                                      {120, 160, 190}, {60, 90, 130},   {70, 72, 75},    {40, 42, 46},
                                      {190, 215, 225}, {95, 110, 115}};
  cv::Scalar color = kQuiet[random.below(10)];
  const double factor = random.between(0.88, 1.08);
  return color * factor;
}

cv::Scalar anyColor(RandomStream& random, double vivid_share) {
  return random.chance(vivid_share) ? vividColor(random) : quietColor(random);
}

double brightnessOf(const cv::Scalar& bgr) {
  return 0.11 * bgr[0] + 0.59 * bgr[1] + 0.3 * bgr[2];
}

cv::Scalar inkOn(const cv::Scalar& ground, RandomStream& random) {
  const cv::Scalar tint = vividColor(random);
  return brightnessOf(ground) > 125 ? cv::Scalar(tint * 0.35) : cv::Scalar(cv::Scalar::all(175) + tint * 0.3);
}

cv::Mat3b paintMottled(const cv::Scalar& color, double contrast, RandomStream& random) {
  const cv::Size size(128, 128);
  cv::Mat1f levels = smoothNoise(size, {5, 5}, (0.6 * contrast), random);
  levels += smoothNoise(size, {32, 32}, (0.4 * contrast), random);
  return shadedBy(color, levels);
}

cv::Mat3b paintWood(const cv::Scalar& color, RandomStream& random) {
  const cv::Size size(512, 512);
  constexpr int kBoards = 4;
  cv::Mat1f levels = smoothNoise(size, {4, 96}, 22.0, random);
  levels += smoothNoise(size, {3, 24}, 18.0, random);
  levels += smoothNoise(size, {24, 256}, 9.0, random);
  for (int board = 0; board < kBoards; ++board) {
    const int top = board * size.height / kBoards;
    levels.rowRange(top, top + size.height / kBoards) += random.between(-16, 16);
    levels.row(top) -= 45;
    levels.row(top + 1) -= 20;
    const int joint = random.below(size.width);
    levels.rowRange(top, top + size.height / kBoards).col(joint) -= 40;
  }
  return shadedBy(color, levels);
}

cv::Mat3b paintStone(const cv::Scalar& color, RandomStream& random) {
  const cv::Size size(384, 384);
  cv::Mat1f levels = smoothNoise(size, {6, 6}, 10.0, random);
  levels += smoothNoise(size, {96, 96}, 26.0, random);
  levels += smoothNoise(size, {190, 190}, 20.0, random);
  return shadedBy(color, levels);
}

cv::Mat3b paintTiles(const cv::Scalar& color, RandomStream& random, int tiles) {
  const int size = 256 / tiles;
  cv::Mat3b image(size * tiles, size * tiles);
  for (int row = 0; row < tiles; ++row) {
    for (int column = 0; column < tiles; ++column) {
      const cv::Rect tile(column * size, row * size, size, size);
      image(tile).setTo(shaded(color, random.between(-9, 9)));
      cv::rectangle(image, tile, color * 0.72, 1);
      cv::rectangle(image, tile + cv::Point(1, 1), color * 1.06, 1);
    }
  }
  return image;
}

cv::Mat3b paintCarpet(const cv::Scalar& color, RandomStream& random) {
  const cv::Size size(384, 384);
  const double contrast = random.between(8, 45);
  cv::Mat1f levels = smoothNoise(size, {24, 24}, 8.0, random);
  levels += smoothNoise(size, {6, 192}, 0.6 * contrast, random);
  levels += smoothNoise(size, {3, 64}, 0.5 * contrast, random);
  levels += smoothNoise(size, {190, 190}, 12.0, random);
  return shadedBy(color, levels);
}

cv::Mat3b paintCloth(RandomStream& random) {
  const cv::Size size(256, 256);
  const cv::Scalar ground = anyColor(random), second = anyColor(random);
  cv::Mat3b image(size, cv::Vec3b(0, 0, 0));
  image.setTo(ground);
  const int period = 16 << random.below(3);
  const bool checks = random.chance(0.5);
  cv::Mat3b other(size, cv::Vec3b(0, 0, 0));
  other.setTo(second);
  for (int at = 0; at < 256; at += period) {
    const cv::Rect row(0, at, 256, period / 2), column(at, 0, period / 2, 256);
    cv::addWeighted(image(row), 0.4, other(row), 0.6, 0, image(row));
    if (checks) cv::addWeighted(image(column), 0.5, other(column), 0.5, 0, image(column));
  }
  const cv::Mat1f weave = smoothNoise(size, {128, 128}, 14.0, random);
  for (int v = 0; v < size.height; ++v) {
    for (int u = 0; u < size.width; ++u) {
      const cv::Vec3b pixel = image(v, u);
      image(v, u) = shaded(cv::Scalar(pixel[0], pixel[1], pixel[2]), static_cast<double>(weave(v, u)));
    }
  }
  return image;
}

}  // namespace saccade
