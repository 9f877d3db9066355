#include "virtual_camera/virtual_stream.hpp"

#include <PS1080.h>
#include <algorithm>
#include <cstring>
#include <utility>

namespace saccade::virtual_camera {
namespace {

constexpr int kLargestDepth = 65535;

}  // namespace

VirtualStream::VirtualStream(const StreamFormat& format, std::function<void()> started, std::function<void()> stopped)
    : format_(format), started_(std::move(started)), stopped_(std::move(stopped)) {}

void VirtualStream::send(const void* pixels, std::size_t bytes, std::uint64_t stamp_us, int frame_index) {
  OniFrame* frame = getServices().acquireFrame();
  if (frame == nullptr) return;
  const std::size_t fitting = std::min(bytes, static_cast<std::size_t>(frame->dataSize));
  std::memcpy(frame->data, pixels, fitting);
  frame->dataSize = static_cast<int>(fitting);
  frame->sensorType = format_.sensor;
  frame->videoMode = format_.mode;
  frame->width = format_.mode.resolutionX;
  frame->height = format_.mode.resolutionY;
  frame->stride = strideInBytes();
  frame->croppingEnabled = FALSE;
  frame->cropOriginX = frame->cropOriginY = 0;
  frame->timestamp = stamp_us;
  frame->frameIndex = frame_index;
  raiseNewFrame(frame);
  getServices().releaseFrame(frame);
}

void VirtualStream::mark(const void* bytes, int size) {
  // Recorders know the properties of real cameras only; this one of the PS1080 may hold any bytes, and no player cares.
  raisePropertyChanged(XN_STREAM_PROPERTY_AGC_BIN, bytes, size);
}

int VirtualStream::strideInBytes() const {
  constexpr int kColorBytes = 3, kDepthBytes = 2;
  return format_.mode.resolutionX * (format_.sensor == ONI_SENSOR_COLOR ? kColorBytes : kDepthBytes);
}

OniStatus VirtualStream::start() {
  is_started_ = true;
  started_();
  return ONI_STATUS_OK;
}

void VirtualStream::stop() {
  is_started_ = false;
  stopped_();
}

OniStatus VirtualStream::getProperty(int property, void* data, int* size) {
  switch (property) {
    case ONI_STREAM_PROPERTY_VIDEO_MODE:
      return answer(format_.mode, data, size);
    case ONI_STREAM_PROPERTY_HORIZONTAL_FOV:
      return answer(format_.horizontal_fov_rad, data, size);
    case ONI_STREAM_PROPERTY_VERTICAL_FOV:
      return answer(format_.vertical_fov_rad, data, size);
    case ONI_STREAM_PROPERTY_STRIDE:
      return answer(strideInBytes(), data, size);
    case ONI_STREAM_PROPERTY_CROPPING:
      return answer(OniCropping{FALSE, 0, 0, format_.mode.resolutionX, format_.mode.resolutionY}, data, size);
    case ONI_STREAM_PROPERTY_MIRRORING:
      return answer(static_cast<OniBool>(FALSE), data, size);
    case ONI_STREAM_PROPERTY_MAX_VALUE:
      return answer(kLargestDepth, data, size);
    default:
      return ONI_STATUS_NOT_SUPPORTED;
  }
}

OniStatus VirtualStream::setProperty(int property, const void* data, int size) {
  if (property == ONI_STREAM_PROPERTY_MIRRORING && size == sizeof(OniBool)) {
    return *static_cast<const OniBool*>(data) == FALSE ? ONI_STATUS_OK : ONI_STATUS_NOT_SUPPORTED;
  }
  if (property != ONI_STREAM_PROPERTY_VIDEO_MODE || size != sizeof(OniVideoMode)) return ONI_STATUS_NOT_SUPPORTED;
  const auto& mode = *static_cast<const OniVideoMode*>(data);
  const bool same = mode.pixelFormat == format_.mode.pixelFormat && mode.resolutionX == format_.mode.resolutionX &&
                    mode.resolutionY == format_.mode.resolutionY && mode.fps == format_.mode.fps;
  return same ? ONI_STATUS_OK : ONI_STATUS_NOT_SUPPORTED;
}

// Without stride and cropping OpenNI2's player gives no frame of a recording.
OniBool VirtualStream::isPropertySupported(int property) {
  return property == ONI_STREAM_PROPERTY_STRIDE || property == ONI_STREAM_PROPERTY_CROPPING ||
                 property == ONI_STREAM_PROPERTY_VIDEO_MODE || property == ONI_STREAM_PROPERTY_HORIZONTAL_FOV ||
                 property == ONI_STREAM_PROPERTY_VERTICAL_FOV || property == ONI_STREAM_PROPERTY_MIRRORING ||
                 (property == ONI_STREAM_PROPERTY_MAX_VALUE && format_.sensor == ONI_SENSOR_DEPTH)
             ? TRUE
             : FALSE;
}

void VirtualStream::notifyAllProperties() {
  raisePropertyChanged(ONI_STREAM_PROPERTY_VIDEO_MODE, &format_.mode, sizeof format_.mode);
  raisePropertyChanged(ONI_STREAM_PROPERTY_HORIZONTAL_FOV, &format_.horizontal_fov_rad, sizeof(float));
  raisePropertyChanged(ONI_STREAM_PROPERTY_VERTICAL_FOV, &format_.vertical_fov_rad, sizeof(float));
  is_noted_ = true;
}

}  // namespace saccade::virtual_camera
