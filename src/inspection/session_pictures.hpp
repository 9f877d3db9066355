#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>

#include <Eigen/Geometry>
#include <opencv2/core.hpp>

#include "inspection/open_session.hpp"
#include "saccade/rendering/renderer.hpp"

namespace saccade {

/// Pictures of a session's frames for the page: keyframes, and the map from the frames' poses. Holds the part of the
/// map around the last camera. Not thread-safe.
class SessionPictures {
 public:
  /// State of a leaf at the tick that a picture is of.
  using StateOf = std::function<IorState(LeafKey)>;

  /// `session` must outlive it.
  explicit SessionPictures(const OpenSession& session);

  /// The keyframe's image; empty if the frame is none or its image was thinned away.
  [[nodiscard]] cv::Mat3b color(std::int64_t ordinal) const;
  /// Saliency of such an image as grey values.
  [[nodiscard]] cv::Mat3b saliency(const cv::Mat3b& color) const;
  /// The map in its own colours from `T_WC`.
  [[nodiscard]] cv::Mat3b map(const Pose& T_WC);
  /// The 2D IOR map from `T_WC` at `tick`, whose memory `state_of` knows.
  [[nodiscard]] cv::Mat3b ior(const Pose& T_WC, Tick tick, const StateOf& state_of);
  /// See SessionView::lastSeen().
  [[nodiscard]] std::string lastSeen();
  /// The part of `picture`, taken from `T_WC`, that shows the box, with a margin; empty if it lies outside.
  [[nodiscard]] cv::Mat3b cut(const cv::Mat3b& picture, const Pose& T_WC, const Eigen::AlignedBox3d& box_W) const;

 private:
  const IorMap& mapAround(const Eigen::Vector3d& centre_W);

  const OpenSession& session_;
  Renderer renderer_;
  std::optional<IorMap> around_;  ///< the part of the map near `around_W_`
  Eigen::Vector3d around_W_ = Eigen::Vector3d::Zero();
};

/// The pixels of `camera` at `T_WC` that leaves cover; empty if none is in the picture.
[[nodiscard]] cv::Rect seenBox(std::span<const LeafKey> leaves, double leaf_size_m, const PinholeCamera& camera,
                               const Pose& T_WC);

/// As JPEG bytes.
[[nodiscard]] std::string jpegOf(const cv::Mat3b& picture);

}  // namespace saccade
