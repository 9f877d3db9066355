#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saccade/core/camera.hpp"
#include "saccade/core/distorted_camera.hpp"
#include "saccade/core/frame.hpp"

namespace saccade {

enum class ReadStatus {
  kFrame,  ///< the frame was filled
  kSkip,   ///< this frame is unusable and was counted; its index, name and the reason are known, go on with the next
  kEnd,    ///< no frame is left
};

/// What a source understood about its input; shown to the user before the first frame is processed.
struct SourceDescription {
  std::string kind;               ///< "7-Scenes folder", "MRPT rawlog", "OpenNI2 camera", ...
  std::string location;           ///< path or URI as given
  bool is_live = false;           ///< a camera: frames that are not fetched in time are gone
  std::int64_t frames = 0;        ///< frames that `--range` selected; -1: not known in advance, always so if live
  std::int64_t total_frames = 0;  ///< frames of the whole input, before `--range`; -1: not known in advance
  std::int64_t dropped = 0;       ///< colour images that found no depth partner, and the reverse
  PinholeCamera camera;           ///< the colour camera C; every frame has this size
  DistortedCamera color_camera;   ///< of the input's own colour images, with its lens; frames are free of that
  std::string intrinsics_origin;  ///< where the intrinsics come from, for people
  double depth_units_per_metre = 0.0;
  std::string depth_scale_origin;  ///< why this depth scale
  bool has_depth = false;
  bool depth_was_registered = true;  ///< false: depth is rendered into the colour camera by the source
  bool has_poses = false;
  bool has_labels = false;
  std::optional<int> ignore_from;    ///< label ids from here on are neither objects nor background (`labels.yaml`)
  std::vector<std::string> remarks;  ///< whatever else the user should know, one sentence each
};

/// What happened to a source up to now, beside the frames it gave.
struct SourceProgress {
  std::int64_t dropped = 0;  ///< frames of a live input that came faster than they were fetched
  std::string end_reason;    ///< why there are no more frames, if that is not simply the input's end; one sentence
};

/// A sequence of RGB-D frames, read in order. Not thread-safe; ReadAhead decodes on its own thread.
///
/// Opening a source that cannot work throws IoError; a single bad frame is kSkip.
class FrameSource {
 public:
  virtual ~FrameSource() = default;

  [[nodiscard]] virtual const SourceDescription& description() const = 0;
  /// Reads the next frame into `frame`, reusing its buffers.
  [[nodiscard]] virtual ReadStatus read(RgbdFrame& frame) = 0;
  /// Why the last read() returned kSkip: one sentence with path, expected and found.
  [[nodiscard]] virtual const std::string& skipReason() const = 0;
  /// What happened so far; belongs to the thread that reads.
  [[nodiscard]] virtual SourceProgress progress() const { return {}; }
};

/// Frames selected by `--range A:B:STEP`: indices first, first + step, ... below `end`.
struct FrameRange {
  std::int64_t first = 0;
  std::optional<std::int64_t> end;  ///< exclusive; none: to the end of the input
  std::int64_t step = 1;

  /// Parses "A:B:STEP" with any part left out ("100:", ":50", "::10"). Throws std::invalid_argument with the text.
  [[nodiscard]] static FrameRange parse(const std::string& text);
};

/// Opens any supported input: a folder of frames in one of many layouts or a recording (the kind is detected, see
/// docs/inputs.md), `openni2:` for a camera, or `sim:SCENE`.
///
/// `labels` names a folder of label images kept elsewhere (see LabelFolder); empty: the input's own, if it has any.
/// Throws IoError that says what was looked for and what was found, also where none of the first frames can be used.
[[nodiscard]] std::unique_ptr<FrameSource> openSource(const std::string& input, const FrameRange& range = {},
                                                      const std::filesystem::path& labels = {});

}  // namespace saccade
