#include "saccade/exchange/session_alignment.hpp"

#include <gtest/gtest.h>

#include "saccade/core/config_file.hpp"
#include "saccade/exchange/session_merge.hpp"
#include "saccade/map/map_tiles.hpp"
#include "saccade/session/session_map.hpp"
#include "saccade/session/session_writer.hpp"
#include "saccade/tracking/frame_features.hpp"
#include "session/map_blobs.hpp"
#include "support/painted_room.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::PaintedRoom;
using test::poseOf;
using test::TemporaryFolder;

PinholeCamera camera() {
  return {320, 240, 292.5, 292.5, 159.5, 119.5};
}

/// What a run past the room leaves behind, in a world frame of its own: `T_WR` takes the room's points to it.
void writeSession(const std::filesystem::path& path, const PaintedRoom& room, const Pose& T_WR, double first_deg) {
  SessionWriter writer(path, WhenSessionExists::kRefuse);
  writer.addRun({0, {}, "painted room", "a test", "2026-01-01T00:00:00Z", "0"});
  IorMap map;
  SurfaceVolume surface;
  for (int i = 0; i < 4; ++i) {
    const Pose T_RC = poseOf({0, 1, 0}, first_deg + 8.0 * i, {0.05 * i, 0.0, 0.0});
    const RgbdFrame image = room.photograph(camera(), T_RC);
    DepthMaps depth;
    DepthPreparation().prepare(image.depth_m, camera(), depth);
    surface.integrate(depth, T_WR * T_RC);
    map.integrate(depth, image.color, T_WR * T_RC);
    map.attend({});
    FrameRecord frame;
    frame.index = {i};
    frame.name = "frame-" + std::to_string(i);
    frame.tracking = "tracked";
    frame.T_WC = T_WR * T_RC;
    frame.tick = map.now().value;
    KeyframeRecord keyframe;
    keyframe.ordinal = writer.addFrame(frame);
    keyframe.T_WC = T_WR * T_RC;
    keyframe.color = image.color;
    keyframe.depth_m = image.depth_m;
    keyframe.features = encodeFeatures(FeatureExtractor().extract(image.color, depth));
    writer.addKeyframe(keyframe);
  }
  for (const NodeKey& root : listTiles(map)) {
    writer.putBlob(BlobTable::kTiles, {tileKey(root), 1, bytesOf(encodeTile(map, root))});
  }
  for (std::size_t i = 0; i < surface.bricks().size(); ++i) {
    writer.putBlob(BlobTable::kBricks, {brickKey(surface.bricks()[i]), 1, bytesOf(surface.brick(i))});
  }
  ExplorerConfig config;
  SessionMetadata metadata;
  metadata.config_yaml = printConfig(describing(config), false);
  metadata.camera = camera();
  metadata.leaf_size_m = config.map.leaf_size_m;
  metadata.tick = map.now().value;
  metadata.leaves = static_cast<std::int64_t>(map.leafCount());
  writer.finish(metadata);
}

const Pose kT_AB = poseOf({1, 2, 3}, 40.0, {0.6, -0.3, 0.2});

TEST(SessionAlignment, FindsHowTheFramesOfTwoSessionsLie) {
  const TemporaryFolder folder;
  writeSession(folder / "a.saccade", PaintedRoom(), kT_AB, -12.0);
  writeSession(folder / "b.saccade", PaintedRoom(), Pose::Identity(), -8.0);
  const auto alignment = alignSessions(SessionReader(folder / "a.saccade"), SessionReader(folder / "b.saccade"));
  ASSERT_TRUE(alignment);
  EXPECT_GE(alignment->agreeing, 2);
  const Pose error = kT_AB.inverse() * alignment->T_AB;
  constexpr double kPlaceError_m = 0.01, kPlaceError_rad = 0.01;  // as of the relocaliser
  EXPECT_LT(error.translation().norm(), kPlaceError_m);
  EXPECT_LT(Eigen::AngleAxisd(error.linear()).angle(), kPlaceError_rad);
}

TEST(SessionAlignment, SessionsOfDifferentPlacesAreNotAligned) {
  const TemporaryFolder folder;
  PaintedRoom other;
  other.seed = 2;
  writeSession(folder / "a.saccade", PaintedRoom(), Pose::Identity(), -12.0);
  writeSession(folder / "b.saccade", other, Pose::Identity(), -8.0);
  EXPECT_FALSE(alignSessions(SessionReader(folder / "a.saccade"), SessionReader(folder / "b.saccade")));
}

TEST(MergeSessions, InDifferentFramesTheSurfacesFallOnEachOtherAndPosesAreMoved) {
  const TemporaryFolder folder;
  const PaintedRoom room;
  writeSession(folder / "a.saccade", room, kT_AB, -12.0);
  writeSession(folder / "b.saccade", room, Pose::Identity(), -8.0);
  const SessionReader a(folder / "a.saccade"), b(folder / "b.saccade");
  const SessionMergeReport report =
      mergeSessions(a, b, kT_AB, folder / "c.saccade", WhenSessionExists::kRefuse, "2026-01-01T00:00:00Z");
  EXPECT_EQ(report.frames, 8);
  EXPECT_EQ(report.keyframes, 8);
  EXPECT_EQ(report.tick, 8U);
  EXPECT_EQ(report.map.lifted, 0U);
  const SessionReader c(folder / "c.saccade");
  const std::vector<FrameRecord> frames = c.frames(), of_b = b.frames();
  constexpr double kRoundOff = 1e-9;
  EXPECT_TRUE(frames[5].T_WC->isApprox(kT_AB * *of_b[1].T_WC, kRoundOff));
  EXPECT_EQ(frames[5].tick, 6U);
  EXPECT_TRUE(c.keyframes()[5].T_WC.isApprox(kT_AB * *of_b[1].T_WC, kRoundOff));

  const IorMap merged = loadMap(c);
  int occupied = 0, tried = 0;
  for (int v = 20; v < camera().height; v += 10) {
    for (int u = 20; u < camera().width; u += 10) {  // what b alone saw lies where it should, too
      const Pose T_RC = poseOf({0, 1, 0}, 16.0, {0.15, 0.0, 0.0});
      const double depth_m = room.scene.meetPixel(camera(), T_RC, u, v).s;
      const auto leaf = merged.findLeaf(kT_AB * (T_RC * camera().unproject(u, v, depth_m)));
      ++tried;
      occupied += leaf && leaf->occupied ? 1 : 0;
    }
  }
  EXPECT_GT(occupied, tried * 6 / 10);  // points lie within half a leaf of a leaf's border as often as not
}

}  // namespace
}  // namespace saccade
