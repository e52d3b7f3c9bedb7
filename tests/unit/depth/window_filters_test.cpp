// SPDX-License-Identifier: Apache-2.0
#include "host/capture/depth/window_filters.h"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig::depth {
namespace {

Image<float> picture(int width, const std::vector<float>& values) {
  Image<float> image;
  image.reset({width, static_cast<int>(values.size()) / width});
  for (std::size_t i = 0; i < values.size(); ++i)
    image.at(static_cast<int>(i) % width, static_cast<int>(i) / width) = values[i];
  return image;
}

Image<float> like(const Image<float>& image) {
  Image<float> out;
  out.reset(image.size());
  return out;
}

// One row, radius 2, sigma 1 px: the weights of equation 41 are 1, e^-1/2 and e^-2.
TEST(WindowFilters, GaussianIsTheMeanByItsWeights) {
  const Image<float> in = picture(5, {1, 2, 3, 4, 10});
  Image<float> out = like(in);
  gaussian(in.view(), {2}, out.view());
  const double near = std::exp(-0.5), far = std::exp(-2.0);
  EXPECT_NEAR(out.at(2, 0), (3 + near * (2 + 4) + far * (1 + 10)) / (1 + 2 * near + 2 * far), 1e-6);
  EXPECT_NEAR(out.at(0, 0), (1 + near * 2 + far * 3) / (1 + near + far), 1e-6);
}

TEST(WindowFilters, UnknownDepthsCountForNothingAndStayUnknown) {
  const Image<float> in = picture(3, {2, 0, 4, 2, 2, 0, 2, 2, 2});
  Image<float> out = like(in);
  for (const auto filter : {gaussian, median}) {
    filter(in.view(), {1}, out.view());
    EXPECT_EQ(out.at(1, 0), 0.0F);
    EXPECT_EQ(out.at(0, 1), 2.0F);
  }
  bilateral(in.view(), {1}, 0.1, out.view());
  EXPECT_EQ(out.at(1, 0), 0.0F);
  EXPECT_EQ(out.at(0, 1), 2.0F);
}

TEST(WindowFilters, MedianRemovesAnOutlierAndKeepsAnEdge) {
  const Image<float> in = picture(5, {1, 1, 5, 5, 5, 1, 9, 5, 5, 5, 1, 1, 5, 5, 5});
  Image<float> out = like(in);
  median(in.view(), {1}, out.view());
  EXPECT_EQ(out.at(1, 1), 1.0F) << "five of 1, three of 5, one of 9: the fifth is 1";
  EXPECT_EQ(out.at(2, 1), 5.0F);
  EXPECT_EQ(out.at(0, 1), 1.0F);
}

TEST(WindowFilters, BilateralSmoothsAndKeepsAnEdge) {
  const Image<float> in = picture(6, {1.00F, 1.02F, 1.00F, 2.00F, 2.02F, 2.00F});
  Image<float> out = like(in);
  bilateral(in.view(), {2}, 0.05, out.view());
  EXPECT_LT(std::abs(out.at(1, 0) - 1.0067F), 0.007F);
  EXPECT_NEAR(out.at(2, 0), 1.007, 0.007);
  EXPECT_NEAR(out.at(3, 0), 2.007, 0.007);
  bilateral(in.view(), {2}, 100, out.view());
  EXPECT_GT(out.at(2, 0), 1.2F) << "a wide f leaves the Gaussian";
}

// The colour edge is one pixel left of the depth edge: the filter moves the depth to it.
TEST(WindowFilters, JointBilateralMovesTheEdgeToThatOfTheColourAndFillsHoles) {
  const Image<float> in = picture(6, {1, 1, 1, 2, 2, 2, 1, 1, 0, 2, 2, 2, 1, 1, 1, 2, 2, 2});
  const Image<float> luma = picture(6, {0, 0, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1});
  Image<float> out = like(in);
  joint_bilateral(in.view(), luma.view(), {1}, 10, 0.05, out.view());
  EXPECT_NEAR(out.at(2, 1), 8.0 / 5, 1e-3) << "a hole: three of 2 and two of 1 of its own colour";
  EXPECT_NEAR(out.at(1, 1), 1.0, 1e-3);
  joint_bilateral(in.view(), luma.view(), {2}, 0.01, 0.05, out.view());
  EXPECT_NEAR(out.at(3, 0), 2.0, 1e-3) << "a narrow f keeps the depth edge";
}

TEST(WindowFilters, RadiusZeroChangesNothing) {
  const Image<float> in = picture(3, {1, 0, 3});
  Image<float> out = like(in);
  gaussian(in.view(), {0}, out.view());
  for (int x = 0; x < 3; ++x) EXPECT_EQ(out.at(x, 0), in.at(x, 0));
  bilateral(in.view(), {0}, 0.1, out.view());
  for (int x = 0; x < 3; ++x) EXPECT_EQ(out.at(x, 0), in.at(x, 0));
}

}  // namespace
}  // namespace mixrig::depth
