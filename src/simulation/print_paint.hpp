#pragma once

#include <opencv2/core.hpp>

#include "simulation/random_hash.hpp"

namespace saccade {

/// Printed things as they come from a shop: brand names, pictures, small print, barcodes. Sizes of the surface in
/// metres set the proportions.

/// A package in the layout of kFrontWindow, kSideWindow and kTopWindow.
[[nodiscard]] cv::Mat3b paintPackage(double front_width_m, double front_height_m, RandomStream& random);
/// A book's cover in the same layout: sides show pages, or the spine.
[[nodiscard]] cv::Mat3b paintBook(double width_m, double height_m, RandomStream& random);
/// The wrap of a bottle, can or jar: `label_top` .. `label_bottom` of its height is a printed label, the rest is
/// `ground`; `cap_share` of the height at the top has a colour of its own.
[[nodiscard]] cv::Mat3b paintWrap(const cv::Scalar& ground, double label_top, double label_bottom, double cap_share,
                                  RandomStream& random);
/// Glazed ware, plain or with stripes, dots or an emblem.
[[nodiscard]] cv::Mat3b paintWare(RandomStream& random);
/// A picture for the wall: a landscape, an abstract print or a chart with text.
[[nodiscard]] cv::Mat3b paintPoster(double width_m, double height_m, RandomStream& random);
/// A page of text, with or without a heading, a table or a picture.
[[nodiscard]] cv::Mat3b paintDocument(double width_m, double height_m, RandomStream& random);
/// The cover of a magazine or leaflet: an even ground or a picture that fills it, a title, lines of text.
[[nodiscard]] cv::Mat3b paintCover(double width_m, double height_m, RandomStream& random);
/// Rows of keys on a dark or light ground.
[[nodiscard]] cv::Mat3b paintKeys(int columns, int rows, RandomStream& random);

}  // namespace saccade
