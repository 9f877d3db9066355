// What users are told where this build lacks the library of a kind of recording.
#include "saccade/core/errors.hpp"
#include "sources/recorders.hpp"
#include "sources/recording_files.hpp"

namespace saccade {
namespace {

[[noreturn]] [[maybe_unused]] void refuse(const std::filesystem::path& path, const char* library, const char* package) {
  throw IoError(
      path,
      std::string("a Saccade built with ") + library + " (install the Debian package " + package + " and build again)",
      "one built without");
}

}  // namespace

#if !SACCADE_WITH_MRPT
std::unique_ptr<SensorSource> openRawlog(const std::filesystem::path& file, const FrameRange&) {
  refuse(file, "MRPT", "libmrpt-obs-dev");
}
std::unique_ptr<RecordingWriter> makeRawlogRecorder(const std::filesystem::path& file, const RgbdCalibration&) {
  refuse(file, "MRPT", "libmrpt-obs-dev");
}
#endif

#if !SACCADE_WITH_ROSBAG
std::unique_ptr<SensorSource> openBag(const std::filesystem::path& file, const FrameRange&) {
  refuse(file, "rosbag", "librosbag-storage-dev");
}
std::unique_ptr<RecordingWriter> makeBagRecorder(const std::filesystem::path& file, const RgbdCalibration&) {
  refuse(file, "rosbag", "librosbag-storage-dev");
}
#endif

#if !SACCADE_WITH_OPENNI2
std::unique_ptr<SensorSource> openOni(const std::filesystem::path& file, const FrameRange&) {
  refuse(file, "OpenNI2", "libopenni2-dev");
}
std::unique_ptr<SensorSource> openOpenNi2(const std::string& uri, const FrameRange&) {
  refuse("openni2:" + uri, "OpenNI2", "libopenni2-dev");
}
std::unique_ptr<RecordingWriter> makeOniRecorder(const std::filesystem::path& file, const RgbdCalibration&) {
  refuse(file, "OpenNI2", "libopenni2-dev");
}
#endif

}  // namespace saccade
