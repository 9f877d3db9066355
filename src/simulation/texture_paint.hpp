#pragma once

#include <opencv2/core.hpp>

#include "simulation/random_hash.hpp"

namespace saccade {

/// Everyday colours and the textures of raw materials. All draw their random numbers from the stream they are given.

/// A saturated colour of print, paint or glaze.
[[nodiscard]] cv::Scalar vividColor(RandomStream& random);
/// White, grey, beige, brown or black, as many things are.
[[nodiscard]] cv::Scalar quietColor(RandomStream& random);
/// One of the two; `vivid_share` of the draws are vivid.
[[nodiscard]] cv::Scalar anyColor(RandomStream& random, double vivid_share = 0.65);
[[nodiscard]] double brightnessOf(const cv::Scalar& bgr);
/// Dark on light colours, light on dark ones.
[[nodiscard]] cv::Scalar inkOn(const cv::Scalar& ground, RandomStream& random);

/// Even colour with soft mottling of `contrast` grey levels: plaster, ceramic, plastic, fruit.
[[nodiscard]] cv::Mat3b paintMottled(const cv::Scalar& color, double contrast, RandomStream& random);
/// Boards of wood with grain along u; repeats without a seam.
[[nodiscard]] cv::Mat3b paintWood(const cv::Scalar& color, RandomStream& random);
/// Speckled stone for counters.
[[nodiscard]] cv::Mat3b paintStone(const cv::Scalar& color, RandomStream& random);
/// Glazed wall tiles with joints, `tiles` by `tiles` in a texture.
[[nodiscard]] cv::Mat3b paintTiles(const cv::Scalar& color, RandomStream& random, int tiles = 4);
/// Carpet: thin stripes along u of many shades.
[[nodiscard]] cv::Mat3b paintCarpet(const cv::Scalar& color, RandomStream& random);
/// Woven cloth: checks or stripes in two or three colours.
[[nodiscard]] cv::Mat3b paintCloth(RandomStream& random);

}  // namespace saccade
