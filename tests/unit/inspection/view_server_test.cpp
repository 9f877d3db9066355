#include "saccade/inspection/view_server.hpp"

#include <arpa/inet.h>
#include <fstream>
#include <sstream>
#include <string>

#include <gtest/gtest.h>

#include "inspection/http.hpp"
#include "saccade/core/errors.hpp"

namespace saccade {
namespace {

class ViewServerTest : public testing::Test {
 protected:
  ViewServerTest() {
    client.set_decompress(false);
    client.set_default_headers({{"Accept-Encoding", "gzip"}});
    const std::string url = server.url();
    base = url.substr(url.find('/', std::string("http://").size()));
  }

  /// Status of an answer; 0 where there is none.
  int status(const std::string& target) {
    const auto answer = client.Get(target);
    return answer ? answer->status : 0;
  }

  SessionView view{SACCADE_SOURCE_DIR "/maps/desk_before.saccade"};
  ViewServer server{view, {{"index.html", "text/html", "PACKED"}}, 0};
  httplib::Client client{"127.0.0.1", server.port()};
  std::string base;
};

TEST_F(ViewServerTest, AnswersUnderItsSecretPath) {
  EXPECT_EQ(status(base), 200);
  EXPECT_EQ(client.Get(base)->body, "PACKED");
  for (const char* question : {"summary", "frames", "objects?tick=3", "tilelist", "tiles?depth=13", "attention?tick=3",
                               "difference", "candidates?frame=0", "picture?frame=0&layer=map", "leaf?x=1&y=2&z=3"}) {
    EXPECT_EQ(status(base + "api/" + question), 200) << question;
  }
}

TEST_F(ViewServerTest, GivesNothingWithoutTheSecret) {
  const std::string wrong(32, '0');
  for (const std::string& target : {std::string("/"), std::string("/api/summary"), "/" + wrong + "/",
                                    "/" + wrong + "/api/summary", base.substr(0, base.size() - 2) + "/"}) {
    EXPECT_EQ(status(target), 404) << target;
  }
}

TEST_F(ViewServerTest, GivesAnotherSecretToEachServer) {
  const ViewServer other(view, {}, 0);
  EXPECT_NE(other.url().substr(other.url().rfind('/', other.url().size() - 2)), base);
}

TEST_F(ViewServerTest, ListensOnLoopbackAlone) {
  std::ifstream table("/proc/net/tcp");
  std::string line;
  int listening = 0;
  const auto hex = [](std::uint32_t value, int digits) {
    std::ostringstream text;
    text << std::uppercase << std::hex;
    text.width(digits);
    text.fill('0');
    text << value;
    return text.str();
  };
  while (std::getline(table, line)) {
    std::istringstream words(line);
    std::string slot, local, remote, state;
    words >> slot >> local >> remote >> state;
    if (state != "0A" || local.substr(local.find(':') + 1) != hex(static_cast<std::uint32_t>(server.port()), 4))
      continue;
    ++listening;
    EXPECT_EQ(local.substr(0, 8), hex(inet_addr("127.0.0.1"), 8));
  }
  EXPECT_EQ(listening, 1);
}

TEST_F(ViewServerTest, RefusesEveryPathOutsideThePagesOwnFiles) {
  for (const char* name :
       {"../index.html", "..%2f..%2fetc%2fpasswd", "../../../../etc/passwd", "%2e%2e/%2e%2e/etc/passwd", "/etc/passwd",
        "index.html%00.js", "page.js", "api/../../etc/passwd"}) {
    const int answer = status(base + name);
    EXPECT_TRUE(answer == 404 || answer == 400) << name << " gave " << answer;
  }
}

TEST_F(ViewServerTest, RefusesOversizeAddressesBodiesAndOtherMethods) {
  EXPECT_EQ(status(base + std::string(2000, 'a')), 414);
  EXPECT_EQ(client.Post(base + "api/summary", std::string(100, 'x'), "text/plain")->status, 405);
  EXPECT_EQ(client.Delete(base + "api/summary")->status, 405);
  httplib::Client fresh("127.0.0.1", server.port());
  const auto huge = fresh.Post(base, std::string(std::size_t{8} << 20, 'x'), "text/plain");
  EXPECT_TRUE(!huge || huge->status == 405 || huge->status == 413);
  EXPECT_EQ(status(base + "api/summary"), 200);
}

TEST_F(ViewServerTest, RefusesOtherHostNames) {
  EXPECT_EQ(client.Get(base, {{"Host", "evil.example"}})->status, 403);
}

TEST_F(ViewServerTest, RefusesQuestionsThatMakeNoSense) {
  for (const char* question :
       {"nonsense", "tile?x=1", "tile?x=1&y=1&z=1&root=10&depth=99", "attention?tick=-1", "attention?tick=1x",
        "picture?frame=0&layer=secret", "leaf?x=70000&y=0&z=0", "attention?tick=1&tick=2", "crop?id=0"}) {
    EXPECT_EQ(status(base + "api/" + question), 400) << question;
  }
  EXPECT_EQ(status(base + "api/crop?id=99999"), 404);
}

TEST_F(ViewServerTest, LetsThePageLoadNothingFromElsewhere) {
  const std::string policy = client.Get(base)->get_header_value("Content-Security-Policy");
  EXPECT_NE(policy.find("default-src 'none'"), std::string::npos);
  EXPECT_EQ(policy.find("http"), std::string::npos);
  EXPECT_EQ(policy.find('*'), std::string::npos);
}

TEST_F(ViewServerTest, RefusesAPortThatIsTaken) {
  EXPECT_THROW(ViewServer(view, {}, server.port()), IoError);
}

}  // namespace
}  // namespace saccade
