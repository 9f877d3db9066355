#include "simulation/print_paint.hpp"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include <opencv2/imgproc.hpp>

#include "simulation/texture_paint.hpp"

namespace saccade {
namespace {

const char* const kBrands[] = {"NOVA", "Alba",  "Brisk", "Casa",  "Delfi", "Ekko",   "FRUTTI", "Gusto",  "Halo",
                               "Iris", "Juno",  "KORN",  "Lumen", "Mira",  "Nordic", "Oliva",  "Pronto", "Quell",
                               "Rio",  "Salto", "Terra", "Ultra", "Vita",  "WAVE",   "Yam",    "Zest"};
const char* const kWords[] = {"classic", "fresh", "original", "organic", "light",  "family", "500 g",   "new",
                              "crispy",  "pure",  "mild",     "strong",  "Vol. 2", "garden", "stories", "atlas"};

const char* brand(RandomStream& random) {
  return kBrands[random.below(26)];
}
const char* word(RandomStream& random) {
  return kWords[random.below(16)];
}

/// Text that fills the width of `area`, at most its height; centred.
void drawText(cv::Mat3b& image, const cv::Rect& area, const std::string& text, const cv::Scalar& ink, int weight,
              RandomStream& random) {
  static const int kFonts[] = {cv::FONT_HERSHEY_DUPLEX, cv::FONT_HERSHEY_COMPLEX, cv::FONT_HERSHEY_TRIPLEX,
                               cv::FONT_HERSHEY_SCRIPT_COMPLEX};
  const int font = kFonts[random.below(4)];
  int baseline = 0;
  const cv::Size unit = cv::getTextSize(text, font, 1.0, weight, &baseline);
  const int descent = baseline / 2;
  const double scale = std::min(0.9 * area.width / unit.width, 0.85 * area.height / (unit.height + descent));
  const cv::Size size = cv::getTextSize(text, font, scale, weight, &baseline);
  cv::putText(image, text, {area.x + (area.width - size.width) / 2, area.y + (area.height + size.height) / 2}, font,
              scale, ink, weight, cv::LINE_AA);
}

/// Grey lines of words too small to read.
void drawSmallPrint(cv::Mat3b& image, const cv::Rect& area, const cv::Scalar& ink, RandomStream& random) {
  for (int y = area.y; y + 3 < area.br().y; y += 6) {
    int x = area.x;
    while (x < area.br().x - 4) {
      const int length = std::min(3 + random.below(14), area.br().x - x);
      cv::line(image, {x, y}, {x + length, y}, ink, 1);
      x += length + 4;
    }
  }
}

void drawBarcode(cv::Mat3b& image, const cv::Rect& area, RandomStream& random) {
  cv::rectangle(image, area, {245, 245, 245}, cv::FILLED);
  for (int x = area.x + 2; x < area.br().x - 2;) {
    const int bar = 1 + random.below(3);
    cv::rectangle(image, {x, area.y + 2, bar, area.height - 4}, {20, 20, 20}, cv::FILLED);
    x += bar + 1 + random.below(3);
  }
}

/// A pictogram of what is inside: fruit, flakes, a star, hills or rings.
void drawPicture(cv::Mat3b& image, const cv::Rect& area, RandomStream& random) {
  cv::Mat3b picture = image(area & cv::Rect(cv::Point(), image.size()));
  const cv::Point middle(picture.cols / 2, picture.rows / 2);
  const int reach = std::min(picture.cols, picture.rows);
  const int kind = random.below(5);
  if (kind == 0) {
    for (int i = 0; i < 7; ++i) {
      const cv::Point at{random.below(picture.cols), random.below(picture.rows)};
      const cv::Scalar color = vividColor(random);
      cv::circle(picture, at, reach / 5, color, cv::FILLED, cv::LINE_AA);
      cv::circle(picture, at - cv::Point(reach / 15, reach / 15), reach / 16, color * 1.3, cv::FILLED, cv::LINE_AA);
    }
  } else if (kind == 1) {
    std::vector<cv::Point> star;
    const int points = 5 + random.below(8);
    for (int i = 0; i < 2 * points; ++i) {
      const double radius = reach * (i % 2 == 0 ? 0.48 : 0.3), angle = 3.14159265 * i / points;
      star.emplace_back(
          middle + cv::Point(static_cast<int>(radius * std::sin(angle)), static_cast<int>(radius * std::cos(angle))));
    }
    cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{star}, vividColor(random), cv::LINE_AA);
    cv::circle(picture, middle, reach / 5, quietColor(random), cv::FILLED, cv::LINE_AA);
  } else if (kind == 2) {
    picture.setTo(vividColor(random) * 0.4 + cv::Scalar::all(140));
    for (int layer = 0; layer < 3; ++layer) {
      std::vector<cv::Point> hill = {{0, picture.rows}};
      for (int x = 0; x <= 8; ++x) {
        const double height = (0.3 + 0.22 * layer + random.between(-0.12, 0.12)) * picture.rows;
        hill.emplace_back(x * picture.cols / 8, static_cast<int>(height));
      }
      hill.emplace_back(picture.cols, picture.rows);
      cv::fillPoly(picture, std::vector<std::vector<cv::Point>>{hill}, vividColor(random) * 0.8, cv::LINE_AA);
    }
  } else if (kind == 3) {
    for (int ring = 4; ring > 0; --ring) {
      cv::circle(picture, middle, reach * ring / 9, anyColor(random), cv::FILLED, cv::LINE_AA);
    }
  } else {
    cv::ellipse(picture, middle, {picture.cols * 2 / 5, picture.rows / 3}, 0, 0, 360, quietColor(random), cv::FILLED,
                cv::LINE_AA);
    for (int i = 0; i < 40; ++i) {
      const cv::Point at{middle.x + static_cast<int>(random.between(-0.3, 0.3) * picture.cols),
                         middle.y + static_cast<int>(random.between(-0.25, 0.2) * picture.rows)};
      const double angle = random.between(0, 180);
      cv::ellipse(picture, at, {reach / 12, reach / 20}, angle, 0, 360, vividColor(random), cv::FILLED, cv::LINE_AA);
    }
  }
}

cv::Rect part(const cv::Rect& of, double x, double y, double width, double height) {
  return {of.x + static_cast<int>(x * of.width), of.y + static_cast<int>(y * of.height),
          std::max(4, static_cast<int>(width * of.width)), std::max(4, static_cast<int>(height * of.height))};
}

/// A brand's panel: ground, band, name, picture, words.
void drawPanel(cv::Mat3b& image, const cv::Rect& area, const cv::Scalar& ground, const cv::Scalar& band,
               const std::string& name, RandomStream& random) {
  cv::rectangle(image, area, ground, cv::FILLED);
  const double band_y = random.between(0.04, 0.2), band_height = random.between(0.2, 0.34);
  const int style = random.below(3);
  if (style == 0) cv::rectangle(image, part(area, 0, band_y, 1, band_height), band, cv::FILLED);
  if (style == 1) {
    cv::ellipse(image, {area.x + area.width / 2, area.y + static_cast<int>((band_y + band_height / 2) * area.height)},
                {area.width * 45 / 100, std::max(3, static_cast<int>(0.55 * band_height * area.height))}, 0, 0, 360,
                band, cv::FILLED, cv::LINE_AA);
  }
  if (style == 2) cv::rectangle(image, part(area, 0, 0.62, 1, 0.38), band, cv::FILLED);
  const cv::Scalar name_ink = inkOn(style == 2 ? ground : band, random);
  drawText(image, part(area, 0.05, band_y, 0.9, band_height), name, name_ink, 2, random);
  drawPicture(image, part(area, random.between(0.05, 0.3), 0.5, 0.6, 0.34), random);
  const cv::Scalar ink = inkOn(style == 2 ? band : ground, random);
  drawText(image, part(area, 0.1, 0.86, 0.8, 0.1), word(random), ink, 1, random);
}

/// Pixels of a texture for a surface of this size: 1.2 mm a texel, within bounds.
int texelsFor(double length_m) {
  return std::clamp(static_cast<int>(length_m / 0.0012), 64, 512);
}

}  // namespace

