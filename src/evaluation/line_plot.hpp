#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace saccade {

/// One line of a plot.
struct PlotLine {
  std::string name;
  std::vector<double> x, y;
};

/// A plot of lines over a common x axis; y from 0 to 1 unless `top` says otherwise.
struct LinePlot {
  std::string title, x_label, y_label;
  std::vector<PlotLine> lines;
  double top = 1.0;                                               ///< 0: as high as the data
  enum class Look { kLines, kBoxes, kPath } look = Look::kLines;  ///< kPath: x and y in the same scale, y as it comes
};

/// Groups of bars, one group for each name in `groups`; each line's y has a value for each group (its x is not used).
struct BarPlot {
  std::string title, y_label;
  std::vector<std::string> groups;
  std::vector<PlotLine> bars;
  double top = 1.0;  ///< of the y axis; 0: as high as the data
};

/// Draws `plot` with gnuplot as `stem`.svg and `stem`.png; the script stays beside them for whoever wants the plot
/// otherwise. A plot without data draws nothing. Throws IoError if gnuplot is missing or fails.
void drawPlot(const LinePlot& plot, const std::filesystem::path& stem);
void drawPlot(const BarPlot& plot, const std::filesystem::path& stem);

/// The same as an `<svg>` element for a page, without a background and small enough to be read on a phone; no file
/// stays. Empty for a plot without data.
[[nodiscard]] std::string plotSvg(const LinePlot& plot);
[[nodiscard]] std::string plotSvg(const BarPlot& plot);

}  // namespace saccade
