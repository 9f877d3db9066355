#include <stdexcept>

#include <gtest/gtest.h>

#include "saccade/core/errors.hpp"
#include "saccade/pipeline/explorer.hpp"
#include "saccade/session/session_reader.hpp"
#include "session/checkpoint.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::TemporaryFolder;

std::unique_ptr<Checkpoint> checkpointOf(std::int64_t frame, std::uint32_t tick) {
  auto checkpoint = std::make_unique<Checkpoint>();
  checkpoint->frames.emplace_back();
  checkpoint->frames.back().index = {frame};
  checkpoint->frames.back().tracking = "tracked";
  checkpoint->frames.back().tick = tick;
  checkpoint->state["name"] = "of frame " + std::to_string(frame);
  checkpoint->metadata.camera = {640, 480, 525.0, 525.0, 319.5, 239.5};
  checkpoint->metadata.leaf_size_m = 0.01;
  checkpoint->metadata.tick = tick;
  checkpoint->metadata.state = SessionState::kComplete;
  return checkpoint;
}

TEST(CheckpointThread, WhatIsWaitedForIsDurable) {
  const TemporaryFolder folder;
  CheckpointThread thread(std::make_unique<SessionWriter>(folder / "s.saccade", WhenSessionExists::kRefuse));
  for (std::int64_t frame = 0; frame < 5; ++frame) {
    thread.waitUntilIdle();
    ASSERT_TRUE(thread.idle());
    std::unique_ptr<Checkpoint> checkpoint = checkpointOf(frame, static_cast<std::uint32_t>(frame + 1));
    thread.write(checkpoint);
    ASSERT_NE(checkpoint, nullptr);
    EXPECT_TRUE(checkpoint->frames.empty());  // another one, to be filled
    thread.waitUntilIdle();
    const SessionReader session(folder / "s.saccade");
    EXPECT_EQ(session.frames().size(), static_cast<std::size_t>(frame + 1));
    EXPECT_EQ(session.metadata().tick, static_cast<std::uint32_t>(frame + 1));
    EXPECT_EQ(session.state("name"), "of frame " + std::to_string(frame));
  }
  thread.finish(checkpointOf(5, 6));
  const SessionReader session(folder / "s.saccade");
  EXPECT_EQ(session.metadata().state, SessionState::kComplete);
  EXPECT_EQ(session.frames().size(), 6U);
}

TEST(CheckpointThread, EndsWithTheCheckpointInWork) {
  const TemporaryFolder folder;
  {
    CheckpointThread thread(std::make_unique<SessionWriter>(folder / "s.saccade", WhenSessionExists::kRefuse));
    thread.waitUntilIdle();
    std::unique_ptr<Checkpoint> checkpoint = checkpointOf(0, 1);
    thread.write(checkpoint);
  }
  EXPECT_EQ(SessionReader(folder / "s.saccade").frames().size(), 1U);
}

TEST(CheckpointThread, SaysWhatWritingThrew) {
  const TemporaryFolder folder;
  CheckpointThread thread(std::make_unique<SessionWriter>(folder / "s.saccade", WhenSessionExists::kRefuse));
  thread.waitUntilIdle();
  std::unique_ptr<Checkpoint> checkpoint = checkpointOf(0, 1);
  checkpoint->frames.push_back(checkpoint->frames.front());  // the same frame twice
  checkpoint->candidates.emplace_back();
  checkpoint->candidates.back().frame = {77};
  checkpoint->candidates.push_back(checkpoint->candidates.back());  // the same candidate twice
  thread.write(checkpoint);
  thread.waitUntilIdle();
  EXPECT_THROW((void)thread.idle(), std::exception);
}

/// Memory that was touched elsewhere takes the place of what a snapshot has, with all that it holds.
TEST(MapSnapshot, KeepsItsPartsInTheRoomOfAnother) {
  Explorer explorer(ExplorerConfig(), {64, 48, 50.0, 50.0, 31.5, 23.5});
  RgbdFrame frame;
  frame.color = cv::Mat3b(48, 64, cv::Vec3b(90, 120, 30));
  frame.depth_m = cv::Mat1f(48, 64, 1.0F);
  frame.color(cv::Rect(20, 12, 20, 20)).setTo(cv::Vec3b(10, 20, 200));
  (void)explorer.processAt(frame, Pose::Identity());
  MapChanges changes;
  MapSnapshot snapshot;
  changes.take(explorer, snapshot);
  ASSERT_FALSE(snapshot.parts().empty());
  std::vector<std::string> before;
  for (const MapSnapshot::Part& part : snapshot.parts()) before.emplace_back(snapshot.bytesOf(part));

  MapSnapshot roomy;
  roomy.beginRoom();
  while (roomy.touchMore()) {
  }
  snapshot.takeRoomOf(roomy);
  EXPECT_TRUE(roomy.parts().empty());
  ASSERT_EQ(snapshot.parts().size(), before.size());
  for (std::size_t i = 0; i < before.size(); ++i) EXPECT_EQ(snapshot.bytesOf(snapshot.parts()[i]), before[i]);
}

}  // namespace
}  // namespace saccade
