#include "bench/scale_plot.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <stdexcept>

#include <fmt/format.h>

namespace saccade::bench {
namespace {

constexpr double kWidth = 720, kHeight = 360, kLeft = 60, kRight = 150, kTop = 30, kBottom = 45;
// Okabe and Ito's colours, told apart by colour-blind eyes too.
constexpr std::array kColors = {"#0072B2", "#D55E00", "#009E73", "#CC79A7"};
constexpr std::array kExponents = {"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};

/// Takes leaves and milliseconds to the picture.
struct Axes {
  double first_decade = 8, last_decade = 6, most_ms = 1;

  explicit Axes(const std::vector<ScaleLine>& lines) {
    for (const ScaleLine& line : lines) {
      for (const double leaves : line.leaves) {
        first_decade = std::min(first_decade, std::floor(std::log10(leaves)));
        last_decade = std::max(last_decade, std::ceil(std::log10(leaves)));
      }
      for (const double ms : line.time_ms) most_ms = std::max(most_ms, 1.1 * ms);
    }
  }
  [[nodiscard]] double x(double decade) const {
    return kLeft + (decade - first_decade) / (last_decade - first_decade) * (kWidth - kLeft - kRight);
  }
  [[nodiscard]] double y(double ms) const { return kHeight - kBottom - ms / most_ms * (kHeight - kTop - kBottom); }
};

std::string text(double x, double y, const char* anchor, const std::string& what) {
  return fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"{}\">{}</text>\n", x, y, anchor, what);
}

std::string grid(const Axes& axes) {
  std::string svg;
  const auto rule = [&svg](double x0, double y0, double x1, double y1) {
    svg += fmt::format("<line x1=\"{:.1f}\" y1=\"{:.1f}\" x2=\"{:.1f}\" y2=\"{:.1f}\" stroke=\"#dddddd\"/>\n", x0, y0,
                       x1, y1);
  };
  for (double decade = axes.first_decade; decade <= axes.last_decade; ++decade) {
    rule(axes.x(decade), kTop, axes.x(decade), kHeight - kBottom);
    svg += text(axes.x(decade), kHeight - kBottom + 18, "middle",
                fmt::format("10{}", kExponents[static_cast<std::size_t>(decade) % kExponents.size()]));
  }
  const double step = std::pow(10.0, std::floor(std::log10(axes.most_ms / 2.0)));
  for (double ms = 0; ms <= axes.most_ms; ms += step) {
    rule(kLeft, axes.y(ms), kWidth - kRight, axes.y(ms));
    svg += text(kLeft - 6, axes.y(ms) + 4, "end", fmt::format("{:g}", ms));
  }
  return svg;
}

std::string curve(const Axes& axes, const ScaleLine& line, const char* color) {
  std::string points, dots;
  for (std::size_t i = 0; i < line.leaves.size(); ++i) {
    const double x = axes.x(std::log10(line.leaves[i])), y = axes.y(line.time_ms[i]);
    points += fmt::format("{:.1f},{:.1f} ", x, y);
    dots += fmt::format("<circle cx=\"{:.1f}\" cy=\"{:.1f}\" r=\"3\" fill=\"{}\"/>\n", x, y, color);
  }
  return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"2\"/>\n", points, color) +
         dots + text(kWidth - kRight + 10, axes.y(line.time_ms.back()) + 4, "start", line.stage);
}

}  // namespace

void writeScalePlot(const std::filesystem::path& path, const std::vector<ScaleLine>& lines) {
  const Axes axes(lines);
  std::string svg = fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {} {}\" font-family=\"sans-serif\" font-size=\"12\">\n"
      "<rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n",
      kWidth, kHeight);
  svg += grid(axes);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    if (!lines[i].leaves.empty()) svg += curve(axes, lines[i], kColors[i % kColors.size()]);
  }
  svg += text(kLeft, kTop - 12, "start", "core-ms a frame, over leaves in the map");
  std::ofstream file(path);
  file << svg << "</svg>\n";
  file.close();
  if (!file) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace saccade::bench
