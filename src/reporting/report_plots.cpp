#include "reporting/report_plots.hpp"

#include <algorithm>
#include <functional>
#include <map>

#include <fmt/format.h>

#include "evaluation/line_plot.hpp"
#include "reporting/part_sizes.hpp"
#include "reporting/plan_axes.hpp"
#include "saccade/inspection/leaf_histogram.hpp"

namespace saccade {
namespace {

constexpr std::size_t kMostPoints = 400;  ///< of a line
constexpr double kMebibyte = 1048576.0;

/// A line of at most kMostPoints points, each the mean over an equal part of `values`.
PlotLine meanLine(const std::string& name, const std::vector<double>& values, std::size_t most_points = kMostPoints) {
  PlotLine line{name, {}, {}};
  const std::size_t count = std::min(most_points, values.size());
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t begin = i * values.size() / count, end = (i + 1) * values.size() / count;
    double sum = 0.0;
    for (std::size_t j = begin; j < end; ++j) sum += values[j];
    line.x.push_back(0.5 * static_cast<double>(begin + end - 1));
    line.y.push_back(sum / static_cast<double>(end - begin));
  }
  return line;
}

PlotLine planLine(const std::string& name, const std::vector<Eigen::Vector3d>& path, const PlanAxes& axes) {
  PlotLine line{name, {}, {}};
  const std::size_t step = path.size() / kMostPoints + 1;
  for (std::size_t i = 0; i < path.size(); i += step) {
    line.x.push_back(path[i].dot(axes.right));
    line.y.push_back(path[i].dot(axes.ahead));
  }
  return line;
}

ReportPlot plotPath(const std::vector<TimelineEntry>& timeline, const Eigen::Vector3d& up_W,
                    const std::optional<TruthComparison>& truth) {
  const PlanAxes axes(up_W);
  std::vector<Eigen::Vector3d> path;
  for (const TimelineEntry& entry : timeline) {
    if (entry.frame.T_WC) path.push_back(entry.frame.T_WC->translation());
  }
  LinePlot plot{"", "to the right, m", "ahead, m", {planLine("camera", path, axes)}, 0.0, LinePlot::Look::kPath};
  if (truth) {
    std::vector<Eigen::Vector3d> true_path;
    for (const PosePair& pair : truth->pairs) {
      true_path.push_back(truth->alignment.inverse() * pair.truth.T_WC.translation());
    }
    plot.lines.push_back(planLine("truth, aligned", true_path, axes));
  }
  return {"Path of the camera", path.empty() ? "" : plotSvg(plot),
          "From above, in the frame of the first camera, which looks upwards in this plot."};
}

ReportPlot plotError(const std::optional<TruthComparison>& truth) {
  if (!truth) return {};
  std::vector<double> errors_mm;
  for (const PosePair& pair : truth->pairs) {
    const Eigen::Vector3d estimate = truth->alignment * pair.estimate.T_WC.translation();
    errors_mm.push_back(1000.0 * (estimate - pair.truth.T_WC.translation()).norm());
  }
  return {"Trajectory error",
          plotSvg(LinePlot{"", "matched pose", "distance from the truth, mm", {meanLine("", errors_mm)}, 0.0}),
          fmt::format("After alignment. ATE {:.1f} mm (rmse), median {:.1f} mm, largest {:.1f} mm, {} poses.",
                      1000.0 * truth->error.rmse_m, 1000.0 * truth->error.median_m, 1000.0 * truth->error.max_m,
                      truth->error.matched)};
}

template <typename ValueOf>
std::vector<double> valuesOf(const std::vector<TimelineEntry>& timeline, const ValueOf& valueOf) {
  std::vector<double> values;
  for (const TimelineEntry& entry : timeline) values.push_back(valueOf(entry));
  return values;
}

ReportPlot plotCandidates(const std::vector<TimelineEntry>& timeline) {
  const auto open = valuesOf(timeline, [](const TimelineEntry& e) { return e.frame.open; });
  const auto inhibited = valuesOf(timeline, [](const TimelineEntry& e) { return e.frame.inhibited; });
  return {"Candidates",
          plotSvg(LinePlot{"", "frame", "candidates", {meanLine("open", open), meanLine("inhibited", inhibited)}, 0.0}),
          "Object candidates a frame: open ones compete for attention, inhibited ones were looked at long enough."};
}

ReportPlot plotRevisits(const std::vector<TimelineEntry>& timeline) {
  constexpr std::size_t kFewPoints = 80;  // single frames jump
  const auto rate = valuesOf(timeline, [](const TimelineEntry& e) { return e.revisitRate(); });
  return {"Revisits", plotSvg(LinePlot{"", "frame", "share of the looks", {meanLine("", rate, kFewPoints)}, 1.0}),
          "Share of the attended candidates of which at least half was attended before."};
}

ReportPlot plotWeights(const IorMap& map) {
  constexpr int kBins = 40;
  const LeafHistogram histogram = histogramOf(map.view(), LeafQuantity::kIorWeight, kBins);
  PlotLine line{"", {}, {}};
  for (std::size_t i = 0; i < histogram.counts.size(); ++i) {
    line.x.push_back(histogram.lowest + histogram.step * (static_cast<double>(i) + 0.5) - 0.5);
    line.y.push_back(static_cast<double>(histogram.counts[i]));
  }
  return {"IOR weights", plotSvg(LinePlot{"", "ticks until forgotten", "leaves", {line}, 0.0, LinePlot::Look::kBoxes}),
          fmt::format("{} of {} occupied leaves remember an attention.", histogram.leaves - histogram.without,
                      histogram.leaves)};
}

/// The stages that take most time, the rest of them together.
ReportPlot plotStages(const SessionReader& session) {
  constexpr std::size_t kShown = 6;
  constexpr std::size_t kLongestName = 40;
  constexpr std::size_t kFewPoints = 120;
  const std::vector<MetricsRecord> metrics = session.metrics();
  std::map<std::string, std::vector<double>> times_ms;
  std::map<std::string, double> sums;
  for (std::size_t i = 0; i < metrics.size(); ++i) {
    for (const auto& [stage, ms] : metrics[i].stages_ms) {
      std::vector<double>& of_stage = times_ms[stage];
      of_stage.resize(metrics.size(), 0.0);
      of_stage[i] += ms;
      sums[stage] += ms;
    }
  }
  std::vector<std::string> order;
  for (const auto& [stage, sum] : sums) order.push_back(stage);
  std::stable_sort(order.begin(), order.end(), [&](const auto& a, const auto& b) { return sums[a] > sums[b]; });
  LinePlot plot{"", "frame", "ms", {}, 0.0};
  std::vector<double> rest(metrics.size(), 0.0);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const std::vector<double>& of_stage = times_ms[order[i]];
    if (i < kShown) {
      plot.lines.push_back(meanLine(order[i].substr(0, kLongestName), of_stage, kFewPoints));
    } else {
      std::transform(rest.begin(), rest.end(), of_stage.begin(), rest.begin(), std::plus<>());
    }
  }
  if (order.size() > kShown) plot.lines.push_back(meanLine("the others", rest, kFewPoints));
  return {"Time of each stage", plotSvg(plot),
          "The attention and the map stages run side by side, so that a frame takes less than their sum."};
}

