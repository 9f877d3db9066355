#include <SQLiteCpp/SQLiteCpp.h>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include <gtest/gtest.h>

#include "saccade/reporting/session_report.hpp"
#include "support/file_bytes.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"
#include "support/tools.hpp"

namespace saccade {
namespace {

using test::hasTool;
using test::killSaccade;
using test::ProgramRun;
using test::readFile;
using test::runSaccade;
using test::TemporaryFolder;

const std::string kSession = std::string(SACCADE_SOURCE_DIR) + "/maps/desk_before.saccade";

bool isEmpty(const std::filesystem::path& folder) {
  return std::filesystem::directory_iterator(folder) == std::filesystem::directory_iterator();
}

/// What Chromium makes of a page that it opens from disk, without a network.
struct OpenedPage {
  std::string elements;  ///< after its scripts ran
  std::string console;   ///< lines that went to the console, errors among them
};

OpenedPage openInChromium(const std::filesystem::path& page, const TemporaryFolder& folder) {
  const std::string out = folder / "elements.html", talk = folder / "chromium.log";
  const std::string command =
      "timeout 120 chromium --headless=new --no-sandbox --use-angle=swiftshader --enable-unsafe-swiftshader "
      "--proxy-server=127.0.0.1:9 --enable-logging=stderr --virtual-time-budget=5000 --user-data-dir='" +
      (folder / "profile").string() + "' --dump-dom 'file://" + page.string() + "' >'" + out + "' 2>'" + talk + "'";
  (void)std::system(command.c_str());
  OpenedPage opened{readFile(out), ""};
  std::istringstream lines(readFile(talk));
  for (std::string line; std::getline(lines, line);) {
    if (line.find("CONSOLE") != std::string::npos) opened.console += line + "\n";
  }
  return opened;
}

TEST(ReportCommand, WritesOnePageThatNeedsNothingElse) {
  const TemporaryFolder folder;
  const std::string page = folder / "s.html";
  const ProgramRun run = runSaccade({"report", kSession, "-o", page});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  EXPECT_EQ(run.output, "");
  const std::string html = readFile(page);
  EXPECT_LE(html.size(), kLargestReport_bytes);
  for (const char* part : {"Path of the camera", "Candidates", "Revisits", "IOR weights", "Memory", "id=\"scene\"",
                           "id=\"objects\"", "All settings", "leaf_size_m"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
  const std::regex outside("(src|href)=\"(?!data:|#)|url\\(|@import|<link");
  const std::string head = html.substr(0, html.find("<canvas"));
  std::smatch found;
  EXPECT_FALSE(std::regex_search(head, found, outside)) << found.str();
  for (std::size_t at = 0; (at = html.find("://", at)) != std::string::npos; ++at) {
    EXPECT_EQ(html.substr(at, 14), "://www.w3.org/") << "only SVG's own names: " << html.substr(at - 10, 60);
  }
}

TEST(ReportCommand, TheSameSessionGivesTheSameBytes) {
  const TemporaryFolder folder;
  ASSERT_EQ(runSaccade({"report", kSession, "-o", folder / "a.html"}).exit_code, 0);
  ASSERT_EQ(runSaccade({"report", kSession, "-o", folder / "b.html"}).exit_code, 0);
  EXPECT_EQ(readFile(folder / "a.html"), readFile(folder / "b.html"));
}

TEST(ReportCommand, OpensInChromiumWithoutAConsoleErrorAndDrawsTheMap) {
  if (!hasTool("chromium")) GTEST_SKIP() << "chromium is not installed";
  const TemporaryFolder folder;
  const std::string session = folder / "s.saccade", page = folder / "s.html";
  std::filesystem::copy_file(kSession, session);
  {  // a session's text is not to be trusted
    SQLite::Database database(session, SQLite::OPEN_READWRITE);
    database.exec("UPDATE meta SET value = '\"<script>console.error(1)</script>\"' WHERE key = 'input'");
    database.exec("UPDATE frames SET name = '\"><img src=x onerror=alert(1)>' || name");
  }
  ASSERT_EQ(runSaccade({"report", session, "-o", page}).exit_code, 0);
  const OpenedPage opened = openInChromium(page, folder);
  EXPECT_EQ(opened.console, "");
  std::smatch drawn;
  ASSERT_TRUE(std::regex_search(opened.elements, drawn, std::regex("data-scene=\"([0-9]+)\"")))
      << opened.elements.substr(0, 300);
  EXPECT_GT(std::stoi(drawn[1]), 1000) << "points drawn";
}

TEST(ReportCommand, TheConsoleIsReallyRead) {
  if (!hasTool("chromium")) GTEST_SKIP() << "chromium is not installed";
  const TemporaryFolder folder;
  std::ofstream(folder / "wrong.html") << "<!doctype html><script>throw new Error('seen');</script>";
  EXPECT_NE(openInChromium(folder / "wrong.html", folder).console.find("seen"), std::string::npos);
}

TEST(ReportCommand, ComparesWithTheTruth) {
  const TemporaryFolder folder;
  const std::string truth = folder / "truth.txt", page = folder / "s.html";
  ASSERT_EQ(runSaccade({"export", kSession, truth}).exit_code, 0);
  const ProgramRun run = runSaccade({"report", kSession, "-o", page, "--truth", truth});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  const std::string html = readFile(page);
  EXPECT_NE(html.find("ATE 0.0 mm"), std::string::npos) << "the session's own poses are its truth";
  EXPECT_NE(html.find("Trajectory error"), std::string::npos);
  std::ofstream(folder / "later.txt") << "1000000 0 0 0 0 0 0 1\n";
  const ProgramRun later = runSaccade({"report", kSession, "-o", folder / "t.html", "--truth", folder / "later.txt"});
  EXPECT_EQ(later.exit_code, 1);
  EXPECT_NE(later.talk.find("later.txt"), std::string::npos) << later.talk;
  EXPECT_FALSE(std::filesystem::exists(folder / "t.html"));
}

TEST(ReportCommand, IsWholeOrNotThere) {
  const TemporaryFolder folder, out;
  const std::string damaged = folder / "d.saccade";
  std::filesystem::copy_file(kSession, damaged);
  SQLite::Database(damaged, SQLite::OPEN_READWRITE)
      .exec("UPDATE tiles SET data = zeroblob(length(data)) WHERE key = (SELECT max(key) FROM tiles)");
  const ProgramRun broken = runSaccade({"report", damaged, "-o", out / "d.html"});
  EXPECT_EQ(broken.exit_code, 1);
  EXPECT_NE(broken.talk.find("d.saccade"), std::string::npos) << broken.talk;
  EXPECT_EQ(runSaccade({"report", folder / "none.saccade", "-o", out / "n.html"}).exit_code, 1);
  EXPECT_EQ(runSaccade({"report", kSession, "-o", out / "no" / "x.html"}).exit_code, 1);
  EXPECT_EQ(runSaccade({"report", kSession}).exit_code, 2);
  EXPECT_TRUE(isEmpty(out / "")) << "nothing half done is left";
}

TEST(ReportCommand, AnImportedMapWithoutFramesHasAPageToo) {
  const TemporaryFolder folder;
  ASSERT_EQ(runSaccade({"export", kSession, folder / "m.bt"}).exit_code, 0);
  ASSERT_EQ(runSaccade({"import", folder / "m.bt", "-o", folder / "m.saccade"}).exit_code, 0);
  const ProgramRun run = runSaccade({"report", folder / "m.saccade", "-o", folder / "m.html"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  EXPECT_NE(readFile(folder / "m.html").find("id=\"scene\""), std::string::npos);
}

TEST(ReportCommand, ReadsASessionWhileItIsExplored) {
  const TemporaryFolder folder;
  const std::string session = folder / "s.saccade";
  // What a killed writer leaves is what a reader beside it sees.
  (void)killSaccade({"explore", "sim:desk?frames=400", "-o", session, "--checkpoint-interval", "0.1"}, session, 2.0);
  ASSERT_TRUE(std::filesystem::exists(session));
  const ProgramRun run = runSaccade({"report", session, "-o", folder / "s.html"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  EXPECT_NE(readFile(folder / "s.html").find("still being explored, or cut off"), std::string::npos);
  for (const char* question : {"timeline", "objects", "histogram"}) {
    EXPECT_EQ(runSaccade({"inspect", session, question, "--json"}).exit_code, 0) << question;
  }
}

}  // namespace
}  // namespace saccade