cv::Mat3b paintPackage(double front_width_m, double front_height_m, RandomStream& random) {
  cv::Mat3b image(std::max(96, texelsFor(front_height_m) * 10 / 7), std::max(96, texelsFor(front_width_m) * 10 / 6));
  const cv::Rect whole(cv::Point(), image.size());
  const cv::Scalar ground = anyColor(random), band = anyColor(random);
  const std::string name = brand(random);
  drawPanel(image, part(whole, 0, 0, 0.6, 0.7), ground, band, name, random);
  const cv::Rect side = part(whole, 0.6, 0, 0.41, 0.7) & whole, top = part(whole, 0, 0.7, 1.0, 0.31) & whole;
  const cv::Scalar ink = inkOn(ground, random);
  cv::rectangle(image, side, ground * 0.96, cv::FILLED);
  cv::rectangle(image, part(side, 0, 0, 1, 0.22), band, cv::FILLED);
  drawText(image, part(side, 0.05, 0.02, 0.9, 0.18), name, inkOn(band, random), 1, random);
  drawSmallPrint(image, part(side, 0.12, 0.3, 0.76, 0.36), ink, random);
  drawBarcode(image, part(side, 0.2, 0.74, 0.6, 0.16), random);
  cv::rectangle(image, top, random.chance(0.5) ? band : ground, cv::FILLED);
  drawText(image, part(top, 0.15, 0.2, 0.7, 0.6), name, inkOn(ground, random), 2, random);
  return image;
}

