#include "evaluation/line_plot.hpp"

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fmt/format.h>

#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

// Okabe and Ito's colours, told apart by colour-blind eyes too.
constexpr const char* kStyle = R"(
set border 3 lc rgb "#666666"
set tics nomirror textcolor rgb "#333333"
set grid ytics lc rgb "#dddddd"
set linetype 1 lc rgb "#0072B2" lw 2
set linetype 2 lc rgb "#D55E00" lw 2
set linetype 3 lc rgb "#009E73" lw 2
set linetype 4 lc rgb "#CC79A7" lw 2
set linetype 5 lc rgb "#E69F00" lw 2
set linetype 6 lc rgb "#56B4E9" lw 2
set linetype 7 lc rgb "#999999" lw 2
set linetype 8 lc rgb "#000000" lw 2
)";

/// Text between single quotes of gnuplot, where only the quote itself is special; enhanced text is switched off.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

/// A plot as commands of gnuplot: `data` defines blocks and settings, `body` draws.
struct Script {
  std::string data, body;
};

/// What gnuplot is told for both kinds of file.
std::string scriptForFiles(const Script& plot, const std::string& title, const std::filesystem::path& stem) {
  std::string script = kStyle + plot.data;
  script += "set key outside right top reverse Left samplen 1.5\n";
  script += fmt::format("set title {} noenhanced\n", quoted(title));
  script += "set terminal svg size 820,420 dynamic noenhanced font 'sans-serif,13' background '#ffffff'\n";
  script += fmt::format("set output {}\n{}", quoted(stem.string() + ".svg"), plot.body);
  script += "set terminal pngcairo size 1230,630 noenhanced font 'sans,15' background '#ffffff'\n";
  script += fmt::format("set output {}\n{}", quoted(stem.string() + ".png"), plot.body);
  return script;
}

/// For a page, which has titles of its own.
std::string scriptForPage(const Script& plot, const std::filesystem::path& stem) {
  std::string script = kStyle + plot.data;
  script += "set key outside bottom center horizontal reverse Left samplen 1.5\n";
  script += "set terminal svg size 560,340 dynamic noenhanced font 'sans-serif,13'\n";
  return script + fmt::format("set output {}\n{}", quoted(stem.string() + ".svg"), plot.body);
}

void runGnuplot(const std::string& script, const std::filesystem::path& stem) {
  const std::string path = stem.string() + ".gnuplot";
  std::ofstream file(path);
  file << script;
  file.close();
  if (!file) throw IoError(path, "a file that can be written", "a full disk or a folder that cannot be written");
  char name[] = "gnuplot";
  std::string argument = path;
  char* arguments[] = {name, argument.data(), nullptr};
  pid_t child = 0;
  int status = -1;
  if (::posix_spawnp(&child, name, nullptr, nullptr, arguments, environ) != 0 ||
      ::waitpid(child, &status, 0) != child || status != 0) {
    throw IoError(path, "that gnuplot (Debian package gnuplot-nox) draws it",
                  status == -1 ? "no such program" : "that it failed");
  }
}

Script scriptOf(const LinePlot& plot) {
  constexpr const char* kWith[] = {"lines", "boxes", "lines"};
  Script script;
  std::string separator = "plot ";
  for (std::size_t i = 0; i < plot.lines.size(); ++i) {
    const PlotLine& line = plot.lines[i];
    script.data += fmt::format("$line{} << END\n", i);
    for (std::size_t j = 0; j < line.x.size(); ++j) script.data += fmt::format("{:g} {:g}\n", line.x[j], line.y[j]);
    script.data += "END\n";
    script.body += fmt::format("{}$line{} using 1:2 with {} lt {} title {}", separator, i,
                               kWith[static_cast<std::size_t>(plot.look)], i + 1, quoted(line.name));
    separator = ", ";
  }
  script.data += fmt::format("set xlabel {}\nset ylabel {}\n", quoted(plot.x_label), quoted(plot.y_label));
  if (plot.look == LinePlot::Look::kPath) {
    script.data += "set size ratio -1\nset grid xtics\n";
  } else {
    script.data += plot.top > 0.0 ? fmt::format("set yrange [0:{}]\n", plot.top) : std::string("set yrange [0:*]\n");
  }
  if (plot.look == LinePlot::Look::kBoxes)
    script.data += "set style fill solid 0.9 noborder\nset boxwidth 0.9 relative\n";
  script.body += "\n";
  return script;
}

