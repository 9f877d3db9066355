#include "saccade/inspection/session_view.hpp"

#include <atomic>
#include <filesystem>
#include <thread>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "inspection/byte_cache.hpp"
#include "saccade/core/errors.hpp"
#include "saccade/inspection/attention_replay.hpp"
#include "saccade/objects/forgetting.hpp"
#include "saccade/session/session_map.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using Json = nlohmann::json;

const std::filesystem::path kDesk = SACCADE_SOURCE_DIR "/maps/desk_before.saccade";
const std::filesystem::path kLater = SACCADE_SOURCE_DIR "/maps/desk_after.saccade";

cv::Mat3b decode(const std::string& jpeg) {
  return cv::imdecode(std::vector<std::uint8_t>(jpeg.begin(), jpeg.end()), cv::IMREAD_COLOR);
}

TEST(SessionView, SaysOfTheSessionWhatItsReaderSays) {
  SessionView view(kDesk);
  const SessionReader reader(kDesk);
  const Json summary = Json::parse(view.summary()), frames = Json::parse(view.frames());
  EXPECT_EQ(summary["tick"], reader.metadata().tick);
  EXPECT_EQ(summary["leaf_size_m"], reader.metadata().leaf_size_m);
  for (const auto& [name, column] : frames.items()) EXPECT_EQ(column.size(), reader.frames().size()) << name;
  EXPECT_EQ(Json::parse(view.tileList()).size(), view.tiles().size());
}

TEST(SessionView, VoxelsOfAllTilesAreTheMapsOccupiedLeaves) {
  SessionView view(kDesk);
  const IorMap map = loadMap(SessionReader(kDesk));
  std::size_t occupied = 0, voxels = 0;
  map.forEachLeaf([&](const MapLeaf& leaf) { occupied += leaf.occupied ? 1 : 0; });
  for (const NodeKey& root : view.tiles()) voxels += (view.voxels(root, MapTree::kDepth)->size() - 16) / 16;
  EXPECT_EQ(voxels, occupied);
  EXPECT_GT(voxels, 1000u);
}

TEST(SessionView, ALeafIsThatOfTheMap) {
  SessionView view(kDesk);
  const IorMap map = loadMap(SessionReader(kDesk));
  int compared = 0;
  map.forEachLeaf([&](const MapLeaf& leaf) {
    if (!leaf.occupied || weight(leaf.ior, map.now()) == 0 || compared == 20) return;
    const Json json = Json::parse(view.leaf(leaf.key.corner));
    EXPECT_EQ(json["state"], "occupied");
    EXPECT_EQ(json["ior_weight"], weight(leaf.ior, map.now()));
    EXPECT_EQ(json["inhibited"], inhibited(leaf.ior, map.now()));
    EXPECT_FALSE(json["attentions"].empty());
    ++compared;
  });
  EXPECT_EQ(compared, 20);
  EXPECT_EQ(view.leaf({0, 0, 0}), "null");
}

TEST(SessionView, CandidatesHaveBoxesInsideThePicture) {
  SessionView view(kDesk);
  const Json camera = Json::parse(view.summary())["camera"];
  const Json candidates = Json::parse(view.candidates(0));
  ASSERT_FALSE(candidates.empty());
  for (const Json& candidate : candidates) {
    const auto box = candidate["box"].get<std::vector<int>>();
    EXPECT_GT(box[2] * box[3], 0);
    EXPECT_LE(box[0] + box[2], camera["width"]);
    EXPECT_LE(box[1] + box[3], camera["height"]);
  }
  EXPECT_EQ(view.candidates(1 << 20), "[]");
}

TEST(SessionView, ObjectsAreInhibitedAfterTheirLooksAndNotBefore) {
  SessionView view(kDesk);
  const Json now = Json::parse(view.objects(Tick{SessionReader(kDesk).metadata().tick}));
  const Json at_first = Json::parse(view.objects(Tick{0}));
  ASSERT_FALSE(now.empty());
  int inhibited = 0;
  for (const Json& object : now) {
    EXPECT_GE(object["looks"].size(), 2u);
    inhibited += object["inhibited"] > 0 ? 1 : 0;
    EXPECT_EQ(object["inhibited"] > 0, object["last_expiry"] > 0);
  }
  EXPECT_GT(inhibited, 0);
  for (const Json& object : at_first) EXPECT_EQ(object["inhibited"], 0);
}

