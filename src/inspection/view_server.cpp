#include "saccade/inspection/view_server.hpp"

#include <algorithm>
#include <atomic>
#include <charconv>
#include <functional>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <thread>

#include <fmt/format.h>

#include "inspection/http.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/inspection/voxel_tile.hpp"

namespace saccade {
namespace {

constexpr const char* kLoopback = "127.0.0.1";
constexpr std::size_t kLongestTarget = 1024;
constexpr int kThreads = 8;  ///< one may wait for news while others fetch tiles
constexpr int kNewsTimeout_ms = 2000;
constexpr const char* kBytes = "application/octet-stream";
constexpr const char* kJson = "application/json";
// The page is whole in itself: no script, style, picture or connection from anywhere else.
constexpr const char* kContentPolicy =
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' blob: data:; "
    "connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

std::string randomSecret() {
  std::random_device random;  // the system's entropy
  std::string secret;
  for (int i = 0; i < 4; ++i) secret += fmt::format("{:08x}", random());
  return secret;
}

/// Equality in a time that does not tell how much agreed.
bool sameSecret(const std::string& a, const std::string& b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference |= static_cast<unsigned>(static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(b[i]));
  }
  return difference == 0;
}

/// A whole number of the query between `lowest` and `highest`; none if it is missing or anything else.
std::optional<std::int64_t> number(const httplib::Request& request, const char* name, std::int64_t lowest,
                                   std::int64_t highest) {
  if (request.get_param_value_count(name) != 1) return std::nullopt;
  const std::string text = request.get_param_value(name);
  std::int64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || value < lowest || value > highest)
    return std::nullopt;
  return value;
}

std::optional<LeafKey> leafKey(const httplib::Request& request) {
  const auto x = number(request, "x", 0, 65535), y = number(request, "y", 0, 65535), z = number(request, "z", 0, 65535);
  if (!x || !y || !z) return std::nullopt;
  return LeafKey{static_cast<std::uint16_t>(*x), static_cast<std::uint16_t>(*y), static_cast<std::uint16_t>(*z)};
}

std::optional<ViewPicture> pictureCalled(const std::string& name) {
  if (name == "color") return ViewPicture::kColor;
  if (name == "saliency") return ViewPicture::kSaliency;
  if (name == "map") return ViewPicture::kMap;
  if (name == "ior") return ViewPicture::kIor;
  return std::nullopt;
}

void refuse(httplib::Response& response, int status, const std::string& why) {
  response.status = status;
  response.set_content(why + "\n", "text/plain");
}

void answerPicture(const std::optional<std::string>& jpeg, httplib::Response& response) {
  if (jpeg) {
    response.set_content(*jpeg, "image/jpeg");
  } else {
    refuse(response, 404, "the session keeps no such picture");
  }
}

}  // namespace

struct ViewServer::Http {
  Http(SessionView& view_, std::vector<PageFile> page_) : view(view_), page(std::move(page_)), secret(randomSecret()) {}

  SessionView& view;
  std::vector<PageFile> page;
  std::string secret;
  int port = 0;
  std::atomic<bool> stopping{false};
  std::atomic<int> followers{0};
  httplib::Server server;
  std::thread thread;

  void configure();
  [[nodiscard]] bool mayPass(const httplib::Request& request, httplib::Response& response) const;
  void answer(const httplib::Request& request, httplib::Response& response);
  bool answerQuestion(const std::string& question, const httplib::Request& request, httplib::Response& response);
  void answerPage(const std::string& name, const httplib::Request& request, httplib::Response& response) const;
  void streamTiles(int voxel_depth, httplib::Response& response);
  void streamNews(httplib::Response& response);
};

