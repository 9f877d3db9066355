#include "saccade/exchange/coco_json.hpp"

#include <algorithm>
#include <ostream>
#include <string>

#include <nlohmann/json.hpp>

#include "saccade/discovery/coco_rle.hpp"

namespace saccade {
namespace {

using Json = nlohmann::ordered_json;

constexpr int kCategory = 1;

Json imageOf(const FrameRecord& frame, const PinholeCamera& camera) {
  Json image = {{"id", frame.ordinal.value},
                {"file_name", frame.name},
                {"width", camera.width},
                {"height", camera.height},
                {"stamp_s", frame.stamp_s}};
  if (frame.T_WC) {
    Json rows = Json::array();
    for (int row = 0; row < 4; ++row) {
      for (int column = 0; column < 4; ++column) rows.push_back(frame.T_WC->matrix()(row, column));
    }
    image["T_WC"] = rows;
  }
  return image;
}

std::int64_t pixelsOf(const std::string& counts, const PinholeCamera& camera) {
  std::int64_t pixels = 0;
  forEachCocoRun(counts, {camera.width, camera.height},
                 [&](int, int begin_v, int end_v) { pixels += end_v - begin_v; });
  return pixels;
}

Json annotationOf(const CandidateRecord& candidate, std::int64_t id, const PinholeCamera& camera) {
  const cv::Rect& box = candidate.box;
  Json annotation = {{"id", id},
                     {"image_id", candidate.frame.value},
                     {"category_id", kCategory},
                     {"bbox", {box.x, box.y, box.width, box.height}},
                     {"area", pixelsOf(candidate.mask_rle, camera)},
                     {"iscrowd", 0},
                     {"segmentation", {{"size", {camera.height, camera.width}}, {"counts", candidate.mask_rle}}},
                     {"score", candidate.score},
                     {"rank", candidate.rank},
                     {"source", candidate.source}};
  const bool has_box = std::any_of(candidate.box3d_m.begin(), candidate.box3d_m.end(), [](double c) { return c != 0; });
  if (has_box) annotation["box3d"] = candidate.box3d_m;
  return annotation;
}

}  // namespace

void writeCocoJson(const SessionReader& session, std::ostream& out) {
  const PinholeCamera& camera = session.metadata().camera;
  Json images = Json::array();
  std::vector<FrameOrdinal> listed;
  for (const FrameRecord& frame : session.frames()) {
    if (frame.attended == 0) continue;
    images.push_back(imageOf(frame, camera));
    listed.push_back(frame.ordinal);
  }
  const Json info = {{"description", "attended object candidates of " + session.metadata().input},
                     {"version", session.metadata().saccade_version},
                     {"date_created", session.metadata().created_utc}};
  out << "{\"info\": " << info.dump() << ",\n\"licenses\": [],\n\"categories\": "
      << Json::array({{{"id", kCategory}, {"name", "object"}, {"supercategory", "thing"}}}).dump()
      << ",\n\"images\": " << images.dump() << ",\n\"annotations\": [";
  std::int64_t id = 0;
  for (const FrameOrdinal frame : listed) {
    for (const CandidateRecord& candidate : session.candidates(frame)) {
      out << (id == 0 ? "\n" : ",\n");
      out << annotationOf(candidate, ++id, camera).dump();
    }
  }
  out << "\n]}\n";
}

}  // namespace saccade
