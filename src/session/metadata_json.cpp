#include "session/metadata_json.hpp"

#include <nlohmann/json.hpp>

#include "saccade/core/errors.hpp"

namespace saccade {

NLOHMANN_JSON_SERIALIZE_ENUM(SessionState, {{SessionState::kExploring, "exploring"},
                                            {SessionState::kComplete, "complete"},
                                            {SessionState::kInterrupted, "interrupted"}})

namespace {

/// Visits every field once, for writing and reading alike: `visit(key, field)`.
template <typename Metadata, typename Visit>
void visitFields(Metadata& metadata, const Visit& visit) {
  visit("saccade_version", metadata.saccade_version);
  visit("created_utc", metadata.created_utc);
  visit("input", metadata.input);
  visit("input_kind", metadata.input_kind);
  visit("config", metadata.config_yaml);
  visit("camera_width", metadata.camera.width);
  visit("camera_height", metadata.camera.height);
  visit("camera_fx", metadata.camera.fx);
  visit("camera_fy", metadata.camera.fy);
  visit("camera_cx", metadata.camera.cx);
  visit("camera_cy", metadata.camera.cy);
  visit("leaf_size_m", metadata.leaf_size_m);
  visit("tick", metadata.tick);
  visit("leaves", metadata.leaves);
  visit("frames_read", metadata.frames_read);
  visit("frames_skipped", metadata.frames_skipped);
  visit("state", metadata.state);
  visit("range_step", metadata.range_step);
}

}  // namespace

const char* nameOf(SessionState state) {
  switch (state) {
    case SessionState::kExploring:
      return "exploring";
    case SessionState::kComplete:
      return "complete";
    case SessionState::kInterrupted:
      return "interrupted";
  }
  return "";
}

std::map<std::string, std::string> metadataToText(const SessionMetadata& metadata) {
  std::map<std::string, std::string> rows;
  visitFields(metadata, [&](const char* key, const auto& field) { rows[key] = nlohmann::json(field).dump(); });
  return rows;
}

SessionMetadata metadataFromText(const std::map<std::string, std::string>& rows, const std::filesystem::path& path) {
  SessionMetadata metadata;
  visitFields(metadata, [&](const char* key, auto& field) {
    const auto row = rows.find(key);
    if (row == rows.end()) throw IoError(path, std::string("the session's \"") + key + "\"", "none");
    try {
      nlohmann::json::parse(row->second).get_to(field);
    } catch (const nlohmann::json::exception&) {
      throw IoError(path, std::string("a usable \"") + key + "\" in the session", "\"" + row->second + "\"");
    }
  });
  return metadata;
}

}  // namespace saccade