cv::Mat3b paintBook(double width_m, double height_m, RandomStream& random) {
  cv::Mat3b image(texelsFor(height_m) * 10 / 7, texelsFor(width_m) * 10 / 6);
  const cv::Rect whole(cv::Point(), image.size());
  const cv::Rect front = part(whole, 0, 0, 0.6, 0.7), side = part(whole, 0.6, 0, 0.41, 0.7) & whole,
                 top = part(whole, 0, 0.7, 1.0, 0.31) & whole;
  const cv::Scalar ground = anyColor(random), ink = inkOn(ground, random);
  const std::string title = brand(random);
  cv::rectangle(image, front, ground, cv::FILLED);
  if (random.chance(0.6)) drawPicture(image, part(front, 0.1, 0.35, 0.8, 0.45), random);
  drawText(image, part(front, 0.06, 0.06, 0.88, 0.16), title, ink, 2, random);
  drawText(image, part(front, 0.15, 0.23, 0.7, 0.08), word(random), ink, 1, random);
  cv::rectangle(image, part(front, 0.3, 0.88, 0.4, 0.04), ink, cv::FILLED);
  // The spine runs along the side's long edge; pages are on top.
  cv::rectangle(image, side, ground * 0.9, cv::FILLED);
  cv::rectangle(image, part(side, 0, 0.1, 1, 0.05), ink, cv::FILLED);
  drawText(image, part(side, 0.08, 0.25, 0.84, 0.4), title, ink, 1, random);
  cv::rectangle(image, part(side, 0, 0.85, 1, 0.05), ink, cv::FILLED);
  cv::rectangle(image, top, {205, 222, 230}, cv::FILLED);
  for (int y = top.y + 1; y < top.br().y; y += 3) cv::line(image, {top.x, y}, {top.br().x, y}, {165, 185, 195}, 1);
  return image;
}

