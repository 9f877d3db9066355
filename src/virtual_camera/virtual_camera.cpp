#include "virtual_camera/virtual_camera.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstring>

#include <opencv2/imgproc.hpp>

#include "virtual_camera/depth_format.hpp"

namespace saccade::virtual_camera {
namespace {

constexpr int kFramesPerSecond = 30;

float fieldOfView(int pixels, double focal_length_px) {
  return focal_length_px > 0 ? static_cast<float>(2.0 * std::atan(0.5 * pixels / focal_length_px)) : 0.0f;
}

}  // namespace

CameraInput::CameraInput(const VirtualCameraRequest& asked) : request(asked) {
  if (request.isFed()) return;
  source = openSensorSource(request.input);
  calibration = source->calibration();
  const PinholeCamera& depth = calibration.depth ? calibration.depth->camera : calibration.color;
  request.color = {calibration.color.width, calibration.color.height};
  request.depth = {depth.width, depth.height};
  request.color_focal = {calibration.color.fx, calibration.color.fy};
  request.depth_focal = {depth.fx, depth.fy};
  request.depth_format = depthFormatFor(calibration);
}

VirtualCamera::VirtualCamera(std::shared_ptr<CameraInput> input, std::function<void()> unplug)
    : input_(std::move(input)), unplug_(std::move(unplug)), recorded_depth_(input_->calibration) {
  formats_ = {formatOf(ONI_SENSOR_COLOR), formatOf(ONI_SENSOR_DEPTH)};
  for (std::size_t i = 0; i < kPlaces; ++i) sensors_[i] = {formats_[i].sensor, 1, &formats_[i].mode};
}

VirtualCamera::~VirtualCamera() {
  onStopped();
}

StreamFormat VirtualCamera::formatOf(OniSensorType sensor) const {
  const bool color = sensor == ONI_SENSOR_COLOR;
  const VirtualCameraRequest& request = input_->request;
  const ImageSize size = color ? request.color : request.depth;
  const FocalLength focal = color ? request.color_focal : request.depth_focal;
  const OniPixelFormat pixels = color ? ONI_PIXEL_FORMAT_RGB888 : request.depth_format;
  return {sensor,
          {pixels, size.width, size.height, kFramesPerSecond},
          fieldOfView(size.width, focal.fx_px),
          fieldOfView(size.height, focal.fy_px)};
}

OniStatus VirtualCamera::getSensorInfoList(OniSensorInfo** sensors, int* count) {
  *sensors = sensors_.data();
  *count = kPlaces;
  return ONI_STATUS_OK;
}

oni::driver::StreamBase* VirtualCamera::createStream(OniSensorType sensor) {
  if (sensor != ONI_SENSOR_COLOR && sensor != ONI_SENSOR_DEPTH) return nullptr;
  const std::lock_guard lock(mutex_);
  auto& place = streams_[sensor == ONI_SENSOR_COLOR ? kColor : kDepth];
  if (place) return nullptr;  // OpenNI2 shares one stream of a kind among those who ask
  place = std::make_unique<VirtualStream>(
      formatOf(sensor), [this] { onStarted(); }, [this] { onStopped(); });
  return place.get();
}

void VirtualCamera::destroyStream(oni::driver::StreamBase* stream) {
  onStopped();
  const std::lock_guard lock(mutex_);
  for (auto& place : streams_) {
    if (place.get() == stream) place.reset();
  }
}

OniStatus VirtualCamera::getProperty(int property, void* data, int* size) {
  if (property == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION) {
    return answer(input_->calibration.depth ? ONI_IMAGE_REGISTRATION_OFF : ONI_IMAGE_REGISTRATION_DEPTH_TO_COLOR, data,
                  size);
  }
  if (property != kCalibrationProperty || input_->request.isFed()) return ONI_STATUS_NOT_SUPPORTED;
  RgbdCalibration sent = input_->calibration;
  sent.depth_units_per_metre = unitsPerMetre(input_->request.depth_format);
  sent.depth_invalid.clear();
  const std::string yaml = calibrationYaml(sent);
  if (static_cast<std::size_t>(*size) < yaml.size()) return ONI_STATUS_BAD_PARAMETER;
  std::memcpy(data, yaml.data(), yaml.size());
  *size = static_cast<int>(yaml.size());
  return ONI_STATUS_OK;
}

OniStatus VirtualCamera::setProperty(int, const void*, int) {
  return ONI_STATUS_NOT_SUPPORTED;
}

OniBool VirtualCamera::isPropertySupported(int property) {
  return property == ONI_DEVICE_PROPERTY_IMAGE_REGISTRATION ||
                 (property == kCalibrationProperty && !input_->request.isFed())
             ? TRUE
             : FALSE;
}

OniBool VirtualCamera::isCommandSupported(int command) {
  return (command == kPushCommand || command == kMarkCommand) && input_->request.isFed() ? TRUE : FALSE;
}

OniStatus VirtualCamera::invoke(int command, void* data, int size) {
  if (!isCommandSupported(command)) return ONI_STATUS_NOT_SUPPORTED;
  if (command == kMarkCommand) {
    const bool noted =
        std::all_of(streams_.begin(), streams_.end(), [](const auto& stream) { return stream && stream->isNoted(); });
    if (!noted) return ONI_STATUS_OUT_OF_FLOW;
    streams_[kColor]->mark(data, size);
    return ONI_STATUS_OK;
  }
  if (size != sizeof(PushedFrame)) return ONI_STATUS_BAD_PARAMETER;
  const auto& frame = *static_cast<const PushedFrame*>(data);
  const int index = static_cast<int>(++input_->sent);
  const VirtualCameraRequest& request = input_->request;
  const auto pixels = [](const ImageSize& image) {
    return static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height);
  };
  const auto stamp_us = static_cast<std::uint64_t>(frame.stamp_us);
  if (streams_[kDepth] && frame.depth != nullptr) {
    streams_[kDepth]->send(frame.depth, pixels(request.depth) * 2, stamp_us, index);
  }
  if (streams_[kColor]) streams_[kColor]->send(frame.rgb, pixels(request.color) * 3, stamp_us, index);
  return ONI_STATUS_OK;
}

