#include <filesystem>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace saccade {
namespace {

using test::runSaccade;
using test::TemporaryFolder;

TEST(SaliencyCommand, WritesASixteenBitMapThatIsBrightestAtTheOddSpot) {
  const TemporaryFolder folder;
  cv::Mat3b image(240, 320, cv::Vec3b(90, 90, 90));
  cv::circle(image, {200, 100}, 12, {0, 0, 255}, cv::FILLED);
  cv::imwrite(folder / "in.png", image);
  const auto run = runSaccade({"saliency", folder / "in.png", "-o", folder / "out.png"});
  ASSERT_EQ(run.exit_code, 0) << run.talk;
  const cv::Mat map = cv::imread(folder / "out.png", cv::IMREAD_UNCHANGED);
  ASSERT_EQ(map.type(), CV_16UC1);
  ASSERT_EQ(map.size(), image.size());
  double highest = 0.0;
  cv::Point where;
  cv::minMaxLoc(map, nullptr, &highest, nullptr, &where);
  EXPECT_EQ(highest, 65535.0);
  EXPECT_LT(cv::norm(where - cv::Point(200, 100)), 20.0);
}

TEST(SaliencyCommand, NamesPicturesThatCannotBeReadOrWritten) {
  const TemporaryFolder folder;
  auto run = runSaccade({"saliency", "no/such.png", "-o", folder / "out.png"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.talk.find("no/such.png"), std::string::npos);
  cv::imwrite(folder / "in.png", cv::Mat3b(50, 50, cv::Vec3b(1, 2, 3)));
  run = runSaccade({"saliency", folder / "in.png", "-o", "no/such/place/out.png"});
  EXPECT_EQ(run.exit_code, 1);
  EXPECT_NE(run.talk.find("no/such/place/out.png"), std::string::npos);
}

}  // namespace
}  // namespace saccade
