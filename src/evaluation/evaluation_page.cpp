#include "saccade/evaluation/evaluation_page.hpp"

#include <fstream>
#include <iterator>

#include <fmt/format.h>

#include "evaluation/line_plot.hpp"
#include "evaluation/sequence_means.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/evaluation/evaluation_report.hpp"

namespace saccade {
namespace {

constexpr int kAll = 255;

using Sequences = std::vector<SequenceEvaluation>;

/// Figures of the page in order: file stem and what it shows.
struct Figure {
  std::string stem, caption;
};

const MethodScore& methodOf(const SequenceEvaluation& sequence, std::size_t i) {
  return i == 0 ? sequence.ours : sequence.others[i - 1];
}

std::size_t methodCount(const Sequences& sequences) {
  return sequences.front().others.size() + 1;
}

std::vector<double> upTo(std::size_t count, double first = 1.0) {
  std::vector<double> values;
  for (std::size_t i = 0; i < count; ++i) values.push_back(first + static_cast<double>(i));
  return values;
}

template <typename CurveOf>
PlotLine meanLine(const std::string& name, const Sequences& sequences, const std::vector<double>& x,
                  const CurveOf& curveOf) {
  std::vector<std::vector<double>> curves;
  for (const SequenceEvaluation& sequence : sequences) curves.push_back(curveOf(sequence));
  PlotLine line{name, x, meanCurve(curves)};
  line.x.resize(std::min(line.x.size(), line.y.size()));
  line.y.resize(line.x.size());
  return line;
}

std::string withFigure(const std::string& name, double value) {
  return fmt::format("{} ({:.2f})", name, value);
}

/// Figures 9 and 10: a figure over the number of candidates, the area under the curve in parentheses.
template <typename ValueOf>
void drawOverCandidates(const Sequences& sequences, const char* what, const ValueOf& valueOf,
                        const std::filesystem::path& stem) {
  LinePlot plot{std::string(what) + " over the number of candidates (area under the curve)", "candidates", what, {}};
  const std::vector<double> numbers = upTo(kAll);
  for (std::size_t i = 0; i < methodCount(sequences); ++i) {
    PlotLine line = meanLine("", sequences, numbers, [&](const SequenceEvaluation& sequence) {
      std::vector<double> curve;
      for (int n = 1; n <= kAll; ++n) curve.push_back(valueOf(methodOf(sequence, i).boxes, n));
      return curve;
    });
    line.name = withFigure(methodOf(sequences.front(), i).name, meanOf(line.y));
    plot.lines.push_back(std::move(line));
  }
  drawPlot(plot, stem);
}

/// Figure 7: one group of bars a sequence.
template <typename ValueOf>
void drawBySequence(const Sequences& sequences, const char* what, const ValueOf& valueOf,
                    const std::filesystem::path& stem) {
  BarPlot plot{std::string(what) + " over all candidates (mean)", what, {}, {}};
  for (const SequenceEvaluation& sequence : sequences) {
    plot.groups.push_back(std::filesystem::path(sequence.input).filename().string());
  }
  for (std::size_t i = 0; i < methodCount(sequences); ++i) {
    PlotLine bar{"", {}, {}};
    for (const SequenceEvaluation& sequence : sequences) bar.y.push_back(valueOf(methodOf(sequence, i).boxes));
    bar.name = withFigure(methodOf(sequences.front(), i).name, meanOf(bar.y));
    plot.bars.push_back(std::move(bar));
  }
  drawPlot(plot, stem);
}

/// Frames at which the curves over time of a run have their points.
std::vector<double> framesOf(const SequenceRun& run) {
  return {run.score.labelled_frames.begin(), run.score.labelled_frames.end()};
}

/// Figure 8: global recall as it grows, of each method on single frames.
void drawGlobalRecallOfMethods(const Sequences& sequences, int k, const std::filesystem::path& stem) {
  LinePlot plot{fmt::format("Global recall over time, {} candidates a frame, without memory (area)", k),
                "labelled frame",
                "global recall",
                {}};
  for (std::size_t i = 0; i < methodCount(sequences); ++i) {
    PlotLine line = meanLine(
        "", sequences, upTo(sequences.front().ours.boxes.globalRecallOverTime(k).size()),
        [&](const SequenceEvaluation& sequence) { return methodOf(sequence, i).boxes.globalRecallOverTime(k); });
    line.name = withFigure(methodOf(sequences.front(), i).name, meanOf(line.y));
    plot.lines.push_back(std::move(line));
  }
  drawPlot(plot, stem);
}

/// Figure 14: curves over time of the runs, and of the first at 255 candidates too.
void drawGlobalRecallOfRuns(const Sequences& sequences, int k, const std::filesystem::path& stem) {
  LinePlot plot{
      fmt::format("Global recall over time, {} candidates a frame (last value)", k), "frame", "global recall", {}};
  const auto add = [&](std::size_t run, int candidates, const std::string& name) {
    PlotLine line = meanLine("", sequences, framesOf(sequences.front().runs[run]), [&](const auto& sequence) {
      return sequence.runs[run].score.boxes.globalRecallOverTime(candidates);
    });
    line.name = withFigure(name, line.y.empty() ? 0.0 : line.y.back());
    plot.lines.push_back(std::move(line));
  };
  for (std::size_t run = 0; run < sequences.front().runs.size(); ++run) add(run, k, sequences.front().runs[run].name);
  if (!sequences.front().runs.empty()) add(0, kAll, "without IOR, 255 candidates");
  drawPlot(plot, stem);
}

/// Mean over the second around each point: single frames jump.
std::vector<double> smooth(const std::vector<double>& values) {
  constexpr std::ptrdiff_t kRadius = 15;
  std::vector<double> result;
  const auto count = static_cast<std::ptrdiff_t>(values.size());
  for (std::ptrdiff_t i = 0; i < count; ++i) {
    const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, i - kRadius), end = std::min(count, i + kRadius + 1);
    result.push_back(meanOf({values.begin() + first, values.begin() + end}));
  }
  return result;
}

void drawRevisits(const Sequences& sequences, const std::filesystem::path& stem) {
  LinePlot plot{"Share of the attended candidates that were attended before (mean)", "frame", "revisit rate", {}};
  for (std::size_t run = 0; run < sequences.front().runs.size(); ++run) {
    PlotLine line = meanLine("", sequences, upTo(static_cast<std::size_t>(sequences.front().runs[run].score.frames), 0),
                             [&](const auto& sequence) { return smooth(sequence.runs[run].score.revisit_rate); });
    line.name = withFigure(sequences.front().runs[run].name, meanOf(line.y));
    plot.lines.push_back(std::move(line));
  }
  drawPlot(plot, stem);
}

std::string fileText(const std::filesystem::path& path) {
  std::ifstream file(path);
  if (!file) throw IoError(path, "the figure that was just drawn", "no file");
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string escaped(const std::string& text) {
  std::string html;
  for (const char c : text) {
    html += c == '<' ? std::string("&lt;") : c == '&' ? std::string("&amp;") : std::string(1, c);
  }
  return html;
}

std::string tableHtml(const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<table>\n";
  for (std::size_t i = 0; i < rows.size(); ++i) {
    html += "<tr>";
    for (const std::string& cell : rows[i]) {
      html += fmt::format("<{0}>{1}</{0}>", i == 0 ? "th" : "td", escaped(cell));
    }
    html += "</tr>\n";
  }
  return html + "</table>\n";
}

/// Table 1: F at k and over all candidates, by boxes.
std::vector<std::vector<std::string>> fScoreRows(const Sequences& sequences, int k) {
  std::vector<std::vector<std::string>> rows = {{"F-score, boxes"}};
  for (std::size_t i = 0; i < methodCount(sequences); ++i) rows[0].push_back(methodOf(sequences.front(), i).name);
  for (const SequenceEvaluation& sequence : sequences) {
    for (const int count : {k, kAll}) {
      rows.push_back(
          {fmt::format("{}, {} candidates", std::filesystem::path(sequence.input).filename().string(), count)});
      for (std::size_t i = 0; i < methodCount(sequences); ++i) {
        rows.back().push_back(fmt::format("{:.3f}", methodOf(sequence, i).boxes.fScore(count)));
      }
    }
  }
  return rows;
}

constexpr const char* kHead = R"(<!doctype html>
<html lang="en"><meta charset="utf-8"><meta name="viewport" content="width=device-width">
<title>Saccade: evaluation</title>
<style>
body { font: 16px/1.5 sans-serif; color: #222; max-width: 60rem; margin: 2rem auto; padding: 0 1rem; }
table { border-collapse: collapse; font-size: 14px; display: block; overflow-x: auto; }
th, td { padding: .2rem .6rem; text-align: right; border-bottom: 1px solid #ddd; }
th:first-child, td:first-child { text-align: left; }
figure { margin: 2rem 0; } figure svg { width: 100%; height: auto; } figcaption { color: #555; font-size: 14px; }
</style>
)";

}  // namespace

void writeEvaluationPage(const Sequences& sequences, int k, const std::filesystem::path& folder) {
  if (sequences.empty()) return;
  const auto recallAt = [](const DiscoveryScore& score, int n) { return score.recall(n); };
  const auto precisionAt = [](const DiscoveryScore& score, int n) { return score.precision(n); };
  const std::vector<Figure> figures = {
      {"figure-07-precision", "Precision of each sequence over all candidates (paper, figure 7, left)."},
      {"figure-07-recall", "Recall of each sequence over all candidates (paper, figure 7, right)."},
      {"figure-08-global-recall", "Objects found so far by each method (paper, figure 8)."},
      {"figure-09-precision", "Precision over the number of candidates (paper, figures 9 and 10, left)."},
      {"figure-09-recall", "Recall over the number of candidates (paper, figures 9 and 10, right)."},
      {"figure-14-global-recall", "Objects found so far with and without inhibition of return (paper, figure 14)."},
      {"revisit-rate", "A look is a revisit if at least half of its leaves were attended at any earlier tick."}};
  drawBySequence(
      sequences, "precision", [&](const auto& s) { return s.precision(kAll); }, folder / figures[0].stem);
  drawBySequence(
      sequences, "recall", [&](const auto& s) { return s.recall(kAll); }, folder / figures[1].stem);
  drawGlobalRecallOfMethods(sequences, k, folder / figures[2].stem);
  drawOverCandidates(sequences, "precision", precisionAt, folder / figures[3].stem);
  drawOverCandidates(sequences, "recall", recallAt, folder / figures[4].stem);
  drawGlobalRecallOfRuns(sequences, k, folder / figures[5].stem);
  drawRevisits(sequences, folder / figures[6].stem);

  std::string page = kHead;
  page +=
      "<h1>Evaluation</h1>\n<p>Pascal criterion: an object is found by a candidate whose overlap (intersection over "
      "union) with it is above 0.5.</p>\n";
  for (const SequenceEvaluation& sequence : sequences) {
    page += fmt::format("<p><b>{}</b>: {} frames, {} lost, {} labelled", escaped(sequence.input), sequence.frames,
                        sequence.lost, sequence.ours.boxes.frames());
    if (sequence.ate) page += fmt::format("; ATE {:.1f} mm", sequence.ate->rmse_m * 1000.0);
    if (sequence.propagation) page += fmt::format("; IoU of propagated masks {:.3f}", sequence.propagation->mean_iou);
    page += "</p>\n";
  }
  page += tableHtml(methodRows(sequences, k)) + "<p></p>\n" + tableHtml(runRows(sequences, k));
  page += "<h2>F-scores (paper, table 1)</h2>\n" + tableHtml(fScoreRows(sequences, k)) + "<h2>Figures</h2>\n";
  for (const Figure& figure : figures) {
    const std::string svg = fileText(folder / (figure.stem + ".svg"));
    page += fmt::format("<figure>{}<figcaption>{}</figcaption></figure>\n", svg.substr(svg.find("<svg")),
                        escaped(figure.caption));
  }
  page += "</html>\n";
  std::ofstream file(folder / "index.html");
  file << page;
  file.close();
  if (!file) throw IoError(folder / "index.html", "a page that can be written", "a full disk or a read-only folder");
}

}  // namespace saccade
