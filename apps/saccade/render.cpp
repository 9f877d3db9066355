#include <algorithm>
#include <filesystem>
#include <functional>
#include <iostream>
#include <memory>
#include <optional>

#include <opencv2/imgcodecs.hpp>

#include "commands.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/inspection/camera_path.hpp"
#include "saccade/inspection/layer_picture.hpp"
#include "saccade/inspection/scene_frame.hpp"
#include "saccade/inspection/video_writer.hpp"
#include "saccade/rendering/renderer.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_reader.hpp"
#include "terminal.hpp"

namespace saccade::app {
namespace {

constexpr double kFar_m = 100.0;  ///< pictures look farther than the 2D IOR map's rays

struct Options {
  std::string session, output, pose, layer = "color", size;
  std::vector<double> eye, look_at;
  std::optional<std::int64_t> frame;
  bool turntable = false, fly_through = false, force = false;
  double fov_deg = 60.0, frames_per_second = 30.0;
  int frames = 0;
};

bool endsWith(const std::string& text, const std::string& end) {
  return text.size() >= end.size() && text.compare(text.size() - end.size(), end.size(), end) == 0;
}

cv::Size parseSize(const std::string& text) {
  cv::Size size;
  char cross = 0, rest = 0;
  const int read = std::sscanf(text.c_str(), "%d%c%d%c", &size.width, &cross, &size.height, &rest);
  constexpr int kLargest = 8192;
  if (read != 3 || cross != 'x' || std::min(size.width, size.height) < 2 ||
      std::max(size.width, size.height) > kLargest) {
    throw std::invalid_argument("expected a size such as 1280x720, at most 8192 a side, found \"" + text + "\"");
  }
  return size;
}

std::vector<Pose> trackedPath(const SessionReader& session) {
  std::vector<Pose> path;
  for (const FrameRecord& frame : session.frames()) {
    if (frame.T_WC) path.push_back(*frame.T_WC);
  }
  return path;
}

Pose poseOfFrame(const SessionReader& session, std::int64_t index, const std::string& path) {
  for (const FrameRecord& frame : session.frames()) {
    if (frame.index.value != index) continue;
    if (!frame.T_WC) throw IoError(path, "a tracked frame " + std::to_string(index), "a lost one");
    return *frame.T_WC;
  }
  throw IoError(path, "a frame " + std::to_string(index), "none of that number");
}

/// The session's own camera for a frame's pose, unless a size is asked for; else one with the asked field of view.
PinholeCamera cameraFor(const Options& options, const SessionReader& session) {
  const bool as_seen = options.frame || options.fly_through || !options.pose.empty();
  if (options.size.empty() && as_seen) {
    PinholeCamera camera = session.metadata().camera;
    return camera;
  }
  const cv::Size size = parseSize(options.size.empty() ? "1280x720" : options.size);
  return cameraWithFov(size.width, size.height, options.fov_deg * M_PI / 180.0);
}

std::vector<Pose> posesFor(const Options& options, const SessionReader& session, const SceneFrame& scene,
                           const PinholeCamera& camera) {
  const auto vector = [](const std::vector<double>& v) { return Eigen::Vector3d(v[0], v[1], v[2]); };
  if (options.frame) return {poseOfFrame(session, *options.frame, options.session)};
  if (!options.pose.empty()) return {parsePose(options.pose)};
  if (!options.eye.empty()) {
    const Eigen::Vector3d target = options.look_at.empty() ? scene.box.center() : vector(options.look_at);
    return {lookAt(vector(options.eye), target, scene.up_W)};
  }
  if (scene.empty()) throw IoError(options.session, "a map with occupied leaves", "an empty one");
  if (options.fly_through) {
    const std::vector<Pose> path = trackedPath(session);
    return flyThrough(path, options.frames > 0 ? options.frames : static_cast<int>(path.size()));
  }
  constexpr int kTurntablePictures = 240;
  if (options.turntable) return turntable(scene, camera, options.frames > 0 ? options.frames : kTurntablePictures);
  return {turntable(scene, camera, 1).front()};
}

/// Renders pose by pose; all pictures share the range of values of the first, so that a film does not flicker.
void paint(const IorMap& map, const PinholeCamera& camera, const std::vector<Pose>& poses, const SceneFrame& scene,
           PictureLayer layer, const std::function<void(const cv::Mat3b&)>& take) {
  Renderer renderer(RendererConfig{.near_m = 0.05, .far_m = kFar_m});
  std::optional<LayerRange> range;
  for (const Pose& pose : poses) {
    const SurfaceView& view = renderer.renderSurface(map.view(), camera, pose);
    if (!range) range = rangeOf(view, layer, map.view(), scene.up_W);
    take(paintLayer(view, layer, map.view(), scene.up_W, *range));
  }
}

void writePicture(const std::string& path, const cv::Mat3b& picture) {
  bool written = false;
  try {
    written = cv::imwrite(path, picture);
  } catch (const cv::Exception&) {  // an unknown file name extension
    written = false;
  }
  if (!written) throw IoError(path, "a picture file (.png) that can be written", "none");
}

void run(const Options& options) {
  const PictureLayer layer = pictureLayer(options.layer);
  const bool film = endsWith(options.output, ".mp4");
  const bool many = options.turntable || options.fly_through;
  if (many != film) {
    throw std::invalid_argument(many ? "expected a video -o FILE.mp4 for --turntable and --fly-through, found \"" +
                                           options.output + "\""
                                     : "a video needs --turntable or --fly-through; one pose makes a .png");
  }
  std::error_code ignored;
  if (!options.force && std::filesystem::exists(options.output, ignored)) {
    throw IoError(options.output, "no file of that name yet (--force replaces it)", "one that exists");
  }
  const SessionReader session(options.session);
  const IorMap map = loadMap(session);
  const SceneFrame scene = findSceneFrame(map.view(), session.frames());
  PinholeCamera camera = cameraFor(options, session);
  if (film) {  // video codecs want even sides
    camera.width -= camera.width % 2;
    camera.height -= camera.height % 2;
  }
  const std::vector<Pose> poses = posesFor(options, session, scene, camera);
  if (!film) {
    paint(map, camera, poses, scene, layer, [&](const cv::Mat3b& picture) { writePicture(options.output, picture); });
  } else {
    VideoWriter video(options.output, {camera.width, camera.height}, options.frames_per_second);
    ProgressLine progress(static_cast<std::int64_t>(poses.size()));
    std::int64_t done = 0;
    paint(map, camera, poses, scene, layer, [&](const cv::Mat3b& picture) {
      video.write(picture);
      progress.show(++done, "pictures");
    });
    video.finish();
  }
  std::cerr << "written: " << std::filesystem::absolute(options.output).lexically_normal().string() << "\n";
}

}  // namespace

void addRender(CLI::App& program) {
  auto options = std::make_shared<Options>();
  CLI::App* command = program.add_subcommand("render", "Draw the map of a session from any pose; needs no display");
  command->add_option("SESSION", options->session, "a *.saccade file")->required();
  command->add_option("-o,--output", options->output, "the picture (.png) or video (.mp4) to write")->required();
  command->add_flag("--force", options->force, "replace a file that exists");
  CLI::Option_group* from = command->add_option_group("from where", "default: all of the map, from outside");
  from->add_option("--pose", options->pose, "T_WC as \"x y z qx qy qz qw\" or \"x y z\", metres");
  from->add_option("--frame", options->frame, "the pose of this frame of the input");
  auto* eye = from->add_option("--eye", options->eye, "place of the camera: X Y Z, metres")->expected(3);
  from->add_flag("--turntable", options->turntable, "a film once around the map");
  from->add_flag("--fly-through", options->fly_through, "a film along the camera's path, made calm");
  from->require_option(0, 1);
  command->add_option("--look-at", options->look_at, "what --eye looks at: X Y Z (default: the middle)")
      ->expected(3)
      ->needs(eye);
  command->add_option("--layer", options->layer, "what to show")->check(CLI::IsMember(pictureLayerNames()));
  command->add_option("--size", options->size, "WIDTHxHEIGHT (default: the session's camera, or 1280x720)");
  command->add_option("--fov", options->fov_deg, "horizontal field of view, degrees")->check(CLI::Range(1.0, 170.0));
  command->add_option("--frames", options->frames, "pictures of the film")->check(CLI::Range(2, 100000));
  command->add_option("--fps", options->frames_per_second, "pictures a second of the film")
      ->check(CLI::Range(1.0, 240.0));
  command->callback([options] { run(*options); });
}

}  // namespace saccade::app
