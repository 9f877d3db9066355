#include "saccade/session/session_snapshot.hpp"

#include <gtest/gtest.h>

#include "saccade/session/session_writer.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::TemporaryFolder;

void addFrame(SessionWriter& writer) {
  FrameRecord frame;
  frame.tracking = "tracked";
  writer.addFrame(frame);
  SessionMetadata metadata;
  metadata.camera = {8, 6, 5.0, 5.0, 3.5, 2.5};
  metadata.leaf_size_m = 0.01;
  metadata.state = SessionState::kExploring;
  writer.commit(metadata);
}

TEST(SessionSnapshot, AReaderSeesOneMomentWhileTheWriterGoesOn) {
  const TemporaryFolder folder;
  SessionWriter writer(folder / "s.saccade", WhenSessionExists::kRefuse);
  writer.addRun({});
  addFrame(writer);
  const SessionReader reader(folder / "s.saccade");
  {
    const SessionSnapshot still(reader);
    addFrame(writer);
    EXPECT_EQ(reader.frames().size(), 1u);
    EXPECT_EQ(SessionReader(folder / "s.saccade").frames().size(), 2u) << "the writer was not held up";
  }
  EXPECT_EQ(reader.frames().size(), 2u);
  const SessionSnapshot again(reader);
  EXPECT_EQ(reader.frames().size(), 2u);
}

}  // namespace
}  // namespace saccade
