#include "sources/openni2_library.hpp"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <mutex>
#include <thread>

#include <opencv2/imgproc.hpp>

#include "saccade/core/errors.hpp"
#include "virtual_camera/virtual_camera_protocol.hpp"

namespace saccade {
namespace {

std::mutex library_mutex;
int library_users = 0;

PinholeCamera cameraOf(const openni::VideoStream& stream) {
  const openni::VideoMode mode = stream.getVideoMode();
  const int width = mode.getResolutionX(), height = mode.getResolutionY();
  const double fx = 0.5 * width / std::tan(0.5 * static_cast<double>(stream.getHorizontalFieldOfView()));
  const double fy = 0.5 * height / std::tan(0.5 * static_cast<double>(stream.getVerticalFieldOfView()));
  return {width, height, fx, fy, 0.5 * (width - 1), 0.5 * (height - 1)};
}

bool isUsable(const PinholeCamera& camera) {
  return camera.fx > 0 && camera.fy > 0 && std::isfinite(camera.fx) && std::isfinite(camera.fy);
}

/// The mode of a stream that suits us best: 640 x 480 if there is one, 30 frames a second, pixels we can read.
void chooseMode(openni::VideoStream& stream, bool is_color) {
  const auto fitness = [&](const openni::VideoMode& mode) {
    const openni::PixelFormat format = mode.getPixelFormat();
    const bool readable =
        is_color ? format == openni::PIXEL_FORMAT_RGB888
                 : format == openni::PIXEL_FORMAT_DEPTH_1_MM || format == openni::PIXEL_FORMAT_DEPTH_100_UM;
    if (!readable) return -1;
    const int pixels = mode.getResolutionX() * mode.getResolutionY();
    return (pixels == 640 * 480 ? 1 << 28 : pixels) + (mode.getFps() == 30 ? 2 : 0) +
           (format == openni::PIXEL_FORMAT_DEPTH_100_UM ? 1 : 0);
  };
  const openni::Array<openni::VideoMode>& modes = stream.getSensorInfo().getSupportedVideoModes();
  int best = -1;
  for (int i = 0; i < modes.getSize(); ++i) {
    if (fitness(modes[i]) >= 0 && (best < 0 || fitness(modes[i]) > fitness(modes[best]))) best = i;
  }
  if (best >= 0) (void)stream.setVideoMode(modes[best]);
}

/// What the virtual camera tells about itself; none from other drivers.
std::optional<RgbdCalibration> toldCalibration(const openni::Device& device) {
  std::vector<char> yaml(virtual_camera::kMostCalibrationBytes);
  int size = static_cast<int>(yaml.size());
  if (!device.isPropertySupported(virtual_camera::kCalibrationProperty) ||
      device.getProperty(virtual_camera::kCalibrationProperty, yaml.data(), &size) != openni::STATUS_OK) {
    return std::nullopt;
  }
  RgbdCalibration calibration =
      parseCalibrationYaml(std::string(yaml.data(), static_cast<std::size_t>(size)), device.getDeviceInfo().getUri());
  calibration.origin = "the camera's driver";
  return calibration;
}

}  // namespace

OpenNi2Library::OpenNi2Library(const std::string& what) {
  const std::lock_guard lock(library_mutex);
  if (library_users == 0 && openni::OpenNI::initialize() != openni::STATUS_OK) {
    throw IoError(what, "OpenNI2 with its drivers", openNi2Error());
  }
  ++library_users;
}

OpenNi2Library::~OpenNi2Library() {
  const std::lock_guard lock(library_mutex);
  if (--library_users == 0) openni::OpenNI::shutdown();
}

std::string openNi2Error() {
  std::string text = openni::OpenNI::getExtendedError();
  std::replace_if(
      text.begin(), text.end(), [](char c) { return c == '\n' || c == '\t' || c == '\r'; }, ' ');
  text.erase(text.find_last_not_of(' ') + 1);
  return text.empty() ? "a failure that it does not explain" : text;
}

void OpenNi2Streams::open(const char* uri, const std::string& what) {
  if (device.open(uri) != openni::STATUS_OK) {
    throw IoError(what, "an OpenNI2 device that can be opened", openNi2Error());
  }
  if (!device.hasSensor(openni::SENSOR_COLOR) || !device.hasSensor(openni::SENSOR_DEPTH)) {
    throw IoError(what, "a device with a colour and a depth stream", "one without");
  }
  if (color.create(device, openni::SENSOR_COLOR) != openni::STATUS_OK ||
      depth.create(device, openni::SENSOR_DEPTH) != openni::STATUS_OK) {
    throw IoError(what, "a colour and a depth stream that can be opened", openNi2Error());
  }
  if (device.isFile()) return;
  chooseMode(color, true);
  chooseMode(depth, false);
  for (openni::VideoStream* stream : {&color, &depth}) {
    if (stream->isPropertySupported(openni::STREAM_PROPERTY_MIRRORING)) (void)stream->setMirroringEnabled(false);
  }
  if (device.isImageRegistrationModeSupported(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR)) {
    (void)device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
  }
  (void)device.setDepthColorSyncEnabled(true);
}

// OpenNI2's player of files says "go on" when its thread begins and "stop" when it is closed, in the same variable.
// Closed before its thread has begun, it goes on, is cancelled after 3 s, and ends the program if its code is unloaded
// by then.
void OpenNi2Streams::close() {
  constexpr std::chrono::milliseconds kThreadBegins(300);
  if (device.isValid() && device.isFile() && !has_played_) std::this_thread::sleep_for(kThreadBegins);
  for (openni::VideoStream* stream : {&color, &depth}) {
    if (!stream->isValid()) continue;
    stream->stop();
    stream->destroy();
  }
  if (device.isValid()) device.close();
}

openni::Status OpenNi2Streams::awaitFrame(std::vector<openni::VideoStream*> waiting,
                                          std::chrono::milliseconds longest_wait, std::size_t& ready) {
  int first = 0;
  openni::Status status = openni::STATUS_ERROR;
  waiting_.run([&] {
    status = openni::OpenNI::waitForAnyStream(waiting.data(), static_cast<int>(waiting.size()), &first,
                                              static_cast<int>(longest_wait.count()));
  });
  ready = static_cast<std::size_t>(first);
  has_played_ |= status == openni::STATUS_OK;
  return status;
}

openni::Status OpenNi2Streams::readFrame(openni::VideoStream& stream, openni::VideoFrameRef& frame) {
  openni::Status status = openni::STATUS_ERROR;
  waiting_.run([&] { status = stream.readFrame(&frame); });
  return status;
}

double depthUnitsPerMetre(const openni::VideoStream& depth, const std::string& what) {
  switch (depth.getVideoMode().getPixelFormat()) {
    case openni::PIXEL_FORMAT_DEPTH_1_MM:
      return 1000.0;
    case openni::PIXEL_FORMAT_DEPTH_100_UM:
      return 10000.0;
    default:
      throw IoError(what, "depth in millimetres or tenths of them", "another pixel format");
  }
}

RgbdCalibration calibrationOf(const OpenNi2Streams& streams, const std::string& what,
                              std::vector<std::string>& remarks) {
  if (std::optional<RgbdCalibration> told = toldCalibration(streams.device)) return *std::move(told);
  RgbdCalibration calibration;
  calibration.origin = "the field of view";
  calibration.color = cameraOf(streams.color);
  if (!isUsable(calibration.color)) {
    throw IoError(what, "a field of view, or a full calibration (side file NAME.oni.yaml)", "neither");
  }
  calibration.depth_units_per_metre = depthUnitsPerMetre(streams.depth, what);
  const bool registers = streams.device.getImageRegistrationMode() == openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR;
  PinholeCamera depth = cameraOf(streams.depth);
  if (registers && depth.width == calibration.color.width && depth.height == calibration.color.height) {
    return calibration;
  }
  if (!isUsable(depth)) depth = calibration.color;
  if (!registers && depth != calibration.color) {
    calibration.depth = DepthCamera{depth, {}, Pose::Identity()};
    remarks.emplace_back("the device does not register depth to colour: both cameras are taken to be in one place");
  } else if (!registers) {
    remarks.emplace_back("the device does not say whether depth is registered to colour: it is taken to be");
  }
  return calibration;
}

bool numbersFromOne(const openni::Device& device) {
  return device.isPropertySupported(virtual_camera::kCalibrationProperty);
}

void copyColor(const openni::VideoFrameRef& frame, cv::Mat3b& bgr) {
  const cv::Mat rgb(frame.getHeight(), frame.getWidth(), CV_8UC3, const_cast<void*>(frame.getData()),
                    static_cast<std::size_t>(frame.getStrideInBytes()));
  cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
}

void copyDepth(const openni::VideoFrameRef& frame, cv::Mat1w& raw) {
  const cv::Mat pixels(frame.getHeight(), frame.getWidth(), CV_16UC1, const_cast<void*>(frame.getData()),
                       static_cast<std::size_t>(frame.getStrideInBytes()));
  pixels.copyTo(raw);
}

}  // namespace saccade