ReportPlot plotMemory(const SessionReader& session, const IorMap& map, const AttendLog& log) {
  const std::vector<PartSize> parts = partSizes(session);
  PlotLine file{"in the file", {}, {}}, memory{"in memory", {}, {}};
  BarPlot plot{"", "MiB", {}, {}, 0.0};
  for (const PartSize& part : parts) {
    plot.groups.push_back(part.name);
    file.y.push_back(static_cast<double>(part.bytes) / kMebibyte);
    const double loaded = part.name == "map"          ? static_cast<double>(map.memoryBytes())
                          : part.name == "attend log" ? static_cast<double>(log.memoryBytes())
                                                      : 0.0;
    memory.y.push_back(loaded / kMebibyte);
  }
  plot.bars = {file, memory};
  return {"Memory", plotSvg(plot),
          "Parts of the session in the file; the map and the attend log also as they lie in memory."};
}

}  // namespace

std::vector<ReportPlot> plotSession(const SessionReader& session, const std::vector<TimelineEntry>& timeline,
                                    const IorMap& map, const AttendLog& log, const Eigen::Vector3d& up_W,
                                    const std::optional<TruthComparison>& truth) {
  std::vector<ReportPlot> plots = {plotPath(timeline, up_W, truth), plotError(truth), plotCandidates(timeline),
                                   plotRevisits(timeline),          plotWeights(map), plotStages(session),
                                   plotMemory(session, map, log)};
  std::erase_if(plots, [](const ReportPlot& plot) { return plot.svg.empty(); });
  return plots;
}

}  // namespace saccade
