#include "saccade/evaluation/evaluation_report.hpp"

#include <fstream>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "evaluation/sequence_means.hpp"
#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kAll = 255;

Json scoreJson(const DiscoveryScore& score, int k) {
  const std::string at = "_at_" + std::to_string(k);
  return {{"recall_all", score.recall(kAll)},
          {"recall" + at, score.recall(k)},
          {"precision" + at, score.precision(k)},
          {"precision_all", score.precision(kAll)},
          {"f_score", score.fScore(k)},
          {"f_score_all", score.fScore(kAll)},
          {"auc_recall", score.recallAuc()},
          {"auc_precision", score.precisionAuc()},
          {"mean_best_overlap", score.meanBestOverlap()}};
}

Json jsonOf(const MethodScore& method, int k) {
  Json json;
  json["boxes"] = scoreJson(method.boxes, k);
  if (method.masks) json["masks"] = scoreJson(*method.masks, k);
  if (method.boxes_as_many_as_ours) json["boxes_as_many_as_ours"] = scoreJson(*method.boxes_as_many_as_ours, k);
  json["candidates_per_frame"] = method.candidates;
  json["ms_per_frame"] = method.ms;
  return json;
}

Json globalJson(const DiscoveryScore& score, int k) {
  return {{"global_recall", score.globalRecall(k)},
          {"global_recall_auc", meanOf(score.globalRecallOverTime(k))},
          {"global_recall_all", score.globalRecall(kAll)}};
}

Json jsonOf(const SequenceRun& run, int k) {
  Json json = {{"boxes", globalJson(run.score.boxes, k)},
               {"masks", globalJson(run.score.masks, k)},
               {"inhibited_per_frame", run.score.inhibited},
               {"median_ms", run.score.median_ms}};
  if (!run.score.revisit_rate.empty()) json["revisit_rate"] = run.score.meanRevisitRate();
  return json;
}

Json jsonOf(const SequenceEvaluation& sequence, int k) {
  Json json = {{"input", sequence.input}, {"frames", sequence.frames}, {"lost", sequence.lost}};
  if (sequence.ate) {
    json["ate_rmse_m"] = sequence.ate->rmse_m;
    json["ate_max_m"] = sequence.ate->max_m;
    json["ate_poses"] = sequence.ate->matched;
  }
  if (sequence.rpe) {
    json["rpe_translation_m"] = sequence.rpe->translation_rmse_m;
    json["rpe_rotation_rad"] = sequence.rpe->rotation_rmse_rad;
  }
  if (sequence.propagation) {
    json["propagation"] = {{"mask_iou", sequence.propagation->mean_iou}, {"objects", sequence.propagation->objects}};
  }
  json["labelled_frames"] = sequence.ours.boxes.frames();
  json["methods"][sequence.ours.name] = jsonOf(sequence.ours, k);
  for (const MethodScore& method : sequence.others) json["methods"][method.name] = jsonOf(method, k);
  for (const SequenceRun& run : sequence.runs) json["runs"][run.name] = jsonOf(run, k);
  return json;
}

/// Means of all numbers that every document has, in the structure of the first.
Json meanOfDocuments(const std::vector<Json>& documents) {
  Json mean;
  for (const auto& [key, value] : documents.front().items()) {
    std::vector<Json> values;
    for (const Json& document : documents) {
      if (document.contains(key)) values.push_back(document[key]);
    }
    if (values.size() != documents.size()) continue;
    if (value.is_object()) {
      mean[key] = meanOfDocuments(values);
    } else if (value.is_number()) {
      double sum = 0.0;
      for (const Json& number : values) sum += number.get<double>();
      mean[key] = sum / static_cast<double>(values.size());
    }
  }
  return mean;
}

Json documentOf(const std::vector<SequenceEvaluation>& sequences, int k) {
  std::vector<Json> all;
  all.reserve(sequences.size());
  for (const SequenceEvaluation& sequence : sequences) all.push_back(jsonOf(sequence, k));
  Json document = {{"k", k}, {"sequences", all}};
  if (!all.empty()) document["mean"] = meanOfDocuments(all);
  return document;
}

std::string percent(const Json& value) {
  return fmt::format("{:.1f}", 100.0 * value.get<double>());
}

class CsvFile {
 public:
  CsvFile(std::filesystem::path path, const std::string& heading) : path_(std::move(path)), file_(path_) {
    file_ << heading << "\n";
    check();
  }
  void row(const std::string& text) {
    file_ << text << "\n";
    check();
  }

 private:
  void check() {
    if (!file_)
      throw IoError(path_, "a CSV file that can be written", "a full disk or a folder that cannot be written");
  }
  std::filesystem::path path_;
  std::ofstream file_;
};

/// A field of a CSV line (RFC 4180).
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\n") == std::string::npos) return text;
  std::string field = "\"";
  for (const char c : text) field += c == '"' ? std::string("\"\"") : std::string(1, c);
  return field + "\"";
}

}  // namespace

std::string evaluationJson(const std::vector<SequenceEvaluation>& sequences, int k) {
  return documentOf(sequences, k).dump(2);
}

std::string framesJson(const SequenceEvaluation& evaluation, int k) {
  Json json = {{"frames", evaluation.frames}};
  json.update(jsonOf(evaluation.ours, k));
  for (const MethodScore& method : evaluation.others) json["others"][method.name] = jsonOf(method, k);
  return json.dump(2);
}

