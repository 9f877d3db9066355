#include "bench/results_table.hpp"

#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <thread>

#include <fmt/format.h>

namespace saccade::bench {
namespace {

constexpr const char* kBegin = "<!-- bench -->\n";
constexpr const char* kEnd = "<!-- /bench -->";

std::string processor() {
  std::ifstream info("/proc/cpuinfo");
  for (std::string line; std::getline(info, line);) {
    if (line.rfind("model name", 0) == 0) return line.substr(line.find(':') + 2);
  }
  return "an unnamed processor";
}

/// Milliseconds with the digits that mean something.
std::string shortened(double time_ms) {
  return fmt::format("{:.{}f}", time_ms, time_ms < 1.0 ? 3 : time_ms < 100.0 ? 1 : 0);
}

/// Work of others on the machine makes every figure larger.
std::string loadOfTheMachine() {
  double load[3] = {};
  if (getloadavg(load, 3) != 3) return "unknown load";
  return fmt::format("mean load {:.1f} on {} cores", load[2], std::thread::hardware_concurrency());
}

}  // namespace

void ResultsTable::ReportRuns(const std::vector<Run>& runs) {
  ConsoleReporter::ReportRuns(runs);
  for (const Run& run : runs) {
    if (run.error_occurred || run.run_type != Run::RT_Iteration) continue;
    Result& result = results_[run.benchmark_name()];
    // Manual times are those of the clock: both cores work.
    const bool is_manual = run.benchmark_name().find("/manual_time") != std::string::npos;
    const double seconds =
        (is_manual ? run.real_accumulated_time : run.cpu_accumulated_time) / static_cast<double>(run.iterations);
    if (result.time_ms == 0.0 || 1e3 * seconds < result.time_ms) result.time_ms = 1e3 * seconds;
    for (const auto& [name, counter] : run.counters) result.counters[name] = counter.value;
  }
}

/// The time of the benchmark of that name, with arguments or without; 0 if it was not run.
double ResultsTable::timeOf(const std::string& name) const {
  for (const auto& [full_name, result] : results_) {
    if (full_name == name || full_name.rfind(name + "/", 0) == 0) return result.time_ms;
  }
  return 0.0;
}

std::string ResultsTable::row(const std::string& stage, const std::vector<std::string>& ours,
                              const std::vector<Rival>& rivals) const {
  double own_ms = 0.0;
  for (const std::string& name : ours) own_ms += timeOf(name);
  if (own_ms == 0.0) return "";
  std::string others;
  for (const Rival& rival : rivals) {
    const double time_ms = rival.times * timeOf(rival.name);
    if (time_ms == 0.0) continue;
    others += fmt::format("{}{} {} ms, {:.1f} x", others.empty() ? "" : "; ", rival.label, shortened(time_ms),
                          time_ms / own_ms);
  }
  return fmt::format("| {} | {} | {} |\n", stage, shortened(own_ms), others);
}

std::vector<ScaleLine> ResultsTable::scale() const {
  std::vector<ScaleLine> lines;
  for (const auto& [name, stage] :
       std::vector<std::pair<std::string, std::string>>{{"scaleIntegrate", "integrate"},
                                                        {"scaleRender", "2D IOR map"},
                                                        {"scaleAttend", "attend"},
                                                        {"scaleCheckpoint", "checkpoint"}}) {
    std::map<double, double> ms_by_leaves;
    for (const auto& [full_name, result] : results_) {
      if (full_name.rfind(name + "/", 0) == 0) ms_by_leaves[result.counters.at("leaves")] = result.time_ms;
    }
    ScaleLine& line = lines.emplace_back(ScaleLine{stage, {}, {}});
    for (const auto& [leaves, time_ms] : ms_by_leaves) {
      line.leaves.push_back(leaves);
      line.time_ms.push_back(time_ms);
    }
  }
  return lines;
}

/// How the cost of a frame grows with the map.
std::string ResultsTable::scaleRow() const {
  std::string stages;
  double smallest = 0.0, largest = 0.0, bytes = 0.0;
  for (const ScaleLine& line : scale()) {
    if (line.leaves.empty()) continue;
    smallest = line.leaves.front();
    largest = line.leaves.back();
    stages += fmt::format("{}{} {:.1f} → {:.1f} ms", stages.empty() ? "" : ", ", line.stage, line.time_ms.front(),
                          line.time_ms.back());
  }
  if (stages.empty()) return "";
  for (const auto& [name, result] : results_) {
    const auto counter = result.counters.find("bytes_per_leaf");
    if (counter != result.counters.end() && result.counters.at("leaves") == largest) bytes = counter->second;
  }
  return fmt::format("| the same places in a map of {:.1f} → {:.1f} million leaves | | {}; {:.0f} bytes a leaf |\n",
                     1e-6 * smallest, 1e-6 * largest, stages, bytes);
}

std::string ResultsTable::markdown(const std::string& commit) const {
  std::string table = "| stage | core-ms | rivals in the same run |\n|---|---|---|\n";
  table += row("saliency", {"saliency"}, {{"saliencyOfVocus2", "VOCUS2 with OpenCV's filters"}});
  table += row("salient blobs", {"salientBlobs"}, {});
  table += row("colour segments, of the halved image", {"colorSegments"},
               {{"colorSegmentsOfOpenCv", "OpenCV GraphSegmentation of the whole"}});
  table += row("the paper's, of the whole (`--paper`)", {"colorSegmentsOfThePaper"},
               {{"colorSegmentsOfOpenCv", "OpenCV GraphSegmentation"}});
  table += row("normals and surface segments", {"surfaceSegments"},
               {{"surfaceSegmentsOfOpenCv", "OpenCV RgbdNormals + RgbdPlane"},
                {"normalsOfPcl", "PCL integral-image normals alone"},
                {"surfaceSegmentsOfPcl", "PCL normals + RegionGrowing"}});
  table += row("segment tables", {"segmentTables"}, {});
  table += row("proposals", {"propose"},
               {{"proposeBySelectiveSearch", "Selective Search"}, {"proposeByEdgeBoxes", "Edge Boxes"}});
  table += row("inhibition", {"inhibit"}, {});
  table += row("features and ranking of all candidates", {"rankCandidates"}, {});
  table += row("convex hull of 200 points", {"convexHull/200"}, {{"convexHullOfPcl/200", "PCL ConvexHull"}});
  table += row("depth preparation", {"prepareDepth"}, {});
  table += row("tracking, frame to model", {"trackFrameToModel"},
               {{"trackByOpenCv<cv::rgbd::RgbdOdometry>", "OpenCV RgbdOdometry"},
                {"trackByOpenCv<cv::rgbd::FastICPOdometry>", "FastICPOdometry"},
                {"trackByPclIcp", "PCL ICP"},
                {"trackByPclGicp", "PCL GICP"}});
  table += row("integration: octree and surface volume", {"integrateMap", "integrateSurface"},
               {{"integrateMapByOctoMap", "OctoMap insertPointCloud, octree alone"}});
  table += row("model view, as tracking asks for it", {"modelView/reduction:2"}, {});
  table += row("depth beyond the depth camera's view, from the surface", {"completeDepth"}, {});
  table +=
      row("2D IOR map", {"iorView"}, {{"castRayByOctoMap", "OctoMap castRay (64 times that of one ray in 64)", 64.0}});
  table += row("attending a quarter of the leaves in view", {"attendLeaves"}, {});
  if (const double by_the_letter_ms = timeOf("decayByTheLetter"); by_the_letter_ms > 0.0) {
    table += fmt::format("| decay of the attention memory | nothing to do | a pass over all leaves {} ms |\n",
                         shortened(by_the_letter_ms));
  }
  for (const auto& [name, result] : results_) {
    if (name.rfind("wholeFrame", 0) != 0) continue;
    const auto counter = [&counters = result.counters](const char* which) { return counters.at(which); };
    table += fmt::format(
        "| whole frame, with decoding, keyframes and checkpoints | {:.1f} | {:.1f} frames/s; from frame to frame "
        "median "
        "{:.1f} ms, 95 % {:.1f} ms, 99 % {:.1f} ms |\n",
        counter("core_ms"), 1e3 / result.time_ms, counter("p50_ms"), counter("p95_ms"), counter("p99_ms"));
  }
  table += scaleRow();
  return table + fmt::format("\n*{}, {}, GCC {}, commit {}; `tests/bench/run.sh`.*\n", processor(), loadOfTheMachine(),
                             __VERSION__, commit);
}

void replaceTable(const std::filesystem::path& path, const std::string& table) {
  std::ifstream in(path);
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  const std::size_t begin = text.find(kBegin), end = text.find(kEnd);
  if (!in || begin == std::string::npos || end == std::string::npos || end < begin) {
    throw std::runtime_error(path.string() +
                             ": expected a place for the table between <!-- bench --> and <!-- /bench -->");
  }
  const std::size_t first = begin + std::string_view(kBegin).size();
  std::ofstream out(path);
  out << text.substr(0, first) << table << text.substr(end);
  out.close();
  if (!out) throw std::runtime_error(path.string() + ": cannot be written");
}

}  // namespace saccade::bench
