#include "pipeline/background_writer.hpp"

#include <chrono>
#include <stdexcept>
#include <vector>

#include <gtest/gtest.h>

namespace saccade {
namespace {

struct Job {
  int number = 0;
};

TEST(BackgroundWriter, WritesAllJobsInOrderAlsoWhenTheWriterIsSlower) {
  std::vector<int> written;
  BackgroundWriter<Job> writer([&](const Job& job) {
    if (job.number % 5 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    written.push_back(job.number);
  });
  for (int i = 0; i < 40; ++i) {
    writer.next().number = i;
    writer.submit();
  }
  writer.finish();
  ASSERT_EQ(written.size(), 40u);
  for (int i = 0; i < 40; ++i) EXPECT_EQ(written[static_cast<std::size_t>(i)], i);
}

TEST(BackgroundWriter, AFailureIsThrownByALaterCallAndNothingIsWrittenAfterIt) {
  std::vector<int> written;
  BackgroundWriter<Job> writer([&](const Job& job) {
    if (job.number == 2) throw std::runtime_error("the disk is full");
    written.push_back(job.number);
  });
  const auto submitAll = [&] {
    for (int i = 0; i < 20; ++i) {
      writer.next().number = i;
      writer.submit();
    }
  };
  EXPECT_THROW(submitAll(), std::runtime_error);
  EXPECT_THROW(writer.finish(), std::runtime_error);
  EXPECT_EQ(written, (std::vector<int>{0, 1}));
}

}  // namespace
}  // namespace saccade
