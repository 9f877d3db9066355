#pragma once

#include <Driver/OniDriverAPI.h>
#include <OniPlatform.h>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>

namespace saccade::virtual_camera {

/// What a stream of a virtual camera shows.
struct StreamFormat {
  OniSensorType sensor = ONI_SENSOR_COLOR;
  OniVideoMode mode{};
  float horizontal_fov_rad = 0.0f;
  float vertical_fov_rad = 0.0f;
};

/// One stream of a virtual camera: one format, no cropping, no mirroring. Frames are handed to it while it is started.
class VirtualStream final : public oni::driver::StreamBase {
 public:
  /// `started` is called when OpenNI2 starts the stream, `stopped` when it stops it.
  VirtualStream(const StreamFormat& format, std::function<void()> started, std::function<void()> stopped);

  [[nodiscard]] bool isStarted() const { return is_started_; }
  [[nodiscard]] OniSensorType sensor() const { return format_.sensor; }
  /// Copies pixels without gaps between rows into a frame and hands it to OpenNI2.
  void send(const void* pixels, std::size_t bytes, std::uint64_t stamp_us, int frame_index);

  /// Whether a recorder's thread has taken note of the stream's properties. Until it has, it holds a lock of its own
  /// and waits for one of the stream's; a property that is raised meanwhile takes them the other way round, for good.
  [[nodiscard]] bool isNoted() const { return is_noted_; }
  /// Hands a recorder some bytes, as the value of a property that nothing else uses. Not before isNoted().
  void mark(const void* bytes, int size);

  OniStatus start() override;
  void stop() override;
  OniStatus getProperty(int property, void* data, int* size) override;
  OniStatus setProperty(int property, const void* data, int size) override;
  OniBool isPropertySupported(int property) override;
  void notifyAllProperties() override;

 private:
  [[nodiscard]] int strideInBytes() const;

  StreamFormat format_;
  std::function<void()> started_, stopped_;
  bool is_started_ = false;
  std::atomic<bool> is_noted_ = false;
};

/// Puts a value where OpenNI2 asks for a property.
template <typename T>
[[nodiscard]] OniStatus answer(const T& value, void* data, int* size) {
  if (*size < static_cast<int>(sizeof(T))) return ONI_STATUS_BAD_PARAMETER;
  *static_cast<T*>(data) = value;
  *size = static_cast<int>(sizeof(T));
  return ONI_STATUS_OK;
}

}  // namespace saccade::virtual_camera
