#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saccade/sources/sensor_source.hpp"

namespace saccade {

/// What a recording can be written as.
enum class RecordingKind { kTumFolder, kSevenScenesFolder, kRawlog, kBag, kOni };

/// The kind that a name asks for: by its extension `.rawlog`, `.bag` or `.oni`, else a folder, of the layout
/// `folder_layout` ("tum" or "7scenes"). Throws std::invalid_argument on another layout.
[[nodiscard]] RecordingKind recordingKindOf(const std::filesystem::path& output, const std::string& folder_layout);

/// Writes the frames of a sensor, images as they came, with the calibration that reading them takes.
///
/// A recording that ends before finish() is never passed off as whole: files get their name in finish() only (until
/// then they are `NAME.partial`), a folder's lists name only images that were written in full. Folders keep stamps as
/// they are, bags to 1 ns, rawlogs to 100 ns, .oni to 1 us, which is what exploring takes. Every function throws
/// IoError where something cannot be written, a full disk included.
class RecordingWriter {
 public:
  virtual ~RecordingWriter() = default;

  virtual void write(const SensorFrame& frame) = 0;
  virtual void finish() = 0;
  /// What this kind of recording could not keep of the frames so far, one sentence each; empty: nothing was lost.
  [[nodiscard]] virtual std::vector<std::string> losses() const = 0;
};

enum class WhenRecordingExists { kRefuse, kReplace };

/// Opens a recording of what `source` gives. Throws IoError where one exists, where nothing can be written, and where
/// this build lacks the library of that kind, naming the Debian package.
[[nodiscard]] std::unique_ptr<RecordingWriter> openRecording(const std::filesystem::path& output, RecordingKind kind,
                                                             const SensorSource& source, WhenRecordingExists when);

}  // namespace saccade