void ViewServer::Http::configure() {
  // Without SO_REUSEPORT, which the library would set: a port that is taken is refused.
  server.set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
  });
  server.new_task_queue = [] { return new httplib::ThreadPool(kThreads); };
  server.set_keep_alive_max_count(100000);
  server.set_payload_max_length(kLongestTarget);
  server.set_tcp_nodelay(true);
  server.set_default_headers({{"Cache-Control", "no-store"},
                              {"Content-Security-Policy", kContentPolicy},
                              {"Cross-Origin-Resource-Policy", "same-origin"},
                              {"Referrer-Policy", "no-referrer"},
                              {"X-Content-Type-Options", "nosniff"}});
  server.set_pre_routing_handler([this](const httplib::Request& request, httplib::Response& response) {
    if (!mayPass(request, response)) return httplib::Server::HandlerResponse::Handled;
    answer(request, response);
    return httplib::Server::HandlerResponse::Handled;
  });
}

bool ViewServer::Http::mayPass(const httplib::Request& request, httplib::Response& response) const {
  const std::string host = request.get_header_value("Host");
  if (host != fmt::format("{}:{}", kLoopback, port) && host != fmt::format("localhost:{}", port)) {
    refuse(response, 403, "this server answers to its loopback address only");
  } else if (request.method != "GET") {
    refuse(response, 405, "this server only answers GET");
  } else if (request.target.size() > kLongestTarget) {
    refuse(response, 414, "the address is too long");
  } else if (!request.body.empty() || request.has_header("Transfer-Encoding") ||
             (request.has_header("Content-Length") && request.get_header_value("Content-Length") != "0")) {
    refuse(response, 413, "this server takes no content");
  } else {
    return true;
  }
  return false;
}

void ViewServer::Http::answer(const httplib::Request& request, httplib::Response& response) {
  const std::string& path = request.path;  // "/SECRET/name", decoded
  const std::size_t slash = path.find('/', 1);
  if (slash == std::string::npos || !sameSecret(path.substr(1, slash - 1), secret)) {
    refuse(response, 404, "nothing is here; open the address that saccade view printed");
    return;
  }
  const std::string name = path.substr(slash + 1);
  constexpr const char* kQuestions = "api/";
  try {
    if (name.rfind(kQuestions, 0) != 0) {
      answerPage(name.empty() ? "index.html" : name, request, response);
    } else if (!answerQuestion(name.substr(4), request, response)) {
      refuse(response, 400, "no such question, or a number is missing or out of range");
    }
  } catch (const std::exception& error) {
    refuse(response, 500, error.what());
  }
}

void ViewServer::Http::answerPage(const std::string& name, const httplib::Request& request,
                                  httplib::Response& response) const {
  const auto file = std::find_if(page.begin(), page.end(), [&](const PageFile& f) { return f.name == name; });
  if (file == page.end()) return refuse(response, 404, "no file of the page has this name");
  if (request.get_header_value("Accept-Encoding").find("gzip") == std::string::npos) {
    return refuse(response, 406, "the page is kept compressed with gzip");
  }
  response.set_header("Content-Encoding", "gzip");
  // As a stream, or the library would compress what is compressed.
  response.set_content_provider(file->gzip.size(), file->content_type,
                                [file](std::size_t offset, std::size_t length, httplib::DataSink& sink) {
                                  return sink.write(file->gzip.data() + offset, length);
                                });
}