Script scriptOf(const BarPlot& plot) {
  Script script;
  script.data = "$bars << END\n";
  for (std::size_t group = 0; group < plot.groups.size(); ++group) {
    std::string name = plot.groups[group];
    std::replace(name.begin(), name.end(), '"', '\'');
    script.data += '"' + name + '"';
    for (const PlotLine& bar : plot.bars) script.data += fmt::format(" {:g}", bar.y[group]);
    script.data += "\n";
  }
  script.data += fmt::format(
      "END\nset style data histograms\nset style fill solid 0.9 noborder\nset ylabel {}\n"
      "set yrange [0:{}]\nset xtics rotate by -20\n",
      quoted(plot.y_label), plot.top > 0.0 ? fmt::format("{}", plot.top) : "*");
  for (std::size_t i = 0; i < plot.bars.size(); ++i) {
    script.body += fmt::format("{}$bars using {}:xtic(1) lt {} title {}", i == 0 ? "plot " : ", ", i + 2, i + 1,
                               quoted(plot.bars[i].name));
  }
  script.body += "\n";
  return script;
}

bool isEmpty(const LinePlot& plot) {
  return std::all_of(plot.lines.begin(), plot.lines.end(), [](const PlotLine& line) { return line.x.empty(); });
}

bool isEmpty(const BarPlot& plot) {
  return plot.bars.empty() || plot.groups.empty();
}

/// A folder that goes with what was written to it.
class ScratchFolder {
 public:
  ScratchFolder() {
    std::string name = (std::filesystem::temp_directory_path() / "saccade-plot-XXXXXX").string();
    if (::mkdtemp(name.data()) == nullptr) throw IoError(name, "a folder for plots", "none that can be made");
    path_ = name;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// gnuplot's document as an element of a page: its own title would be shown as a hint over all of it, and its names of
/// elements are the same in every plot.
std::string asElement(std::string svg) {
  svg.erase(0, svg.find("<svg"));
  const auto replaceAll = [&](const std::string& from, const std::string& to) {
    for (std::size_t at = 0; (at = svg.find(from, at)) != std::string::npos; at += to.size()) {
      svg.replace(at, from.size(), to);
    }
  };
  replaceAll("<title>Gnuplot</title>", "");
  replaceAll("id=\"gnuplot_plot_", "data-plot=\"");
  return svg;
}

template <typename Plot>
std::string svgOf(const Plot& plot) {
  if (isEmpty(plot)) return "";
  const ScratchFolder folder;
  const std::filesystem::path stem = folder.path() / "plot";
  runGnuplot(scriptForPage(scriptOf(plot), stem), stem);
  std::ifstream file(stem.string() + ".svg");
  std::string svg(std::istreambuf_iterator<char>(file), {});
  if (svg.find("<svg") == std::string::npos) throw IoError(stem, "the plot that was just drawn", "none");
  return asElement(std::move(svg));
}

template <typename Plot>
void drawFiles(const Plot& plot, const std::filesystem::path& stem) {
  if (!isEmpty(plot)) runGnuplot(scriptForFiles(scriptOf(plot), plot.title, stem), stem);
}

}  // namespace

void drawPlot(const LinePlot& plot, const std::filesystem::path& stem) {
  drawFiles(plot, stem);
}

void drawPlot(const BarPlot& plot, const std::filesystem::path& stem) {
  drawFiles(plot, stem);
}

std::string plotSvg(const LinePlot& plot) {
  return svgOf(plot);
}

std::string plotSvg(const BarPlot& plot) {
  return svgOf(plot);
}

}  // namespace saccade
