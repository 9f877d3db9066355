#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "saccade/map/ior_map.hpp"
#include "saccade/objects/object_memory.hpp"
#include "saccade/session/session_reader.hpp"

/// Editing the attention memory by hand: what is forgotten is looked at again.
namespace saccade {

/// Which leaves of a map are to be forgotten; a coarse leaf is taken whole or not at all.
class ForgetSelection {
 public:
  [[nodiscard]] static ForgetSelection everything();
  /// Leaves whose centre lies in the box, in W, metres.
  [[nodiscard]] static ForgetSelection box(const Eigen::AlignedBox3d& box_W);
  /// Leaves that share a block with the object.
  [[nodiscard]] static ForgetSelection object(const AttendedObject& object);

  [[nodiscard]] bool contains(const MapLeaf& leaf, double leaf_size_m) const { return contains_(leaf, leaf_size_m); }
  /// For people and for the session's record.
  [[nodiscard]] const std::string& description() const { return description_; }

 private:
  using Contains = std::function<bool(const MapLeaf&, double)>;
  ForgetSelection(Contains contains, std::string description)
      : contains_(std::move(contains)), description_(std::move(description)) {}

  Contains contains_;
  std::string description_;
};

/// Clears the attention memory of the selected leaves and returns those that had any: to whoever explores on, they were
/// never attended.
std::vector<NodeKey> forgetAttention(IorMap& map, const ForgetSelection& selection);

/// One forgetting by hand, as the session records it.
struct ForgettingRecord {
  Tick tick;         ///< of the session when it was done
  std::string when;  ///< ISO 8601, UTC
  std::string what;
  std::int64_t leaves = 0;
};

/// Forgets in a session file and records it there: one transaction, so that the file is as before or wholly edited.
/// Only tiles that change are written. Throws IoError if another program is writing to the session.
ForgettingRecord forgetInSession(const std::filesystem::path& path, const ForgetSelection& selection,
                                 const std::string& utc);

/// The forgettings that were done to a session, oldest first.
[[nodiscard]] std::vector<ForgettingRecord> listForgettings(const SessionReader& session);

}  // namespace saccade
