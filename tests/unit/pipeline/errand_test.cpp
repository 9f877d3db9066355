#include "pipeline/errand.hpp"

#include <atomic>
#include <stdexcept>
#include <thread>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

namespace saccade {
namespace {

TEST(Errand, IsDoneOnceWhoeverBegins) {
  std::atomic<int> done = 0;
  Errand errand;
  for (int i = 1; i <= 2000; ++i) {
    errand.offer([&] { ++done; });
    if (i % 3 == 0) errand.attempt();
    errand.finish();
    ASSERT_EQ(done, i);
    ASSERT_TRUE(errand.isDone());
  }
}

TEST(Errand, IsDoneByWhoFinishesItWhereNoOtherThreadMayWork) {
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  std::thread::id by;
  Errand errand;
  errand.offer([&] { by = std::this_thread::get_id(); });
  EXPECT_FALSE(errand.isDone());
  errand.finish();
  EXPECT_EQ(by, std::this_thread::get_id());
}

TEST(Errand, OfNothingIsDone) {
  Errand errand;
  EXPECT_TRUE(errand.isDone());
  errand.attempt();
  errand.finish();
}

TEST(Errand, FinishThrowsWhatTheWorkThrew) {
  Errand errand;
  errand.offer([] { throw std::runtime_error("no"); });
  EXPECT_THROW(errand.finish(), std::runtime_error);
  errand.finish();  // said once
  int done = 0;
  errand.offer([&] { ++done; });
  errand.finish();
  EXPECT_EQ(done, 1);
}

TEST(Errand, ForgetsAnErrorThatNobodyWantedToKnow) {
  Errand errand;
  errand.offer([] { throw std::runtime_error("no"); });
  errand.settle();
  errand.offer([] {});
  EXPECT_NO_THROW(errand.finish());
}

TEST(Errand, EndsWithWhatItWorksOn) {
  int done = 0;
  {
    Errand errand;
    errand.offer([&] { ++done; });
  }
  EXPECT_EQ(done, 1);
}

/// The point of it: a thread that waits for an errand in work does not pick up another one.
TEST(Errand, WaitingTakesNoOtherTask) {
  const tbb::global_control two(tbb::global_control::max_allowed_parallelism, 2);
  const std::thread::id here = std::this_thread::get_id();
  std::atomic<bool> begun = false, finished = false;
  std::atomic<bool> other_was_here = false;
  Errand errand;
  Errand other;
  errand.offer([&] {
    begun = true;
    begun.notify_all();
    std::this_thread::sleep_for(std::chrono::milliseconds(20));
    finished = true;
  });
  for (int i = 0; i < 1000 && !begun; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  other.offer([&] { other_was_here = std::this_thread::get_id() == here && !finished; });
  errand.finish();
  EXPECT_TRUE(finished);
  EXPECT_FALSE(other_was_here);
  other.finish();
}

}  // namespace
}  // namespace saccade