std::vector<std::vector<std::string>> figureRows(const SequenceEvaluation& evaluation, int k) {
  const Json ours = jsonOf(evaluation.ours, k);
  std::vector<std::vector<std::string>> rows = {
      {"Pascal criterion, " + std::to_string(evaluation.frames) + " frames", "boxes", "masks"}};
  for (const auto& [name, value] : ours["boxes"].items()) {
    rows.push_back(
        {name, fmt::format("{:.3f}", value.get<double>()), fmt::format("{:.3f}", ours["masks"][name].get<double>())});
  }
  rows.push_back({"candidates_per_frame", fmt::format("{:.1f}", evaluation.ours.candidates)});
  rows.push_back({"ms_per_frame", fmt::format("{:.1f}", evaluation.ours.ms)});
  return rows;
}

std::vector<std::vector<std::string>> methodRows(const std::vector<SequenceEvaluation>& sequences, int k) {
  const Json mean = documentOf(sequences, k)["mean"];
  const std::string at = "_at_" + std::to_string(k);
  std::vector<std::vector<std::string>> rows = {{"single frames, boxes, %", "recall @" + std::to_string(k), "all",
                                                 "precision @" + std::to_string(k), "F @" + std::to_string(k), "F all",
                                                 "F as many as ours", "AUC recall", "best overlap",
                                                 "masks: recall @" + std::to_string(k), "all", "ms"}};
  for (const auto& [name, method] : mean["methods"].items()) {
    const Json& boxes = method["boxes"];
    const bool has_masks = method.contains("masks"), as_many = method.contains("boxes_as_many_as_ours");
    rows.push_back({name, percent(boxes["recall" + at]), percent(boxes["recall_all"]), percent(boxes["precision" + at]),
                    percent(boxes["f_score"]), percent(boxes["f_score_all"]),
                    percent((as_many ? method["boxes_as_many_as_ours"] : boxes)["f_score_all"]),
                    percent(boxes["auc_recall"]), percent(boxes["mean_best_overlap"]),
                    has_masks ? percent(method["masks"]["recall" + at]) : "-",
                    has_masks ? percent(method["masks"]["recall_all"]) : "-",
                    fmt::format("{:.1f}", method["ms_per_frame"].get<double>())});
  }
  return rows;
}

std::vector<std::vector<std::string>> runRows(const std::vector<SequenceEvaluation>& sequences, int k) {
  const Json mean = documentOf(sequences, k)["mean"];
  std::vector<std::vector<std::string>> rows = {{"runs, %", "global recall @" + std::to_string(k), "AUC", "@255",
                                                 "masks @" + std::to_string(k), "revisits", "inhibited", "ms"}};
  for (const auto& [name, run] : mean["runs"].items()) {
    rows.push_back({name, percent(run["boxes"]["global_recall"]), percent(run["boxes"]["global_recall_auc"]),
                    percent(run["boxes"]["global_recall_all"]), percent(run["masks"]["global_recall"]),
                    run.contains("revisit_rate") ? percent(run["revisit_rate"]) : "-",
                    fmt::format("{:.1f}", run["inhibited_per_frame"].get<double>()),
                    fmt::format("{:.1f}", run["median_ms"].get<double>())});
  }
  return rows;
}

void writeCurves(const std::vector<SequenceEvaluation>& sequences, int k, const std::filesystem::path& folder) {
  CsvFile methods(folder / "recall_precision.csv",
                  "sequence,method,candidates,recall_boxes,precision_boxes,recall_masks,precision_masks");
  CsvFile recall(folder / "global_recall.csv", "sequence,run,frame,recall_boxes,recall_masks,recall_boxes_255");
  CsvFile revisits(folder / "revisit_rate.csv", "sequence,run,frame,revisit_rate");
  for (const SequenceEvaluation& sequence : sequences) {
    const auto addMethod = [&](const MethodScore& method) {
      for (int n = 1; n <= kAll; ++n) {
        const std::string masks =
            method.masks ? fmt::format("{:.5f},{:.5f}", method.masks->recall(n), method.masks->precision(n)) : ",";
        methods.row(fmt::format("{},{},{},{:.5f},{:.5f},{}", quoted(sequence.input), quoted(method.name), n,
                                method.boxes.recall(n), method.boxes.precision(n), masks));
      }
    };
    addMethod(sequence.ours);
    for (const MethodScore& method : sequence.others) addMethod(method);
    for (const SequenceRun& run : sequence.runs) {
      const auto boxes = run.score.boxes.globalRecallOverTime(k), masks = run.score.masks.globalRecallOverTime(k),
                 all = run.score.boxes.globalRecallOverTime(kAll);
      for (std::size_t i = 0; i < boxes.size(); ++i) {
        recall.row(fmt::format("{},{},{},{:.5f},{:.5f},{:.5f}", quoted(sequence.input), quoted(run.name),
                               run.score.labelled_frames[i], boxes[i], masks[i], all[i]));
      }
      for (std::size_t i = 0; i < run.score.revisit_rate.size(); ++i) {
        revisits.row(
            fmt::format("{},{},{},{:.5f}", quoted(sequence.input), quoted(run.name), i, run.score.revisit_rate[i]));
      }
    }
  }
}

}  // namespace saccade