TEST(SessionView, PicturesOfTheMapHaveTheCamerasSize) {
  SessionView view(kDesk);
  const Json camera = Json::parse(view.summary())["camera"];
  const cv::Size size(camera["width"], camera["height"]);
  for (const ViewPicture layer : {ViewPicture::kMap, ViewPicture::kIor}) {
    const auto jpeg = view.picture(3, layer);
    ASSERT_TRUE(jpeg);
    EXPECT_EQ(decode(*jpeg).size(), size);
  }
  EXPECT_NE(view.picture(3, ViewPicture::kMap), view.picture(3, ViewPicture::kIor));
  EXPECT_FALSE(view.picture(1 << 20, ViewPicture::kMap));
}

TEST(SessionView, ImagesBelongToKeyframesThatKeptThem) {
  SessionView view(kDesk);
  ASSERT_TRUE(Json::parse(view.summary())["keyframes"].empty());  // thinned, to keep the file small
  EXPECT_FALSE(view.picture(0, ViewPicture::kColor));
  EXPECT_FALSE(view.picture(0, ViewPicture::kSaliency));
}

TEST(SessionView, CropsEveryObjectThatIsListed) {
  SessionView view(kDesk);
  int cropped = 0;
  for (const Json& object : Json::parse(view.objects(Tick{0}))) {
    const auto jpeg = view.crop(object["id"].get<int>());
    ASSERT_TRUE(jpeg);
    cropped += decode(*jpeg).empty() ? 0 : 1;
  }
  EXPECT_GT(cropped, 0);
  EXPECT_FALSE(view.crop(1 << 20));
}

TEST(SessionView, DifferenceNamesLeavesOnlyWhereThereIsAnEarlierSession) {
  SessionView alone(kLater), compared(kLater, kDesk);
  EXPECT_TRUE(alone.difference().empty());
  EXPECT_FALSE(compared.difference().empty());
}

TEST(SessionView, FollowsASessionThatAnotherProgramChanges) {
  const test::TemporaryFolder folder;
  const std::filesystem::path path = folder / "s.saccade";
  std::filesystem::copy_file(kDesk, path);
  SessionView view(path);
  const std::uint64_t version = view.waitForChange(0, 0);
  EXPECT_EQ(view.waitForChange(version, 0), version);
  const std::string before = view.tileList();
  (void)forgetInSession(path, ForgetSelection::everything(), "2026-01-01T00:00:00Z");
  EXPECT_NE(view.waitForChange(version, 0), version);
  EXPECT_NE(view.tileList(), before);
}

TEST(SessionView, KeepsQuestionsWaitingWhileItIsPaused) {
  SessionView view(kDesk);
  auto pause = view.pause();
  std::atomic<bool> answered{false};
  std::thread asker([&] {
    (void)view.summary();
    answered = true;
  });
  EXPECT_FALSE(answered);  // may only fail if the pause does not hold
  pause.reset();
  asker.join();
  EXPECT_TRUE(answered);
}

TEST(SessionView, RefusesWhatIsNoSession) {
  EXPECT_THROW(SessionView(SACCADE_SOURCE_DIR "/README.md"), IoError);
  EXPECT_THROW(SessionView(kDesk, std::filesystem::path("/nowhere.saccade")), IoError);
}

TEST(ByteCache, ForgetsWhatWasUsedLongestAgoOnceItIsFull) {
  ByteCache<int> cache(100);
  for (int key = 0; key < 3; ++key) cache.insert(key, std::make_shared<const std::string>(40, 'x'));
  EXPECT_EQ(cache.find(0), nullptr);
  EXPECT_NE(cache.find(1), nullptr);
  cache.insert(3, std::make_shared<const std::string>(40, 'x'));
  EXPECT_EQ(cache.find(2), nullptr);
  EXPECT_NE(cache.find(1), nullptr);
  EXPECT_LE(cache.heldBytes(), 100u);
}

}  // namespace
}  // namespace saccade
