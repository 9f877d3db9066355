#include "saccade/reporting/session_report.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "page_parts.hpp"
#include "reporting/html_text.hpp"
#include "reporting/plan_axes.hpp"
#include "reporting/reduced_map.hpp"
#include "reporting/report_objects.hpp"
#include "reporting/report_plots.hpp"
#include "reporting/report_views.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/inspection/layer_picture.hpp"
#include "saccade/inspection/scene_frame.hpp"
#include "saccade/inspection/session_summary.hpp"
#include "saccade/objects/object_memory.hpp"
#include "saccade/rendering/renderer.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_snapshot.hpp"
#include "saccade/sources/stamped_poses.hpp"

namespace saccade {
namespace {

// What the sections may take. Base 64 needs four bytes for three.
constexpr std::size_t kMostPoints = 300'000;
constexpr std::size_t kMostViews = 24;  ///< shown; crops are taken from twice as many
constexpr std::size_t kLargestView_bytes = 90'000;
constexpr std::size_t kMostObjects = 120;
constexpr std::size_t kLargestCrop_bytes = 18'000;
constexpr std::size_t kMostPathPoints = 2'000;
constexpr std::size_t kLongestSettings = 500'000;
constexpr std::size_t kLongestName = 400;               ///< of what comes from the session into one place of the page
constexpr std::size_t kLargestPlots_bytes = 2'000'000;  ///< some hundred points a line, 16 bytes each
constexpr std::size_t kLargestRest_bytes = 1'000'000;   ///< tags, style, script, path
static_assert((kMostPoints * ReducedMap::kPointBytes + 2 * kMostViews * kLargestView_bytes +
               kMostObjects * kLargestCrop_bytes) /
                      3 * 4 +
                  5 * kLongestSettings + kLargestPlots_bytes + kLargestRest_bytes <=
              kLargestReport_bytes);

/// All that the page is made from.
struct Content {
  std::vector<FrameRecord> frames;
  SessionSummary summary;
  IorMap map;
  AttendLog log;
  std::vector<AttendedObject> objects;
  SceneFrame scene;
  std::optional<TruthComparison> truth;
};

std::string shown(const std::string& text, std::size_t longest = kLongestName) {
  return escapedHtml(text.size() > longest ? text.substr(0, longest) + " ..." : text);
}

std::string grouped(std::int64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t i = digits.size(); i > 3 && digits[i - 4] != '-';) digits.insert(i -= 3, 1, ' ');
  return digits;
}

std::optional<TruthComparison> compareWith(const std::optional<std::filesystem::path>& truth,
                                           const std::vector<FrameRecord>& frames) {
  if (!truth) return std::nullopt;
  const StampedPoses poses = StampedPoses::loadStrictly(*truth);
  std::vector<StampedPose> true_poses, estimate;
  for (std::size_t i = 0; i < poses.size(); ++i) true_poses.push_back({poses.stamp(i), poses.pose(i)});
  for (const FrameRecord& frame : frames) {
    if (frame.T_WC && frame.tracking == "tracked") estimate.push_back({frame.stamp_s, *frame.T_WC});
  }
  TruthComparison comparison;
  comparison.pairs = associate(estimate, true_poses);
  if (comparison.pairs.empty()) {
    throw IoError(*truth, "poses within 10 ms of the session's frames",
                  fmt::format("{} poses, none of them near one of {} tracked frames", poses.size(), estimate.size()));
  }
  comparison.alignment = alignToTruth(comparison.pairs);
  comparison.error = absoluteError(comparison.pairs);
  return comparison;
}

Content gather(const SessionReader& session, const std::optional<std::filesystem::path>& truth) {
  Content content;
  content.frames = session.frames();
  content.truth = compareWith(truth, content.frames);
  content.summary = summarise(session, content.frames);
  content.map = loadMap(session);
  content.log = loadAttendLog(session);
  content.objects = findObjects(content.log);
  content.scene = findSceneFrame(content.map.view(), content.frames);
  return content;
}

std::string tile(const std::string& value, const std::string& name) {
  return fmt::format("<div class=\"tile\"><b>{}</b><span>{}</span></div>\n", value, name);
}

std::string tiles(const Content& content) {
  const SessionSummary& s = content.summary;
  std::string html = "<div class=\"tiles\">\n";
  html += tile(grouped(s.frames), fmt::format("frames: {} tracked, {} weak, {} lost", grouped(s.tracked),
                                              grouped(s.weak), grouped(s.lost)));
  html += tile(fmt::format("{:.1f} s", s.covered_s), "time covered");
  html += tile(fmt::format("{:.2f} m", s.path_length_m), "camera path");
  html += tile(grouped(s.metadata.leaves),
               fmt::format("leaves of {:g} cm", std::round(s.metadata.leaf_size_m * 1e4) / 100.0));
  html += tile(grouped(s.attended), fmt::format("looks in {} ticks", grouped(s.metadata.tick)));
  html += tile(grouped(static_cast<std::int64_t>(content.objects.size())), "objects seen more than once");
  html += tile(fmt::format("{:.1f} ms", s.median_ms), "median time a frame");
  html += tile(fmt::format("{:.1f} MiB", static_cast<double>(s.file_bytes) / 1048576.0), "session file");
  if (content.truth) {
    html += tile(fmt::format("{:.1f} mm", 1000.0 * content.truth->error.rmse_m),
                 fmt::format("trajectory error (ATE), {} poses", content.truth->error.matched));
  }
  return html + "</div>\n";
}

const char* stateText(SessionState state) {
  switch (state) {
    case SessionState::kExploring:
      return "It was still being explored, or cut off; this is its last checkpoint.";
    case SessionState::kInterrupted:
      return "It was ended early by hand.";
    case SessionState::kComplete:
      return "";
  }
  return "";
}

std::string heading(const Content& content) {
  const SessionMetadata& metadata = content.summary.metadata;
  return fmt::format(
      "<header><div><h1>{}</h1><p class=\"soft\">{}, explored {} by saccade {}. {}</p></div>"
      "<button id=\"theme\" type=\"button\">Dark</button></header>\n",
      shown(metadata.input), shown(metadata.input_kind), shown(metadata.created_utc), shown(metadata.saccade_version),
      stateText(metadata.state));
}

nlohmann::ordered_json jsonOf(const Eigen::Vector3d& v) {
  const auto rounded = [](double x) { return std::round(x * 1e4) / 1e4; };
  return {rounded(v.x()), rounded(v.y()), rounded(v.z())};
}

/// What the page's script has to know of the scene besides the points.
std::string aboutScene(const Content& content, const ReducedMap& reduced, const std::vector<ReportView>& views) {
  const SceneFrame& scene = content.scene;
  std::vector<const FrameRecord*> posed;
  for (const FrameRecord& frame : content.frames) {
    if (frame.T_WC) posed.push_back(&frame);
  }
  nlohmann::ordered_json path = nlohmann::ordered_json::array(), keyframes = nlohmann::ordered_json::array();
  for (const std::size_t i : evenlyChosen(posed.size(), kMostPathPoints)) {
    path.push_back(jsonOf(posed[i]->T_WC->translation()));
  }
  for (const ReportView& view : views) keyframes.push_back(jsonOf(view.T_WC.translation()));
  double lowest_m = std::numeric_limits<double>::max(), highest_m = std::numeric_limits<double>::lowest();
  for (int i = 0; i < 8; ++i) {
    const double height_m = scene.box.corner(static_cast<Eigen::AlignedBox3d::CornerType>(i)).dot(scene.up_W);
    lowest_m = std::min(lowest_m, height_m);
    highest_m = std::max(highest_m, height_m);
  }
  constexpr double kFill = 0.8;  // of the sphere around the scene; the script's camera sees 1 rad from top to bottom
  const double distance_m = kFill * 0.5 * scene.box.sizes().norm() / std::sin(0.5);
  return jsonForScript({{"cell_m", reduced.cell_m},
                        {"origin", jsonOf(reduced.origin_W)},
                        {"up", jsonOf(scene.up_W)},
                        {"ahead", jsonOf(PlanAxes(scene.up_W).ahead)},
                        {"target", jsonOf(scene.box.center())},
                        {"distance", distance_m},
                        {"heights", {lowest_m, highest_m}},
                        {"path", path},
                        {"keyframes", keyframes}});
}

std::string sceneSection(const Content& content, const std::vector<ReportView>& views) {
  if (content.scene.empty()) return "<h2 id=\"map\">Map</h2>\n<p class=\"soft\">The map holds nothing occupied.</p>\n";
  const ReducedMap reduced = reduceMap(content.map.view(), kMostPoints);
  std::string html = fmt::format(R"html(<h2 id="map">Map</h2>
<div class="card scene">
<canvas id="scene" tabindex="0" aria-label="The map in three dimensions; arrow keys turn it, plus and minus zoom"></canvas>
<div class="bar">
<button type="button" data-mode="0" aria-pressed="true">Colour</button>
<button type="button" data-mode="1" aria-pressed="false">IOR weight</button>
<button type="button" data-mode="2" aria-pressed="false">Inhibited</button>
<button type="button" data-mode="3" aria-pressed="false">Height</button>
<button type="button" id="path" aria-pressed="true">Camera path</button>
<button type="button" id="reset">Reset view</button>
<span class="soft" data-legend="0">{} points of {:g} cm</span>
<span class="soft" data-legend="1" hidden>1<i class="legend" style="background:linear-gradient(90deg,#bf1a0d,#ffe64d)"></i>{} ticks until forgotten; grey: forgotten</span>
<span class="soft" data-legend="2" hidden>white: inhibited, looks go elsewhere</span>
<span class="soft" data-legend="3" hidden>low<i class="legend" style="background:linear-gradient(90deg,#440154,#31688e,#35b779,#fde725)"></i>high</span>
</div></div>
<p class="soft" id="scene-hint">Drag to turn, shift-drag or two fingers to move, wheel or pinch to zoom. Keys: arrows turn, W A S D move, + and - zoom, 1 to 4 colours, P path, R reset. Blue is the camera's path, orange its key frames.</p>
)html",
                                 grouped(static_cast<std::int64_t>(reduced.pointCount())), reduced.cell_m * 100.0,
                                 std::max(1u, reduced.largest_weight));
  html += "<script type=\"application/json\" id=\"scene-about\">" + aboutScene(content, reduced, views) + "</script>\n";
  return html + "<script type=\"text/plain\" id=\"scene-points\">" + base64(reduced.bytes) + "</script>\n";
}

