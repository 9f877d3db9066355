#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include <opencv2/core.hpp>

#include "saccade/map/attend_log.hpp"
#include "saccade/map/ior_map.hpp"
#include "saccade/session/session_reader.hpp"

namespace saccade {

/// A frame that a page shows, without lens distortion.
struct ReportView {
  FrameRecord frame;
  Pose T_WC = Pose::Identity();
  cv::Mat3b color;
  cv::Mat1f depth_m;      ///< 0 where there is none
  bool rendered = false;  ///< from the map, as the session keeps no image of it
};

/// At most `most` frames, evenly chosen from the key frames that have their images, or, where there are none, from all
/// frames with a pose.
[[nodiscard]] std::vector<ReportView> chooseViews(const SessionReader& session, const std::vector<FrameRecord>& frames,
                                                  const IorMap& map, std::size_t most);

/// Positions of `most` of `count` things, evenly spread, the first among them; all if there are no more.
[[nodiscard]] std::vector<std::size_t> evenlyChosen(std::size_t count, std::size_t most);

/// Leaves as squares on a view's image.
struct ProjectedLeaves {
  cv::Rect box;             ///< around those within the image; empty if none is
  std::size_t visible = 0;  ///< within the image and not behind what the view measured
};

/// Calls nothing else than the camera: leaves behind the camera or outside the image are left out. `mask`, of the
/// image's size, gets 255 where a visible leaf lies, unless null.
[[nodiscard]] ProjectedLeaves projectLeaves(std::span<const LeafKey> leaves, const IorMap& map,
                                            const PinholeCamera& camera, const ReportView& view,
                                            cv::Mat1b* mask = nullptr);

/// The view with what attention chose in its frame: the attended leaves tinted, around each candidate a box with its
/// rank, from yellow for the best to blue for the last.
[[nodiscard]] cv::Mat3b drawLooks(const ReportView& view, const AttendLog& log, const IorMap& map,
                                  const PinholeCamera& camera);

}  // namespace saccade
