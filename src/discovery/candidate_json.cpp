#include "saccade/discovery/candidate_json.hpp"

#include <cmath>

#include <nlohmann/json.hpp>

#include "saccade/discovery/candidate_mask.hpp"

namespace saccade {
namespace {

using Json = nlohmann::ordered_json;

// Five digits: enough for ranks and reports, and a line stays short.
double rounded(double value) {
  return std::round(value * 1e5) / 1e5;
}

Json candidateJson(const Candidate& candidate, const Perception& seen, const CandidateOutliner& outliner,
                   const DepthMaps* depth, const std::optional<Pose>& T_WC) {
  Json json;
  json["rank"] = nullptr;
  json["score"] = rounded(candidate.score);
  json["attended"] = false;
  json["inhibited"] = candidate.inhibited;
  const CandidateOutline outline = outliner.outline(candidate);
  json["box"] = {outline.box.x, outline.box.y, outline.box.width, outline.box.height};
  json["source"] = sourceName(candidate.source);
  const cv::Size size = seen.imageSize();
  json["mask"]["size"] = {size.height, size.width};
  json["mask"]["counts"] = outline.mask;
  json["box3d"] = nullptr;
  if (depth != nullptr && T_WC) {
    if (const auto box = candidateBox(candidate, seen, *depth, *T_WC)) {
      json["box3d"] = {rounded(box->min().x()), rounded(box->min().y()), rounded(box->min().z()),
                       rounded(box->max().x()), rounded(box->max().y()), rounded(box->max().z())};
    }
  }
  Json features = Json::array();
  for (const float feature : candidate.features) features.push_back(rounded(static_cast<double>(feature)));
  json["features"] = std::move(features);
  return json;
}

}  // namespace

std::string_view sourceName(CandidateSource source) {
  return source == CandidateSource::kColor ? "colour" : "depth";
}

std::optional<Eigen::AlignedBox3d> candidateBox(const Candidate& candidate, const Perception& seen,
                                                const DepthMaps& depth, const Pose& T_WC) {
  Eigen::AlignedBox3d box;
  forEachMaskRun(candidate, seen, [&](int v, int begin, int end) {
    const cv::Vec3f* row = depth.vertices[v];
    for (int u = begin; u < end; ++u) {
      if (!(row[u][2] > 0.0F)) continue;
      box.extend(T_WC * Eigen::Vector3f(row[u][0], row[u][1], row[u][2]).cast<double>());
    }
  });
  if (box.isEmpty()) return std::nullopt;
  return box;
}

std::string candidateLine(const CandidateLineHeader& header, const Candidates& open, int attended_count,
                          const Candidates& inhibited, const Perception& seen, const CandidateOutliner& outliner,
                          const DepthMaps* depth, const std::optional<Pose>& T_WC) {
  Json line;
  line["frame"] = header.frame.value;
  line["name"] = header.name;
  line["stamp_s"] = header.stamp_s;
  line["tracking"] = header.tracking;
  Json list = Json::array();
  for (std::size_t rank = 0; rank < open.size(); ++rank) {
    Json json = candidateJson(open[rank], seen, outliner, depth, T_WC);
    json["rank"] = rank;
    json["attended"] = static_cast<int>(rank) < attended_count;
    list.push_back(std::move(json));
  }
  for (const Candidate& candidate : inhibited) list.push_back(candidateJson(candidate, seen, outliner, depth, T_WC));
  line["candidates"] = std::move(list);
  // Names come from file names, which need not be UTF-8.
  return line.dump(-1, ' ', false, Json::error_handler_t::replace);
}

}  // namespace saccade