std::string plotSection(const std::vector<ReportPlot>& plots) {
  std::string html = "<h2 id=\"plots\">Course of the exploration</h2>\n<div class=\"plots\">\n";
  for (const ReportPlot& plot : plots) {
    html += fmt::format("<figure class=\"card\"><h3>{}</h3>{}<figcaption>{}</figcaption></figure>\n",
                        escapedHtml(plot.title), plot.svg, escapedHtml(plot.caption));
  }
  return html + "</div>\n";
}

std::string viewSection(const Content& content, const std::vector<ReportView>& views) {
  if (views.empty()) return "";
  const PinholeCamera& camera = content.summary.metadata.camera;
  const cv::Vec3b kNothing(40, 36, 34);
  Renderer renderer;
  std::string html = fmt::format(
      R"(<h2 id="views">{}</h2>
<div class="bar" style="padding:0 0 .75rem;border:0"><button type="button" data-overlay="looks" aria-pressed="true">Looks</button>
<button type="button" data-overlay="ior" aria-pressed="false">2D IOR map at the end</button></div>
<div class="views">
)",
      views.front().rendered ? "Frames, as the map remembers them" : "Key frames");
  for (const std::size_t i : evenlyChosen(views.size(), kMostViews)) {
    const ReportView& view = views[i];
    const SurfaceView& seen = renderer.renderSurface(content.map.view(), camera, view.T_WC);
    const cv::Mat3b ior =
        paintLayer(seen, PictureLayer::kIorFlag, content.map.view(), content.scene.up_W, {}, kNothing);
    const std::string name = shown(view.frame.name);
    html += fmt::format(
        "<figure class=\"card\"><img data-kind=\"looks\" alt=\"Looks of {0}\" src=\"{1}\">"
        "<img data-kind=\"ior\" alt=\"2D IOR map seen from {0}\" src=\"{2}\">"
        "<figcaption>{0}, tick {3}: {4} open, {5} inhibited, {6} attended</figcaption></figure>\n",
        name, jpegUri(drawLooks(view, content.log, content.map, camera), kLargestView_bytes),
        jpegUri(ior, kLargestView_bytes), view.frame.tick, view.frame.open, view.frame.inhibited, view.frame.attended);
  }
  return html +
         "</div>\n<p class=\"soft\">Boxes are the attended candidates with their rank, from yellow (the first look) to "
         "blue; tinted is what was attended. In the 2D IOR map white is what attention leaves alone now.</p>\n";
}

