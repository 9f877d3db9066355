#pragma once

#include "saccade/session/session_reader.hpp"

namespace saccade {

/// While it lives, all that `session` reads is of one moment, though a writer goes on: map, frames and attend log fit
/// together. The writer is not held up; its write-ahead log cannot be cut short until then, so keep it for as long as
/// one answer takes. Not for a session that has a snapshot already.
class SessionSnapshot {
 public:
  /// Throws IoError if the session cannot be read.
  explicit SessionSnapshot(const SessionReader& session);
  ~SessionSnapshot();
  SessionSnapshot(const SessionSnapshot&) = delete;
  SessionSnapshot& operator=(const SessionSnapshot&) = delete;

 private:
  const SessionReader& session_;
};

}  // namespace saccade