cv::Mat3b paintWrap(const cv::Scalar& ground, double label_top, double label_bottom, double cap_share,
                    RandomStream& random) {
  cv::Mat3b image(256, 256, cv::Vec3b(0, 0, 0));
  image.setTo(ground);
  const cv::Rect whole(cv::Point(), image.size());
  if (cap_share > 0) cv::rectangle(image, part(whole, 0, 0, 1, cap_share), anyColor(random, 0.7), cv::FILLED);
  const cv::Rect label = part(whole, 0, label_top, 1, label_bottom - label_top);
  const cv::Scalar paper = anyColor(random), band = anyColor(random), ink = inkOn(paper, random);
  cv::rectangle(image, label, paper, cv::FILLED);
  cv::rectangle(image, part(label, 0, 0, 1, random.between(0.05, 0.16)), band, cv::FILLED);
  const std::string name = brand(random);
  for (const double x : {0.03, 0.53}) drawPanel(image, part(label, x, 0.14, 0.3, 0.84), paper, band, name, random);
  drawSmallPrint(image, part(label, 0.36, 0.25, 0.14, 0.6), ink, random);
  drawBarcode(image, part(label, 0.86, 0.3, 0.11, 0.5), random);
  return image;
}

cv::Mat3b paintWare(RandomStream& random) {
  cv::Mat3b image(160, 256, cv::Vec3b(0, 0, 0));
  const cv::Scalar ground = anyColor(random, 0.55), ink = anyColor(random, 0.9);
  image.setTo(ground);
  const int style = random.below(5);
  if (style == 1) {
    for (int y = 12; y < 160; y += 26) cv::rectangle(image, {0, y, 256, 10}, ink, cv::FILLED);
  } else if (style == 2) {
    for (int y = 10; y < 160; y += 20) {
      for (int x = 8 + y % 40 / 2; x < 256; x += 20) cv::circle(image, {x, y}, 5, ink, cv::FILLED, cv::LINE_AA);
    }
  } else if (style == 3) {
    // The outer wall takes up the lower half of a lathe's texture.
    for (const int x : {20, 148}) drawPicture(image, {x, 90, 60, 50}, random);
    const cv::Scalar letters = inkOn(ground, random);
    drawText(image, {84, 96, 60, 30}, brand(random), letters, 1, random);
  } else if (style == 4) {
    cv::rectangle(image, {0, 80, 256, 24}, ink, cv::FILLED);
  }
  return image;
}

cv::Mat3b paintPoster(double width_m, double height_m, RandomStream& random) {
  cv::Mat3b image(std::clamp(static_cast<int>(height_m / 0.0018), 96, 512),
                  std::clamp(static_cast<int>(width_m / 0.0018), 96, 512), cv::Vec3b(232, 236, 238));
  const cv::Rect whole(cv::Point(), image.size()), inner = part(whole, 0.05, 0.05, 0.9, 0.9);
  const int style = random.below(3);
  if (style == 0) {
    cv::rectangle(image, inner, anyColor(random), cv::FILLED);
    drawPicture(image, part(inner, 0.05, 0.05, 0.9, 0.7), random);
    drawText(image, part(inner, 0.1, 0.78, 0.8, 0.18), brand(random), {30, 30, 30}, 2, random);
  } else if (style == 1) {
    for (int i = 0; i < 9; ++i) {
      const double x = random.between(0, 0.7), y = random.between(0, 0.7);
      const double width = random.between(0.1, 0.5), height = random.between(0.1, 0.5);
      cv::rectangle(image, part(inner, x, y, width, height) & inner, anyColor(random, 0.8), cv::FILLED);
    }
  } else {
    std::string title = brand(random);
    title += std::string(" ") + word(random);
    drawText(image, part(inner, 0, 0, 1, 0.14), title, {40, 30, 120}, 2, random);
    drawSmallPrint(image, part(inner, 0.02, 0.2, 0.45, 0.72), {70, 70, 70}, random);
    drawPicture(image, part(inner, 0.52, 0.2, 0.46, 0.4), random);
    for (int bar = 0; bar < 6; ++bar) {
      const double height = random.between(0.08, 0.3);
      cv::rectangle(image, part(inner, 0.54 + 0.07 * bar, 0.95 - height, 0.05, height), vividColor(random), cv::FILLED);
    }
  }
  return image;
}

