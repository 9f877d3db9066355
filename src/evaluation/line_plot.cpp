#include "evaluation/line_plot.hpp"

#include <algorithm>
#include <fstream>
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
set key outside right top reverse Left samplen 1.5
)";

/// Text between single quotes of gnuplot, where only the quote itself is special; enhanced text is switched off.
std::string quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) result += c == '\'' ? std::string("''") : std::string(1, c);
  return result + "'";
}

/// What gnuplot is told for both kinds of file; `body` draws.
std::string scriptFor(const std::filesystem::path& stem, const std::string& title, const std::string& data,
                      const std::string& body) {
  std::string script = kStyle + data;
  script += fmt::format("set title {} noenhanced\n", quoted(title));
  script += "set terminal svg size 820,420 dynamic noenhanced font 'sans-serif,13' background '#ffffff'\n";
  script += fmt::format("set output {}\n{}", quoted(stem.string() + ".svg"), body);
  script += "set terminal pngcairo size 1230,630 noenhanced font 'sans,15' background '#ffffff'\n";
  script += fmt::format("set output {}\n{}", quoted(stem.string() + ".png"), body);
  return script;
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

}  // namespace

void drawPlot(const LinePlot& plot, const std::filesystem::path& stem) {
  std::string data, body;
  std::string separator = "plot ";
  for (std::size_t i = 0; i < plot.lines.size(); ++i) {
    const PlotLine& line = plot.lines[i];
    data += fmt::format("$line{} << END\n", i);
    for (std::size_t j = 0; j < line.x.size(); ++j) data += fmt::format("{:g} {:g}\n", line.x[j], line.y[j]);
    data += "END\n";
    body += fmt::format("{}$line{} using 1:2 with lines lt {} title {}", separator, i, i + 1, quoted(line.name));
    separator = ", ";
  }
  if (plot.lines.empty()) return;
  data += fmt::format("set xlabel {}\nset ylabel {}\nset yrange [0:{}]\n", quoted(plot.x_label), quoted(plot.y_label),
                      plot.top);
  runGnuplot(scriptFor(stem, plot.title, data, body + "\n"), stem);
}

void drawPlot(const BarPlot& plot, const std::filesystem::path& stem) {
  if (plot.bars.empty() || plot.groups.empty()) return;
  std::string data = "$bars << END\n";
  for (std::size_t group = 0; group < plot.groups.size(); ++group) {
    std::string name = plot.groups[group];
    std::replace(name.begin(), name.end(), '"', '\'');
    data += '"' + name + '"';
    for (const PlotLine& bar : plot.bars) data += fmt::format(" {:g}", bar.y[group]);
    data += "\n";
  }
  data += fmt::format(
      "END\nset style data histograms\nset style fill solid 0.9 noborder\nset ylabel {}\n"
      "set yrange [0:1]\nset xtics rotate by -20\n",
      quoted(plot.y_label));
  std::string body;
  for (std::size_t i = 0; i < plot.bars.size(); ++i) {
    body += fmt::format("{}$bars using {}:xtic(1) lt {} title {}", i == 0 ? "plot " : ", ", i + 2, i + 1,
                        quoted(plot.bars[i].name));
  }
  runGnuplot(scriptFor(stem, plot.title, data, body + "\n"), stem);
}

}  // namespace saccade