std::string objectCard(const ReportObject& object) {
  const std::string picture = object.crop.empty()
                                  ? std::string("<span class=\"none\">no view shows it whole</span>")
                                  : fmt::format("<img alt=\"Object {}\" src=\"{}\">", object.object.id.value,
                                                jpegUri(object.crop, kLargestCrop_bytes));
  const Eigen::AlignedBox3d& box = object.box_W;
  const Eigen::Vector3d size_cm = box.isEmpty() ? Eigen::Vector3d(0, 0, 0) : Eigen::Vector3d(100.0 * box.sizes());
  const std::string inhibition = object.history.inhibited == 0
                                     ? std::string("not inhibited")
                                     : fmt::format("inhibited until tick {}", object.history.last_expiry);
  const std::string attribute =
      box.isEmpty() ? std::string("disabled")
                    : fmt::format("data-box=\"[{:.3f},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}]\"", box.min().x(),
                                  box.min().y(), box.min().z(), box.max().x(), box.max().y(), box.max().z());
  return fmt::format(
      "<button type=\"button\" {} aria-pressed=\"false\">{}<div><b>{}</b> &middot; {} looks<br>tick {} to {}<br>"
      "{:.0f} &times; {:.0f} &times; {:.0f} cm<br>{}</div></button>\n",
      attribute, picture, object.object.id.value, object.object.looks.size(), object.object.looks.front().tick.value,
      object.object.looks.back().tick.value, size_cm.x(), size_cm.y(), size_cm.z(), inhibition);
}

