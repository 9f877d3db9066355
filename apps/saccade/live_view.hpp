#pragma once

#include <chrono>
#include <filesystem>
#include <memory>
#include <optional>
#include <sys/types.h>

#include "saccade/inspection/session_view.hpp"
#include "saccade/inspection/view_server.hpp"

namespace saccade::app {

/// The page of `saccade view` on a session that this program is exploring: it follows from checkpoint to checkpoint.
class LiveView {
 public:
  /// `going_on`: the session exists already; else what lies at `session` now is not it. Throws IoError if this program
  /// was built without the page.
  LiveView(std::filesystem::path session, bool going_on);

  /// To be called after each frame: serves, and prints the address on stderr, as soon as there is a first checkpoint.
  void serveIfReady();
  /// Takes the session's file out of the page's hands, for the writer's end; null if nothing is served yet.
  [[nodiscard]] std::unique_ptr<SessionView::Pause> pause();
  /// Goes on serving what was explored until Ctrl-C.
  void waitForInterrupt();

 private:
  std::filesystem::path session_;
  std::vector<PageFile> page_;
  ino_t replaced_ = 0;  ///< the file that the session takes the place of
  std::chrono::steady_clock::time_point next_look_;
  std::optional<SessionView> view_;
  std::optional<ViewServer> server_;
};

}  // namespace saccade::app