void VirtualCamera::onStarted() {
  const std::lock_guard lock(mutex_);
  const bool ready =
      std::all_of(streams_.begin(), streams_.end(), [](const auto& stream) { return !stream || stream->isStarted(); });
  if (!ready || !input_->source || player_.joinable()) return;
  stopping_ = false;
  player_ = std::thread([this] { play(); });
}

void VirtualCamera::onStopped() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  changed_.notify_all();
  if (player_.joinable() && player_.get_id() != std::this_thread::get_id()) player_.join();
}

bool VirtualCamera::waitUntil(std::chrono::steady_clock::time_point due) {
  std::unique_lock lock(mutex_);
  return !changed_.wait_until(lock, due, [this] { return stopping_; });
}

void VirtualCamera::play() {
  using Clock = std::chrono::steady_clock;
  const VirtualCameraRequest& request = input_->request;
  const bool replugged = request.unplug_after && input_->sent >= *request.unplug_after;
  std::optional<double> first_stamp_s;
  // OpenNI2 drops what comes before its own start() has returned, and a real camera takes its time too.
  constexpr std::chrono::milliseconds kWarmUp(100);
  const Clock::time_point start = Clock::now() + kWarmUp;
  SensorFrame frame;
  while (true) {
    if (!replugged && request.unplug_after && input_->sent >= *request.unplug_after) return unplug_();
    const ReadStatus status = input_->source->read(frame);
    if (status == ReadStatus::kEnd) return unplug_();
    if (status == ReadStatus::kSkip) continue;
    if (!first_stamp_s) first_stamp_s = frame.stamp_s;
    const std::chrono::duration<double> since_start((frame.stamp_s - *first_stamp_s) / request.speed);
    if (!waitUntil(start + std::chrono::duration_cast<Clock::duration>(since_start))) return;
    send(frame);
  }
}

void VirtualCamera::send(const SensorFrame& frame) {
  const int index = static_cast<int>(++input_->sent);
  const auto stamp_us = static_cast<std::uint64_t>(stampIn(kMicroseconds, frame.stamp_s));
  if (frame.hasDepth() && streams_[kDepth]) {
    (void)toOpenNi2Depth(recorded_depth_.of(frame), input_->calibration, input_->request.depth_format, depth_);
    streams_[kDepth]->send(depth_[0], depth_.total() * 2, stamp_us, index);
  }
  if (streams_[kColor]) {
    cv::cvtColor(frame.color, rgb_, cv::COLOR_BGR2RGB);
    streams_[kColor]->send(rgb_[0], rgb_.total() * 3, stamp_us, index);
  }
}

}  // namespace saccade::virtual_camera