std::string objectSection(const Content& content, const std::vector<ReportView>& views) {
  if (content.objects.empty()) return "";
  const std::vector<ReportObject> objects =
      describeObjects(content.objects, content.log, content.map, content.summary.metadata.camera, views, kMostObjects);
  std::string html = fmt::format(
      "<h2 id=\"objects\">Objects</h2>\n<p class=\"soft\">{} Candidates that returned on the same leaves, by the "
      "number of "
      "looks. A click shows the object in the map.</p>\n<div class=\"objects\">\n",
      objects.size() < content.objects.size()
          ? fmt::format("The {} of {} that were looked at most.", objects.size(), content.objects.size())
          : std::string());
  for (const ReportObject& object : objects) html += objectCard(object);
  return html + "</div>\n";
}

std::string settingsSection(const Content& content) {
  const SessionMetadata& metadata = content.summary.metadata;
  constexpr std::size_t kMostRuns = 50;
  std::string html = "<h2 id=\"settings\">Runs and settings</h2>\n<table>\n";
  const std::vector<RunRecord>& runs = content.summary.runs;
  for (std::size_t i = 0; i < std::min(runs.size(), kMostRuns); ++i) {
    html +=
        fmt::format("<tr><td>run {}</td><td>{} ({}), from frame {} on, {}</td></tr>\n", runs[i].run,
                    shown(runs[i].input), shown(runs[i].input_kind), runs[i].first.value, shown(runs[i].started_utc));
  }
  if (runs.size() > kMostRuns) html += fmt::format("<tr><td></td><td>and {} more</td></tr>\n", runs.size() - kMostRuns);
  const PinholeCamera& camera = metadata.camera;
  html += fmt::format(
      "<tr><td>camera</td><td>{} &times; {} px, f {:.1f} {:.1f}, c {:.1f} {:.1f} (without lens distortion)</td></tr>\n",
      camera.width, camera.height, camera.fx, camera.fy, camera.cx, camera.cy);
  const Eigen::Vector3d& up = content.scene.up_W;
  html += fmt::format("<tr><td>up in W</td><td>{:.3f} {:.3f} {:.3f}, estimated</td></tr>\n</table>\n", up.x(), up.y(),
                      up.z());
  return html +
         "<details class=\"card\" style=\"margin-top:1rem\"><summary style=\"padding:.8rem 1rem;cursor:pointer\">"
         "All settings</summary><pre>" +
         shown(metadata.config_yaml, kLongestSettings) + "</pre></details>\n";
}

}  // namespace

std::string makeSessionReport(const SessionReader& session, const std::optional<std::filesystem::path>& truth) {
  const SessionSnapshot still(session);
  const Content content = gather(session, truth);
  const std::vector<TimelineEntry> timeline = timelineOf(session, content.log);
  const std::vector<ReportView> views = chooseViews(session, content.frames, content.map, 2 * kMostViews);
  std::string html = "<!doctype html>\n<html lang=\"en\" data-theme=\"light\">\n<head>\n<meta charset=\"utf-8\">\n";
  // Whatever a session holds, the page asks for nothing.
  html +=
      "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; img-src data:; style-src "
      "'unsafe-inline'; script-src 'unsafe-inline'\">\n"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
  html += "<title>" + shown(content.summary.metadata.input) + " - Saccade</title>\n<style>\n" +
          std::string(kPageStyle) + "</style>\n</head>\n<body>\n<main>\n";
  html += heading(content) + tiles(content);
  html +=
      "<nav><a href=\"#map\">Map</a><a href=\"#plots\">Course</a><a href=\"#views\">Frames</a>"
      "<a href=\"#objects\">Objects</a><a href=\"#settings\">Settings</a></nav>\n";
  html += sceneSection(content, views);
  html += plotSection(plotSession(session, timeline, content.map, content.log, content.scene.up_W, content.truth));
  html += viewSection(content, views);
  html += objectSection(content, views);
  html += settingsSection(content);
  html += "<footer class=\"soft\">Made by saccade report.</footer>\n</main>\n<script>\n" + std::string(kPageScript) +
          "</script>\n</body>\n</html>\n";
  return html;
}

}  // namespace saccade
