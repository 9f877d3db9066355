#include "live_view.hpp"

#include <iostream>
#include <sys/stat.h>
#include <thread>
#include <utility>

#include "terminal.hpp"
#include "view_page.hpp"

namespace saccade::app {
namespace {

constexpr auto kLookInterval = std::chrono::milliseconds(250);

/// Which file has that name; 0 for none.
ino_t fileAt(const std::filesystem::path& path) {
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 ? status.st_ino : 0;
}

}  // namespace

LiveView::LiveView(std::filesystem::path session, bool going_on)
    : session_(std::move(session)), page_(viewPage()), replaced_(going_on ? 0 : fileAt(session_)) {}

void LiveView::serveIfReady() {
  const auto now = std::chrono::steady_clock::now();
  if (server_ || now < next_look_) return;
  next_look_ = now + kLookInterval;
  const ino_t file = fileAt(session_);
  if (file == 0 || file == replaced_) return;
  view_.emplace(session_);
  server_.emplace(*view_, page_, 0);
  std::cerr << "\nfollow the exploration at " << server_->url() << "\n";
}

std::unique_ptr<SessionView::Pause> LiveView::pause() {
  return view_ ? view_->pause() : nullptr;
}

void LiveView::waitForInterrupt() {
  next_look_ = {};
  serveIfReady();
  if (!server_) return;
  std::cerr << "the page goes on showing what was explored: " << server_->url() << "\nCtrl-C ends\n";
  while (!interrupted()) std::this_thread::sleep_for(kLookInterval);
}

}  // namespace saccade::app
