#include "saccade/session/session_snapshot.hpp"

#include "session/session_database.hpp"

namespace saccade {

SessionSnapshot::SessionSnapshot(const SessionReader& session) : session_(session) {
  const SessionDatabase& database = session.database();
  database.use("a whole Saccade session", [&] {
    database.sqlite().exec("BEGIN");
    (void)database.sqlite().execAndGet("SELECT count(*) FROM main.meta");  // the first read chooses the moment
  });
}

SessionSnapshot::~SessionSnapshot() {
  (void)session_.database().sqlite().tryExec("ROLLBACK");
}

}  // namespace saccade