cv::Mat3b paintDocument(double width_m, double height_m, RandomStream& random) {
  cv::Mat3b image(texelsFor(height_m), texelsFor(width_m), cv::Vec3b(228, 232, 234));
  if (random.chance(0.2)) image.setTo(anyColor(random) * 0.3 + cv::Scalar::all(150));
  const cv::Rect inner = part(cv::Rect(cv::Point(), image.size()), 0.09, 0.07, 0.82, 0.88);
  const cv::Scalar ink = random.chance(0.7) ? cv::Scalar(80, 78, 75) : cv::Scalar(150, 90, 60);
  double y = 0.0;
  if (random.chance(0.6)) {
    drawText(image, part(inner, 0, 0, 0.8, 0.09), brand(random), ink, 2, random);
    y = 0.14;
  }
  while (y < 0.92) {
    const double height = std::min(random.between(0.1, 0.35), 0.98 - y);
    const int kind = random.below(6);
    if (kind == 0) {
      const double x = random.between(0.0, 0.4);
      drawPicture(image, part(inner, x, y, 0.55, height), random);
    } else if (kind == 1) {
      cv::rectangle(image, part(inner, 0, y, 1, height), ink, 1);
    } else {
      drawSmallPrint(image, part(inner, 0, y, kind == 2 ? 0.46 : 1.0, height), ink, random);
    }
    y += height + 0.05;
  }
  return image;
}

cv::Mat3b paintCover(double width_m, double height_m, RandomStream& random) {
  cv::Mat3b image(texelsFor(height_m), texelsFor(width_m));
  const cv::Rect whole(cv::Point(), image.size());
  const cv::Scalar ground = anyColor(random, 0.5);
  image.setTo(ground);
  const int style = random.below(4);
  if (style == 0) drawPicture(image, whole, random);
  if (style == 1) drawPicture(image, part(whole, 0.1, 0.4, 0.8, 0.5), random);
  if (style == 2) {
    const double y = random.between(0.3, 0.7);
    cv::rectangle(image, part(whole, 0, y, 1, 0.28), anyColor(random), cv::FILLED);
  }
  const cv::Scalar ink = inkOn(ground, random);
  const double top = random.between(0.02, 0.12);
  if (random.chance(0.4)) cv::rectangle(image, part(whole, 0, 0, 1, top + 0.16), anyColor(random), cv::FILLED);
  const double title_width = random.between(0.5, 0.9);
  drawText(image, part(whole, 0.05, top, title_width, 0.13), brand(random), ink, 2, random);
  if (random.chance(0.6)) {
    const double y = random.between(0.25, 0.75), width = random.between(0.3, 0.8), height = random.between(0.05, 0.2);
    drawSmallPrint(image, part(whole, 0.08, y, width, height), ink, random);
  }
  return image;
}

cv::Mat3b paintKeys(int columns, int rows, RandomStream& random) {
  constexpr int kKey = 16;
  const bool dark = random.chance(0.6);
  cv::Mat3b image(rows * kKey, columns * kKey, dark ? cv::Vec3b(42, 40, 40) : cv::Vec3b(205, 208, 210));
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      const cv::Rect key(column * kKey + 1, row * kKey + 1, kKey - 3, kKey - 3);
      cv::rectangle(image, key, dark ? cv::Scalar(66, 64, 64) : cv::Scalar(238, 238, 240), cv::FILLED);
      cv::circle(image, {key.x + 5, key.y + 5}, 2, dark ? cv::Scalar::all(220) : cv::Scalar::all(50), cv::FILLED);
    }
  }
  return image;
}

}  // namespace saccade
