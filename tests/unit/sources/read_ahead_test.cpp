#include "saccade/sources/read_ahead.hpp"

#include <atomic>
#include <chrono>
#include <set>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>

namespace saccade {
namespace {

/// Frames 0, 1, 2, ... whose pixels hold their number; every `skip_every`-th is skipped; may fail at one.
class CountingSource final : public FrameSource {
 public:
  CountingSource(int frames, int skip_every = 0, int fail_at = -1)
      : frames_(frames), skip_every_(skip_every), fail_at_(fail_at) {
    description_.frames = frames;
  }
  [[nodiscard]] const SourceDescription& description() const override { return description_; }
  [[nodiscard]] ReadStatus read(RgbdFrame& frame) override {
    if (next_ == fail_at_) throw std::runtime_error("the disk is on fire");
    if (next_ == frames_) return ReadStatus::kEnd;
    frame.index.value = next_++;
    buffers_.insert(frame.color.data);
    frame.color.create(4, 4);
    frame.color.setTo(cv::Scalar::all(static_cast<double>(frame.index.value)));
    reads_ = reads_ + 1;
    if (skip_every_ == 0 || frame.index.value % skip_every_ != 0) return ReadStatus::kFrame;
    reason_ = "frame " + std::to_string(frame.index.value);
    return ReadStatus::kSkip;
  }
  [[nodiscard]] const std::string& skipReason() const override { return reason_; }

  void makeLive() { description_.is_live = true; }

  std::set<const uchar*> buffers_;
  std::atomic<int> reads_{0};

 private:
  int frames_, skip_every_, fail_at_, next_ = 0;
  std::string reason_;
  SourceDescription description_;
};

TEST(ReadAhead, GivesTheSameFramesAndSkipsInOrder) {
  ReadAhead ahead(std::make_unique<CountingSource>(100, 7), 3);
  EXPECT_EQ(ahead.description().frames, 100);
  RgbdFrame frame;
  for (int i = 0; i < 100; ++i) {
    const ReadStatus status = ahead.read(frame);
    ASSERT_EQ(status, i % 7 == 0 ? ReadStatus::kSkip : ReadStatus::kFrame) << i;
    ASSERT_EQ(frame.index.value, i);
    ASSERT_EQ(frame.color(2, 2)[0], i);
    if (i % 7 == 0) {
      ASSERT_EQ(ahead.skipReason(), "frame " + std::to_string(i));
    }
  }
  EXPECT_EQ(ahead.read(frame), ReadStatus::kEnd);
  EXPECT_EQ(ahead.read(frame), ReadStatus::kEnd);
}

TEST(ReadAhead, RecyclesItsBuffers) {
  auto owned = std::make_unique<CountingSource>(200);
  CountingSource* source = owned.get();
  ReadAhead ahead(std::move(owned), 2);
  RgbdFrame frame;
  while (ahead.read(frame) == ReadStatus::kFrame) {
  }
  EXPECT_LE(source->buffers_.size(), 4u) << "two in the queue, the reader's, and none";
}

TEST(ReadAhead, LeavesPixelsAloneThatSomebodyStillHolds) {
  ReadAhead ahead(std::make_unique<CountingSource>(50), 2);
  std::vector<cv::Mat3b> kept;
  RgbdFrame frame;
  while (ahead.read(frame) == ReadStatus::kFrame) kept.push_back(frame.color);
  ASSERT_EQ(kept.size(), 50u);
  for (int i = 0; i < 50; ++i) EXPECT_EQ(kept[static_cast<std::size_t>(i)](1, 1)[0], i);
}

TEST(ReadAhead, ReadsNoFartherAheadThanAsked) {
  auto owned = std::make_unique<CountingSource>(1000);
  CountingSource* source = owned.get();
  ReadAhead ahead(std::move(owned), 4);
  RgbdFrame frame;
  ASSERT_EQ(ahead.read(frame), ReadStatus::kFrame);
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
  EXPECT_LE(source->reads_, 5);
}

TEST(ReadAhead, PassesAnExceptionOnInItsPlaceAndAgainLater) {
  ReadAhead ahead(std::make_unique<CountingSource>(10, 0, 3), 2);
  RgbdFrame frame;
  for (int i = 0; i < 3; ++i) ASSERT_EQ(ahead.read(frame), ReadStatus::kFrame);
  EXPECT_THROW((void)ahead.read(frame), std::runtime_error);
  EXPECT_THROW((void)ahead.read(frame), std::runtime_error);
}

TEST(ReadAhead, DropsTheOldestOfALiveSourceAndCountsThem) {
  auto owned = std::make_unique<CountingSource>(50);
  CountingSource* source = owned.get();
  source->makeLive();
  ReadAhead ahead(std::move(owned), 3);
  while (source->reads_ < 50) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  RgbdFrame frame;
  std::int64_t last = -1, frames = 0;
  while (ahead.read(frame) == ReadStatus::kFrame) {
    EXPECT_GT(frame.index.value, last) << "the order stays";
    EXPECT_EQ(frame.color(1, 1)[0], frame.index.value);
    last = frame.index.value;
    ++frames;
  }
  EXPECT_EQ(last, 49) << "the newest is never dropped";
  EXPECT_GT(ahead.progress().dropped, 0);
  EXPECT_EQ(frames + ahead.progress().dropped, 50);
}

TEST(ReadAhead, StopsCleanlyAtAnyMoment) {
  for (int reads = 0; reads < 12; ++reads) {
    ReadAhead ahead(std::make_unique<CountingSource>(8), 3);
    RgbdFrame frame;
    for (int i = 0; i < reads; ++i) (void)ahead.read(frame);
  }
  EXPECT_THROW(ReadAhead(nullptr), std::invalid_argument);
  EXPECT_THROW(ReadAhead(std::make_unique<CountingSource>(8), 0), std::invalid_argument);
}

}  // namespace
}  // namespace saccade
