#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using nlohmann::json;
using test::ProgramRun;
using test::runSaccade;
using test::TemporaryFolder;

const std::string kSource = SACCADE_SOURCE_DIR;
const std::string kSession = kSource + "/maps/desk_before.saccade";

json inspect(std::vector<std::string> question, const std::string& session = kSession) {
  question.insert(question.begin(), {"inspect", session});
  question.emplace_back("--json");
  const ProgramRun run = runSaccade(question);
  EXPECT_EQ(run.exit_code, 0) << run.talk;
  return json::parse(run.output);
}

std::string documentation() {
  std::ifstream file(kSource + "/docs/inspect-json.md");
  return {std::istreambuf_iterator<char>(file), {}};
}

/// The keys that the tables of a section of docs/inspect-json.md name.
std::set<std::string> documentedKeys(const std::string& section) {
  const std::string text = documentation();
  const std::size_t begin = text.find("\n## `inspect S" + section);
  EXPECT_NE(begin, std::string::npos) << section;
  const std::size_t end = std::min(text.find("\n## ", begin + 1), text.size());
  std::set<std::string> keys;
  std::istringstream lines(text.substr(begin, end - begin));
  for (std::string line; std::getline(lines, line);) {
    if (line.rfind("| `", 0) != 0) continue;
    const std::string cell = line.substr(0, line.find('|', 1));
    const std::regex quoted("`([^`]+)`");
    for (std::sregex_iterator i(cell.begin(), cell.end(), quoted), none; i != none; ++i) keys.insert((*i)[1]);
  }
  return keys;
}

/// The keys of a JSON value: objects by dots, elements of arrays as `[]`. `empty`: arrays of which nothing is known.
void collectKeys(const json& value, const std::string& path, std::set<std::string>& keys,
                 std::set<std::string>& empty) {
  if (value.is_object()) {
    for (const auto& [key, part] : value.items()) {
      collectKeys(part, path.empty() ? key : path + "." + key, keys, empty);
    }
  } else if (value.is_array() && value.empty()) {
    empty.insert(path + "[]");
  } else if (value.is_array() && value.front().is_object()) {
    for (const json& part : value) collectKeys(part, path + "[]", keys, empty);
  } else {
    keys.insert(path);
  }
}

void expectDocumented(const std::string& section, const json& answer) {
  std::set<std::string> produced, empty;
  collectKeys(answer, "", produced, empty);
  const std::set<std::string> documented = documentedKeys(section);
  for (const std::string& key : produced) EXPECT_TRUE(documented.count(key)) << section << " gives " << key;
  for (const std::string& key : documented) {
    const std::string array = key.substr(0, key.find("[]") + 2);
    const bool is_parent = std::any_of(produced.begin(), produced.end(),
                                       [&](const std::string& other) { return other.rfind(key + ".", 0) == 0; });
    EXPECT_TRUE(produced.count(key) || is_parent || empty.count(array)) << section << " does not give " << key;
  }
}

TEST(InspectCommand, GivesTheKeysThatAreDocumentedAndNoOthers) {
  const TemporaryFolder folder;
  const std::string copy = folder / "s.saccade";
  std::filesystem::copy_file(kSession, copy);
  ASSERT_EQ(runSaccade({"forget", copy, "--id", "2"}).exit_code, 0);
  expectDocumented("`", inspect({}));
  expectDocumented(" query", inspect({"query", "-0.23", "-0.399", "1.65"}));
  expectDocumented(" slice", inspect({"slice", "--z", "1"}));
  expectDocumented(" objects", inspect({"objects"}));
  expectDocumented(" why", inspect({"why", "2"}, copy));
  expectDocumented(" timeline", inspect({"timeline"}));
  expectDocumented(" histogram", inspect({"histogram"}));
}

TEST(InspectCommand, TheDocumentedExampleIsWhatTheProgramSays) {
  const std::string text = documentation();
  const std::size_t begin = text.find("```json\n") + 8;
  const json example = json::parse(text.substr(begin, text.find("```", begin) - begin));
  EXPECT_EQ(example, inspect({"query", "-0.23", "-0.399", "1.65"}));
}

