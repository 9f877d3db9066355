#include <filesystem>
#include <fstream>
#include <iterator>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::ProgramRun;
using test::runSaccade;
using test::TemporaryFolder;

/// All figures of both are equal; times are left out.
void expectSameFigures(const nlohmann::json& a, const nlohmann::json& b, const std::string& at = "") {
  for (const auto& [key, value] : a.items()) {
    if (key.find("ms") != std::string::npos || key == "input") continue;
    ASSERT_TRUE(b.contains(key)) << at << "/" << key;
    if (value.is_object()) {
      expectSameFigures(value, b[key], at + "/" + key);
    } else if (value.is_number()) {
      EXPECT_NEAR(value.get<double>(), b[key].get<double>(), 1e-9) << at << "/" << key;
    }
  }
}

TEST(Evaluate, RunsASequenceWithAndWithoutInhibitionAndWritesThePage) {
  const TemporaryFolder folder;
  const ProgramRun run =
      runSaccade({"evaluate", "sim:desk", "--range", ":9", "--gt-every", "4", "--baselines", "--vary", "map.ior.mf=2",
                  "--write-masks", folder / "masks", "-o", folder / "page", "--json"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  const nlohmann::json json = nlohmann::json::parse(run.output);
  const nlohmann::json& mean = json["mean"];
  EXPECT_EQ(mean["frames"], 9.0);
  EXPECT_EQ(mean["labelled_frames"], 3.0);
  for (const char* method : {"colour + depth", "ordered by area", "ordered by saliency", "random order"}) {
    ASSERT_TRUE(mean["methods"].contains(method)) << method;
  }
  EXPECT_GT(mean["methods"]["colour + depth"]["boxes"]["recall_all"], 0.3);
  for (const char* name : {"without IOR", "with IOR", "map.ior.mf = 2"}) {
    ASSERT_TRUE(mean["runs"].contains(name)) << name;
    EXPECT_GE(mean["runs"][name]["boxes"]["global_recall_all"], mean["runs"][name]["boxes"]["global_recall"]);
  }
  // Masks carried over four frames, compared with the exact ones; objects' edges are a leaf wide.
  EXPECT_GT(mean["propagation"]["mask_iou"], 0.75);
  EXPECT_GT(mean["propagation"]["objects"], 6.0);
  EXPECT_LT(mean["ate_rmse_m"], 0.02);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder / "masks"), {}), 9);
  for (const char* file : {"index.html", "figure-14-global-recall.svg", "figure-14-global-recall.png",
                           "figure-09-recall.png", "recall_precision.csv", "global_recall.csv", "revisit_rate.csv"}) {
    EXPECT_GT(std::filesystem::file_size(folder.path() / std::filesystem::path("page") / file), 500U) << file;
  }
}

TEST(Evaluate, JudgesACandidateFileAsItJudgesTheLiveRun) {
  const TemporaryFolder folder;
  const std::string masks = folder / "masks";
  const ProgramRun live =
      runSaccade({"evaluate", "sim:desk", "--range", ":4", "--poses", "dataset", "--write-masks", masks, "--json"});
  ASSERT_EQ(live.exit_code, 0) << live.talk;
  ASSERT_EQ(runSaccade({"explore", "sim:desk", "--range", ":4", "--poses", "dataset", "--no-ior", "--candidates",
                        folder / "c.jsonl"})
                .exit_code,
            0);
  const ProgramRun file = runSaccade({"evaluate", folder / "c.jsonl", "--gt", masks, "--json"});
  ASSERT_EQ(file.exit_code, 0) << file.talk;
  const nlohmann::json a = nlohmann::json::parse(live.output)["mean"], b = nlohmann::json::parse(file.output)["mean"];
  expectSameFigures(a["methods"]["colour + depth"]["boxes"], b["methods"]["open candidates"]["boxes"]);
  expectSameFigures(a["methods"]["colour + depth"]["masks"], b["methods"]["open candidates"]["masks"]);
  expectSameFigures(a["runs"]["without IOR"]["boxes"], b["runs"]["recorded run"]["boxes"]);
}

TEST(Evaluate, SaysWhatIsMissing) {
  const TemporaryFolder folder;
  EXPECT_EQ(runSaccade({"evaluate"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"evaluate", "sim:desk", "--vary", "map.ior.mf"}).exit_code, 2);
  EXPECT_EQ(runSaccade({"evaluate", "sim:desk", "--range", ":2", "--vary", "map.ior.nothing=2"}).exit_code, 2);
  std::ofstream(folder / "c.jsonl") << "{}\n";
  const ProgramRun damaged = runSaccade({"evaluate", folder / "c.jsonl", "--gt", folder.path()});
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_NE(damaged.talk.find("line 1"), std::string::npos) << damaged.talk;
  EXPECT_EQ(runSaccade({"evaluate", folder / "none.saccade", "--gt", folder.path()}).exit_code, 1);
}

}  // namespace
}  // namespace saccade
