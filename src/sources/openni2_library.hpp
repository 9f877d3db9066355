#pragma once

#include <OpenNI.h>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include "saccade/sources/camera_calibration.hpp"
#include "sources/lasting_thread.hpp"

namespace saccade {

/// OpenNI2 while somebody needs it: the first of these starts it, the last one shuts it down.
class OpenNi2Library {
 public:
  /// Throws IoError, with `what` in the place of a path, if OpenNI2 does not start.
  explicit OpenNi2Library(const std::string& what);
  ~OpenNi2Library();
  OpenNi2Library(const OpenNi2Library&) = delete;
  OpenNi2Library& operator=(const OpenNi2Library&) = delete;
};

/// What OpenNI2 said about its last failure, on one line.
[[nodiscard]] std::string openNi2Error();

/// The colour and depth stream of one device, opened together.
struct OpenNi2Streams {
  openni::Device device;
  openni::VideoStream color, depth;

  ~OpenNi2Streams() { close(); }
  OpenNi2Streams() = default;
  OpenNi2Streams(const OpenNi2Streams&) = delete;
  OpenNi2Streams& operator=(const OpenNi2Streams&) = delete;

  /// Opens the device (`uri` null: the first) and both streams, does not start them. Throws IoError.
  void open(const char* uri, const std::string& what);
  void close();
  /// Waits until one of `waiting` has a frame, and says which. STATUS_TIME_OUT after `longest_wait`.
  [[nodiscard]] openni::Status awaitFrame(std::vector<openni::VideoStream*> waiting,
                                          std::chrono::milliseconds longest_wait, std::size_t& ready);
  /// Reads a frame that is known to be there.
  [[nodiscard]] openni::Status readFrame(openni::VideoStream& stream, openni::VideoFrameRef& frame);

 private:
  LastingThread waiting_;
  bool has_played_ = false;
};

/// Units per metre of a depth stream's pixels. Throws IoError if they are no measure of depth.
[[nodiscard]] double depthUnitsPerMetre(const openni::VideoStream& depth, const std::string& what);

/// The calibration of a device: what its driver tells in full (the virtual camera does), else what follows from the
/// fields of view. A remark says what had to be assumed. Throws IoError if there is nothing to go by.
[[nodiscard]] RgbdCalibration calibrationOf(const OpenNi2Streams& streams, const std::string& what,
                                            std::vector<std::string>& remarks);

/// Whether the first frame that a device ever sends has the number 1, as the virtual camera's has.
[[nodiscard]] bool numbersFromOne(const openni::Device& device);

/// Pixels of a frame, without gaps between rows, as OpenCV has them.
void copyColor(const openni::VideoFrameRef& frame, cv::Mat3b& bgr);
void copyDepth(const openni::VideoFrameRef& frame, cv::Mat1w& raw);

}  // namespace saccade