TEST(InspectCommand, QuerySaysWhatTheSliceShowsThere) {
  const json slice = inspect({"slice", "--z", "1"});
  int compared = 0;
  const auto coordinate = [](const json& side, std::size_t i) {
    return std::to_string(side["first_m"].get<double>() +
                          (static_cast<double>(i) + 0.5) * side["step_m"].get<double>());
  };
  for (const char symbol : {' ', '.', 'o', 'a', '#'}) {
    for (std::size_t v = 0; v < slice["cells"].size(); ++v) {
      const std::size_t u = slice["cells"][v].get<std::string>().find(symbol);
      if (u == std::string::npos) continue;
      const json at = inspect({"query", coordinate(slice["columns"], u), coordinate(slice["rows"], v), "1.001"});
      const json& leaf = at["leaf"];
      EXPECT_EQ(at["state"], symbol == ' ' ? "unknown" : symbol == '.' ? "free" : "occupied") << u << " " << v;
      EXPECT_EQ(symbol == '#', leaf.is_object() && leaf["inhibited"].get<bool>());
      EXPECT_EQ(symbol == '#' || symbol == 'a', leaf.is_object() && leaf["ior_weight"].get<int>() > 0);
      ++compared;
      break;
    }
  }
  EXPECT_EQ(compared, 5) << "the slice shows every kind of cell";
}

TEST(InspectCommand, TimelineHistogramAndObjectsAgreeWithTheSummary) {
  const json summary = inspect({}), timeline = inspect({"timeline"}), histogram = inspect({"histogram"});
  EXPECT_EQ(timeline["frames"].size(), summary["frames"]["processed"].get<std::size_t>());
  std::int64_t attended = 0;
  for (const json& frame : timeline["frames"]) attended += frame["attended"].get<std::int64_t>();
  EXPECT_EQ(attended, summary["attention"]["attended_candidates"].get<std::int64_t>());
  EXPECT_EQ(timeline["frames"].back()["tick"], summary["map"]["tick"]);
  EXPECT_EQ(timeline["frames"].front()["revisits"], 0) << "nothing was attended before the first frame";
  std::int64_t counted = histogram["without"].get<std::int64_t>();
  for (const json& bin : histogram["bins"]) counted += bin["leaves"].get<std::int64_t>();
  EXPECT_EQ(counted, histogram["leaves"].get<std::int64_t>());
}

TEST(InspectCommand, TextHasNoMoreThanOneLineAFrameAndBlocksForTheCourses) {
  const ProgramRun summary = runSaccade({"inspect", kSession});
  EXPECT_NE(summary.output.find("█"), std::string::npos);
  EXPECT_EQ(summary.talk, "");
  const ProgramRun timeline = runSaccade({"inspect", kSession, "timeline"});
  EXPECT_EQ(std::count(timeline.output.begin(), timeline.output.end(), '\n'), 11) << "10 frames and a heading";
  EXPECT_EQ(runSaccade({"inspect", kSession, "slice", "--y", "0"}).exit_code, 0);
  EXPECT_EQ(runSaccade({"inspect", kSession, "histogram", "--of", "observations"}).exit_code, 0);
}

TEST(InspectCommand, ASliceIsAPictureThatReplacesNothingUnasked) {
  const TemporaryFolder folder;
  const std::string path = folder / "cut.png";
  const std::vector<std::string> cut = {"inspect", kSession, "slice", "--y", "0", "-o", path};
  ASSERT_EQ(runSaccade(cut).exit_code, 0);
  EXPECT_FALSE(cv::imread(path).empty());
  EXPECT_EQ(runSaccade(cut).exit_code, 1);
  EXPECT_EQ(runSaccade({"inspect", kSession, "slice", "--y", "0", "-o", folder / "no" / "x.png"}).exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder / "no"));
}

TEST(InspectCommand, MistakesAreUsageErrorsAndAMissingSessionIsOneClearSentence) {
  for (const std::vector<std::string>& wrong : std::vector<std::vector<std::string>>{{"query", "1", "2"},
                                                                                     {"query", "nan", "0", "0"},
                                                                                     {"query", "1e9", "0", "0"},
                                                                                     {"query", "a", "b", "c"},
                                                                                     {"slice"},
                                                                                     {"slice", "--x", "1", "--y", "2"},
                                                                                     {"slice", "--z", "1e9"},
                                                                                     {"histogram", "--of", "heat"},
                                                                                     {"histogram", "--bins", "0"},
                                                                                     {"why", "999999"},
                                                                                     {"objects", "timeline"}}) {
    std::vector<std::string> arguments = {"inspect", kSession};
    arguments.insert(arguments.end(), wrong.begin(), wrong.end());
    const ProgramRun run = runSaccade(arguments);
    EXPECT_EQ(run.exit_code, 2) << wrong.front() << ": " << run.talk;
    EXPECT_EQ(run.output, "") << wrong.front();
  }
  const TemporaryFolder folder;
  for (const char* question : {"timeline", "objects", "histogram"}) {
    const ProgramRun run = runSaccade({"inspect", folder / "none.saccade", question});
    EXPECT_EQ(run.exit_code, 1);
    EXPECT_NE(run.talk.find("none.saccade"), std::string::npos) << run.talk;
  }
}

}  // namespace
}  // namespace saccade
