#pragma once

#include <memory>
#include <string>
#include <vector>

#include "saccade/inspection/session_view.hpp"

namespace saccade {

/// A file of the page, as it was built into the program.
struct PageFile {
  std::string name;          ///< below the page's root, "index.html" is the page itself
  std::string content_type;  ///< MIME
  std::string gzip;          ///< content, compressed
};

/// Serves a SessionView and the page that shows it by HTTP, on loopback alone.
///
/// Everything lies below a secret path (128 random bits): who does not know it gets 404, as does every name that is not
/// one of the page's files or one of the few questions of SessionView; nothing is ever looked up on disk. Requests
/// under another host name than the loopback's are refused (DNS rebinding), as are all methods but GET, bodies, and
/// addresses over 1 KiB. Tiles are answered one by one, so that memory does not grow with the map. At most
/// kMostFollowers pages are told of news; others get 503 and ask again.
class ViewServer {
 public:
  static constexpr int kMostFollowers = 4;

  /// Listens on `port` of 127.0.0.1, a free one if it is 0, and begins to serve. `view` must outlive the server. Throws
  /// IoError if the port is taken.
  ViewServer(SessionView& view, std::vector<PageFile> page, int port);
  ~ViewServer();
  ViewServer(const ViewServer&) = delete;
  ViewServer& operator=(const ViewServer&) = delete;

  /// The page's address, secret path included.
  [[nodiscard]] std::string url() const;
  [[nodiscard]] int port() const;
  /// Ends all answers that wait for news and stops listening. Safe to call twice.
  void stop();

 private:
  struct Http;
  std::unique_ptr<Http> http_;
};

}  // namespace saccade
