#pragma once

#include <vector>

#include <opencv2/core.hpp>

#include "reporting/report_views.hpp"
#include "saccade/objects/object_history.hpp"
#include "saccade/objects/object_memory.hpp"

namespace saccade {

/// An object as a page shows it.
struct ReportObject {
  AttendedObject object;
  ObjectHistory history;
  Eigen::AlignedBox3d box_W;  ///< empty where nothing of it is left
  cv::Mat3b crop;             ///< from the view that shows most of it; empty where none does
};

/// The objects with a crop each, at most `most` of them: those that were looked at most often, in that order.
[[nodiscard]] std::vector<ReportObject> describeObjects(const std::vector<AttendedObject>& objects,
                                                        const AttendLog& log, const IorMap& map,
                                                        const PinholeCamera& camera,
                                                        const std::vector<ReportView>& views, std::size_t most);

}  // namespace saccade