/// False if the question is unknown or its numbers make no sense.
bool ViewServer::Http::answerQuestion(const std::string& question, const httplib::Request& request,
                                      httplib::Response& response) {
  constexpr std::int64_t kAnyFrame = std::int64_t{1} << 40;
  const auto depth = [&] { return number(request, "depth", kCoarsestVoxelDepth, kFinestVoxelDepth); };
  if (question == "summary") {
    response.set_content(view.summary(), kJson);
  } else if (question == "frames") {
    response.set_content(view.frames(), kJson);
  } else if (question == "tilelist") {
    response.set_content(view.tileList(), kJson);
  } else if (question == "difference") {
    response.set_content(view.difference(), kBytes);
  } else if (question == "lastseen") {
    response.set_content(view.lastSeen(), kBytes);
  } else if (question == "news") {
    streamNews(response);
  } else if (question == "tiles") {
    const auto voxel_depth = depth();
    if (!voxel_depth) return false;
    streamTiles(static_cast<int>(*voxel_depth), response);
  } else if (question == "tile") {
    const auto root = leafKey(request);
    const auto root_depth = number(request, "root", 0, MapTree::kDepth), voxel_depth = depth();
    if (!root || !root_depth || !voxel_depth) return false;
    response.set_content(*view.voxels({*root, static_cast<int>(*root_depth)}, static_cast<int>(*voxel_depth)), kBytes);
  } else if (question == "attention" || question == "objects") {
    const auto number_of_tick = number(request, "tick", 0, IorState::kLastExpiry);
    if (!number_of_tick) return false;
    const Tick tick{static_cast<std::uint32_t>(*number_of_tick)};
    if (question == "attention") {
      response.set_content(view.attention(tick), kBytes);
    } else {
      response.set_content(view.objects(tick), kJson);
    }
  } else if (question == "leaf") {
    const auto key = leafKey(request);
    if (!key) return false;
    response.set_content(view.leaf(*key), kJson);
  } else if (question == "candidates" || question == "picture") {
    const auto frame = number(request, "frame", 0, kAnyFrame);
    if (!frame) return false;
    if (question == "candidates") {
      response.set_content(view.candidates(*frame), kJson);
      return true;
    }
    const auto layer = pictureCalled(request.get_param_value("layer"));
    if (!layer) return false;
    answerPicture(view.picture(*frame, *layer), response);
  } else if (question == "crop") {
    const auto id = number(request, "id", 1, std::numeric_limits<int>::max());
    if (!id) return false;
    answerPicture(view.crop(static_cast<int>(*id)), response);
  } else {
    return false;
  }
  return true;
}

/// All tiles, one after another, each made when the last one is sent.
void ViewServer::Http::streamTiles(int voxel_depth, httplib::Response& response) {
  auto roots = std::make_shared<std::vector<NodeKey>>(view.tiles());
  auto next = std::make_shared<std::size_t>(0);
  response.set_chunked_content_provider(kBytes, [this, roots, next, voxel_depth](std::size_t, httplib::DataSink& sink) {
    if (stopping) return false;
    if (*next == roots->size()) {
      sink.done();
      return true;
    }
    const std::shared_ptr<const std::string> tile = view.voxels((*roots)[(*next)++], voxel_depth);
    return sink.write(tile->data(), tile->size());
  });
}

/// Server-sent events: the version of the view whenever it changes, and a sign of life otherwise.
void ViewServer::Http::streamNews(httplib::Response& response) {
  if (++followers > kMostFollowers) {
    --followers;
    return refuse(response, 503, "too many pages follow this session");
  }
  auto version = std::make_shared<std::uint64_t>(0);
  response.set_chunked_content_provider(
      "text/event-stream",
      [this, version](std::size_t, httplib::DataSink& sink) {
        if (stopping) return false;
        const std::uint64_t now = view.waitForChange(*version, kNewsTimeout_ms);
        const std::string event = now == *version ? ": still here\n\n" : fmt::format("data: {}\n\n", now);
        *version = now;
        return sink.write(event.data(), event.size());
      },
      [this](bool) { --followers; });
}

ViewServer::ViewServer(SessionView& view, std::vector<PageFile> page, int port)
    : http_(std::make_unique<Http>(view, std::move(page))) {
  http_->configure();
  const bool bound = port == 0 ? (http_->port = http_->server.bind_to_any_port(kLoopback)) > 0
                               : http_->server.bind_to_port(kLoopback, port);
  if (!bound) throw IoError(fmt::format("{}:{}", kLoopback, port), "a free port", "one that is taken or forbidden");
  if (port != 0) http_->port = port;
  http_->thread = std::thread([http = http_.get()] { http->server.listen_after_bind(); });
  while (!http_->server.is_running()) std::this_thread::yield();
}

ViewServer::~ViewServer() {
  stop();
}

std::string ViewServer::url() const {
  return fmt::format("http://{}:{}/{}/", kLoopback, http_->port, http_->secret);
}

int ViewServer::port() const {
  return http_->port;
}

void ViewServer::stop() {
  http_->stopping = true;
  http_->server.stop();
  if (http_->thread.joinable()) http_->thread.join();
}

}  // namespace saccade
