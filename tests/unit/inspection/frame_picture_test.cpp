#include "saccade/inspection/frame_picture.hpp"

#include <set>

#include <gtest/gtest.h>

namespace saccade {
namespace {

TEST(FramePicture, HasEvenSidesAndTheColourImageAtFullSizeOnTheLeft) {
  FramePanels panels;
  panels.color = cv::Mat3b(61, 81, cv::Vec3b(10, 20, 30));
  const cv::Mat3b picture = drawFramePicture(panels);
  EXPECT_EQ(picture.cols % 2, 0);
  EXPECT_EQ(picture.rows % 2, 0);
  EXPECT_EQ(picture(50, 40), cv::Vec3b(10, 20, 30));
}

TEST(FramePicture, ShowsInhibitedPixelsWhiteAndEachBoxInTheColourOfItsRank) {
  FramePanels panels;
  panels.color = cv::Mat3b(120, 160, cv::Vec3b(0, 0, 0));
  panels.inhibited = cv::Mat1b(120, 160, static_cast<uchar>(0));
  panels.inhibited(cv::Rect(80, 60, 80, 60)) = 255;
  panels.boxes = {{cv::Rect(40, 40, 30, 30), 0, false}};
  const cv::Mat3b picture = drawFramePicture(panels);
  EXPECT_EQ(picture(40, 160 + 80 + 60), cv::Vec3b(255, 255, 255));  // inside the inhibited quarter of the IOR panel
  EXPECT_EQ(picture(50, 160 + 80 + 10), cv::Vec3b(0, 0, 0));
  const cv::Scalar best = rankColor(0, 1);
  EXPECT_EQ(picture(69, 60), cv::Vec3b(cv::saturate_cast<uchar>(best[0]), cv::saturate_cast<uchar>(best[1]),
                                       cv::saturate_cast<uchar>(best[2])));
}

TEST(FramePicture, PaintsNeighbouringLabelsInDifferentColoursAndNoneBlack) {
  cv::Mat1i labels(1, 101);
  for (int u = 0; u < labels.cols; ++u) labels(0, u) = u - 1;
  const cv::Mat3b painted = paintLabels(labels);
  EXPECT_EQ(painted(0, 0), cv::Vec3b(0, 0, 0));
  std::set<int> colours;
  for (int u = 1; u < labels.cols; ++u) {
    EXPECT_NE(painted(0, u), painted(0, u - 1));
    colours.insert(painted(0, u)[0] << 16 | painted(0, u)[1] << 8 | painted(0, u)[2]);
  }
  EXPECT_GT(colours.size(), 95U);
}

}  // namespace
}  // namespace saccade
