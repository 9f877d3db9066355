#pragma once

#include <array>
#include <atomic>
#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <thread>

#include "saccade/sources/sensor_source.hpp"
#include "sources/recorders.hpp"
#include "virtual_camera/virtual_camera_protocol.hpp"
#include "virtual_camera/virtual_camera_request.hpp"
#include "virtual_camera/virtual_stream.hpp"

namespace saccade::virtual_camera {

/// The input behind a virtual camera. It lives as long as the driver, so that a camera that was unplugged goes on where
/// it was.
struct CameraInput {
  explicit CameraInput(const VirtualCameraRequest& asked);  ///< throws IoError where the input cannot be opened

  VirtualCameraRequest request;
  std::unique_ptr<SensorSource> source;  ///< none: the camera is fed
  RgbdCalibration calibration;
  std::int64_t sent = 0;
};

/// A virtual camera that OpenNI2 has opened: plays its input at its own pace once all of its streams are started, or
/// sends what it is fed. Reports the end of the input, and the frame to be unplugged at, through `unplug`.
class VirtualCamera final : public oni::driver::DeviceBase {
 public:
  VirtualCamera(std::shared_ptr<CameraInput> input, std::function<void()> unplug);
  ~VirtualCamera() override;

  OniStatus getSensorInfoList(OniSensorInfo** sensors, int* count) override;
  oni::driver::StreamBase* createStream(OniSensorType sensor) override;
  void destroyStream(oni::driver::StreamBase* stream) override;
  OniStatus getProperty(int property, void* data, int* size) override;
  OniStatus setProperty(int property, const void* data, int size) override;
  OniBool isPropertySupported(int property) override;
  OniStatus invoke(int command, void* data, int size) override;
  OniBool isCommandSupported(int command) override;

 private:
  enum Place { kColor, kDepth, kPlaces };

  [[nodiscard]] StreamFormat formatOf(OniSensorType sensor) const;
  void onStarted();
  void onStopped();
  void play();
  [[nodiscard]] bool waitUntil(std::chrono::steady_clock::time_point due);
  void send(const SensorFrame& frame);

  std::shared_ptr<CameraInput> input_;
  std::function<void()> unplug_;
  std::array<StreamFormat, kPlaces> formats_;
  std::array<OniSensorInfo, kPlaces> sensors_{};
  std::array<std::unique_ptr<VirtualStream>, kPlaces> streams_;
  RecordedDepth recorded_depth_;
  cv::Mat3b rgb_;
  cv::Mat1w depth_;

  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::thread player_;
};

}  // namespace saccade::virtual_camera
