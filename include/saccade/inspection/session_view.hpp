#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "saccade/map/ior_law.hpp"
#include "saccade/map/leaf_key.hpp"

namespace saccade {

/// A picture that the page asks for of a frame.
enum class ViewPicture {
  kColor,     ///< the keyframe's own image
  kSaliency,  ///< of that image, by the session's settings
  kMap,       ///< the map from the frame's pose
  kIor,       ///< the 2D IOR map that the frame met: the map from its pose with the attention memory of that tick
};

/// A session as the page of `saccade view` asks for it; one that is still being explored is followed.
///
/// Answers are whole values; the JSON texts are those that apps/viewer/src/protocol.ts declares. Memory stays bounded
/// whatever the map's size: tiles are read when they are asked for, of the voxels made of them 64 MiB are kept;
/// pictures read the part of the map around the camera. Only the attend log and the states of AttentionReplay, read at
/// the first question about attention, grow with the exploration, and difference() holds both maps while it compares
/// them.
///
/// Thread rule: any number of threads may ask at once. All questions throw IoError where the session is damaged.
class SessionView {
 public:
  /// Opens the session, and a `before` of the same world frame and leaf size to compare it with. Throws IoError as
  /// SessionReader does, and for leaves of different sizes.
  explicit SessionView(const std::filesystem::path& path,
                       const std::optional<std::filesystem::path>& before = std::nullopt);
  ~SessionView();
  SessionView(const SessionView&) = delete;
  SessionView& operator=(const SessionView&) = delete;

  /// JSON object: what is looked at, camera, leaf size, tick, whether it is live, the keyframes, the way up.
  [[nodiscard]] std::string summary();
  /// JSON object of columns over all frames, in the order of processing.
  [[nodiscard]] std::string frames();
  /// JSON array of the attended candidates of the `ordinal`-th frame. Their boxes are those of the leaves they
  /// attended, seen by the session's camera, and so without the input's lens distortion; where none is in the picture,
  /// the input's own.
  [[nodiscard]] std::string candidates(std::int64_t ordinal);
  /// JSON array of the objects that were looked at more than once, each with its looks and how much of it is inhibited
  /// at `tick`, until when.
  [[nodiscard]] std::string objects(Tick tick);
  /// JSON array: each tile's root and a number that changes with its content.
  [[nodiscard]] std::string tileList();
  /// Roots of the tiles that hold the map.
  [[nodiscard]] std::vector<NodeKey> tiles();
  /// encodeVoxels() of a tile; a tile that is not there has no voxels.
  [[nodiscard]] std::shared_ptr<const std::string> voxels(const NodeKey& root, int voxel_depth);
  /// AttentionReplay::encode() at `tick`.
  [[nodiscard]] std::string attention(Tick tick);
  /// When each block of 4×4×4 leaves was last in view, as bytes like those of attention(): entries with the Morton
  /// code of the block's first leaf (bits 0-17) and the share of the frames before it (18-31: 0 the first frame, 16383
  /// the last).
  [[nodiscard]] std::string lastSeen();
  /// Leaves that differ from `before`, as bytes like those of attention(): entries with a Morton code (bits 0-17) and
  /// what became of the leaf (18-19: 1 appeared, 2 gone, 3 gained attention). Empty without a `before`.
  [[nodiscard]] std::string difference();
  /// JSON object: all that is known of the leaf at `key`; "null" where the map is unknown.
  [[nodiscard]] std::string leaf(LeafKey key);
  /// A picture (JPEG) of the `ordinal`-th frame; none where there is none: images belong to keyframes alone.
  [[nodiscard]] std::optional<std::string> picture(std::int64_t ordinal, ViewPicture layer);
  /// A picture (JPEG) of the object: out of the keyframe that saw most of it, else out of the map; none where it has
  /// no such number.
  [[nodiscard]] std::optional<std::string> crop(int object);

  /// Waits up to `timeout_ms` until the session has another version than `version`, and returns its version.
  [[nodiscard]] std::uint64_t waitForChange(std::uint64_t version, int timeout_ms);

  /// While it lives, the session's file is not open here and questions wait: a writer that ends meanwhile leaves one
  /// file.
  class Pause;
  [[nodiscard]] std::unique_ptr<Pause> pause();

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

class SessionView::Pause {
 public:
  explicit Pause(SessionView& view);
  ~Pause();
  Pause(const Pause&) = delete;
  Pause& operator=(const Pause&) = delete;

 private:
  Parts& parts_;
};

}  // namespace saccade
