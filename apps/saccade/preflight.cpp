#include "saccade/preflight/preflight.hpp"

#include <algorithm>
#include <iostream>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "saccade/core/errors.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

struct Options {
  std::string input;
  bool json = false;
};

nlohmann::ordered_json sourceJson(const SourceDescription& source) {
  return {{"kind", source.kind},
          {"frames", source.total_frames < 0 ? nlohmann::ordered_json() : nlohmann::ordered_json(source.total_frames)},
          {"dropped_images", source.dropped},
          {"width", source.camera.width},
          {"height", source.camera.height},
          {"fx", source.camera.fx},
          {"fy", source.camera.fy},
          {"cx", source.camera.cx},
          {"cy", source.camera.cy},
          {"intrinsics_origin", source.intrinsics_origin},
          {"depth_units_per_metre", source.depth_units_per_metre},
          {"depth_scale_origin", source.depth_scale_origin},
          {"depth_registered", source.depth_was_registered},
          {"has_poses", source.has_poses},
          {"remarks", source.remarks}};
}

nlohmann::ordered_json toJson(const PreflightReport& report) {
  nlohmann::ordered_json json;
  json["input"] = report.input;
  json["ok"] = !report.wouldFail();
  json["source"] = report.source ? sourceJson(*report.source) : nlohmann::ordered_json();
  json["findings"] = nlohmann::ordered_json::array();
  for (const PreflightFinding& finding : report.findings) {
    json["findings"].push_back(
        {{"severity", nameOf(finding.severity)}, {"code", finding.code}, {"text", finding.text}});
  }
  if (report.stamps) {
    json["stamps"] = {{"frames_per_second", report.stamps->period_s > 0 ? 1.0 / report.stamps->period_s : 0.0},
                      {"worst_gap_s", report.stamps->worst_gap_s},
                      {"missing", report.stamps->missing},
                      {"duplicates", report.stamps->duplicates}};
  }
  if (report.depth_scale) {
    json["depth_scale"] = {{"declared_units_per_metre", report.depth_scale->declared_units_per_metre},
                           {"likeliest_units_per_metre", report.depth_scale->units_per_metre},
                           {"median_depth_m", report.depth_scale->median_depth_m},
                           {"reason", report.depth_scale->reason}};
  }
  if (report.focal_factor) json["focal_factor"] = *report.focal_factor;
  if (report.expected_seconds > 0) {
    json["expected_seconds"] = report.expected_seconds;
    json["expected_memory_mib"] = report.expected_memory_mib;
  }
  json["command"] = report.command;
  return json;
}

void printText(const PreflightReport& report) {
  std::vector<std::vector<std::string>> rows;
  const auto add = [&](const char* what, const std::string& text) {
    rows.push_back({fmt::format("{:<12}{}", what, text)});
  };
  std::cout << report.input << ": " << (report.source ? report.source->kind : "cannot be opened") << "\n";
  if (report.source) {
    const SourceDescription& source = *report.source;
    add("frames", source.is_live ? "live"
                  : source.total_frames < 0
                      ? "as many as it holds"
                      : grouped(source.total_frames) +
                            (source.dropped > 0 ? fmt::format(", {} images without a partner", source.dropped) : ""));
    add("size", fmt::format("{} x {}", source.camera.width, source.camera.height));
    add("intrinsics", fmt::format("fx {:.2f} fy {:.2f} cx {:.2f} cy {:.2f} from {}", source.camera.fx, source.camera.fy,
                                  source.camera.cx, source.camera.cy, source.intrinsics_origin));
    if (report.focal_factor) {
      add("", fmt::format("frames fit best with {:.2f} times that focal length", *report.focal_factor));
    }
    for (const std::string& remark : source.remarks) add("note", remark);
  }
  if (report.stamps && report.stamps->period_s > 0) {
    add("stamps", fmt::format("{:.2f} frames a second, longest gap {:.3f} s", 1.0 / report.stamps->period_s,
                              report.stamps->worst_gap_s));
  }
  if (report.depth_scale) add("depth", report.depth_scale->reason);
  if (report.expected_seconds > 0) {
    add("expect",
        fmt::format("about {:.0f} s on two cores and {:.0f} MiB", report.expected_seconds, report.expected_memory_mib));
  }
  std::cout << alignedTable(rows) << "\n";
  for (const PreflightFinding& finding : report.findings) {
    std::cout << fmt::format("{} ({}): {}\n", nameOf(finding.severity), finding.code, finding.text);
  }
  if (report.wouldFail()) return;
  std::cout << (report.findings.empty() ? "nothing wrong was found\n" : "") << "run: " << report.command << "\n";
}

void run(const Options& options) {
  const PreflightReport report = preflight(options.input);
  options.json ? void(std::cout << toJson(report).dump(2) << "\n") : printText(report);
  if (!report.wouldFail()) return;
  const auto faults =
      std::count_if(report.findings.begin(), report.findings.end(),
                    [](const PreflightFinding& finding) { return finding.severity == FindingSeverity::kFault; });
  throw IoError(options.input, "an input that can be explored",
                fmt::format("{} fault{}, the first: {}", faults, faults == 1 ? "" : "s", report.findings.front().code));
}

}  // namespace

void addPreflight(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand(
      "preflight", "Say what an input is, what is wrong with it and how to explore it; exit code 1 if that would fail");
  command->add_option("INPUT", options->input, "any input of explore")->required();
  command->add_flag("--json", options->json, "print JSON");
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
