#include <chrono>
#include <condition_variable>
#include <cstdlib>
#include <cstring>
#include <map>
#include <mutex>
#include <thread>

#include "virtual_camera/virtual_camera.hpp"

namespace saccade::virtual_camera {
namespace {

/// Names the camera that is plugged in when OpenNI2 starts: an input, which may be followed by `#key=value&...`.
constexpr const char* kEnvironmentVariable = "SACCADE_VIRTUAL_CAMERA";

OniDeviceInfo infoOf(const std::string& uri) {
  OniDeviceInfo info{};
  std::strncpy(info.uri, uri.c_str(), sizeof info.uri - 1);
  std::strncpy(info.vendor, "Saccade", sizeof info.vendor - 1);
  std::strncpy(info.name, "virtual camera", sizeof info.name - 1);
  return info;
}

}  // namespace

/// The OpenNI2 driver: knows the cameras that were asked for, and plugs and unplugs them.
class VirtualCameraDriver final : public oni::driver::DriverBase {
 public:
  explicit VirtualCameraDriver(OniDriverServices* services) : DriverBase(services) {}
  ~VirtualCameraDriver() override { joinReplugging(); }

  OniStatus initialize(oni::driver::DeviceConnectedCallback connected,
                       oni::driver::DeviceDisconnectedCallback disconnected,
                       oni::driver::DeviceStateChangedCallback state_changed, void* cookie) override {
    const OniStatus status = DriverBase::initialize(connected, disconnected, state_changed, cookie);
    if (status != ONI_STATUS_OK) return status;
    const char* named = std::getenv(kEnvironmentVariable);
    // A camera that cannot be opened is not there; its error is told to who opens it.
    if (named != nullptr && *named != '\0') (void)tryDevice((std::string(kUriPrefix) + named).c_str());
    return ONI_STATUS_OK;
  }

  OniStatus tryDevice(const char* uri) override {
    const std::optional<VirtualCameraRequest> request = VirtualCameraRequest::parse(uri);
    if (!request) return ONI_STATUS_ERROR;
    try {
      inputs_[uri] = std::make_shared<CameraInput>(*request);
    } catch (const std::exception& error) {
      getServices().errorLoggerAppend("%s", error.what());
      return ONI_STATUS_ERROR;
    }
    const OniDeviceInfo info = infoOf(uri);
    deviceConnected(&info);
    return ONI_STATUS_OK;
  }

  oni::driver::DeviceBase* deviceOpen(const char* uri, const char*) override {
    const auto input = inputs_.find(uri);
    if (input == inputs_.end()) return nullptr;
    return new VirtualCamera(input->second, [this, input = input->second] { unplug(*input); });
  }
  void deviceClose(oni::driver::DeviceBase* device) override { delete device; }

  void shutdown() override { joinReplugging(); }

 private:
  /// Called by the thread that plays the camera's input.
  void unplug(const CameraInput& input) {
    const OniDeviceInfo info = infoOf(input.request.uri);
    deviceDisconnected(&info);
    const bool at_end = !input.request.unplug_after || input.sent > *input.request.unplug_after;
    if (at_end || !input.request.replug_after_s) return;
    const std::chrono::duration<double> pause(*input.request.replug_after_s);
    joinReplugging();
    const std::lock_guard lock(mutex_);
    stopping_ = false;
    replugging_ = std::thread([this, info, pause] {
      std::unique_lock waiting(mutex_);
      if (changed_.wait_for(waiting, pause, [this] { return stopping_; })) return;
      waiting.unlock();
      deviceConnected(&info);
    });
  }

  void joinReplugging() {
    {
      const std::lock_guard lock(mutex_);
      stopping_ = true;
    }
    changed_.notify_all();
    if (replugging_.joinable()) replugging_.join();
  }

  std::map<std::string, std::shared_ptr<CameraInput>> inputs_;
  std::mutex mutex_;
  std::condition_variable changed_;
  bool stopping_ = false;
  std::thread replugging_;
};

}  // namespace saccade::virtual_camera

// The macro of OniDriverAPI.h wants these two of OpenNI2's own base library.
#define XN_NEW(type, ...) new type(__VA_ARGS__)
#define XN_DELETE(pointer) delete (pointer)
using saccade::virtual_camera::VirtualCameraDriver;
ONI_EXPORT_DRIVER(VirtualCameraDriver)
