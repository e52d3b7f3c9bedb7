// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/markers/marker_blobs.h"

#include <cmath>

#include <gtest/gtest.h>

namespace mixrig::estimation {
namespace {

/// Adds a soft round spot.
void draw(Image<std::uint8_t>& picture, double x0, double y0, double radius, double peak = 240) {
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      const double d = std::hypot(x - x0, y - y0);
      const double cover = std::clamp(radius + 0.5 - d, 0.0, 1.0);
      picture.at(x, y) =
          static_cast<std::uint8_t>(std::max<double>(picture.at(x, y), std::round(peak * cover)));
    }
}

TEST(FindMarkerBlobs, CentresSpotsBelowAPixel) {
  Image<std::uint8_t> picture({64, 48}, 5);
  draw(picture, 20.3, 15.7, 4);
  draw(picture, 45.0, 30.25, 3);
  const auto blobs = find_marker_blobs(picture, {60, 4, 1000, 2, 2});
  ASSERT_EQ(blobs.size(), 2u);
  ASSERT_TRUE(blobs[0].usable() && blobs[1].usable());
  EXPECT_LT((blobs[0].value.centre_px - Eigen::Vector2d(20.3, 15.7)).norm(), 0.03);
  EXPECT_LT((blobs[1].value.centre_px - Eigen::Vector2d(45.0, 30.25)).norm(), 0.03);
  EXPECT_GT(blobs[0].covariance(0, 0), 0);
  EXPECT_LT(blobs[0].covariance(0, 0), 1e-3);
}

TEST(FindMarkerBlobs, SaysWhyABlobIsNoMarker) {
  Image<std::uint8_t> picture({80, 40}, 0);
  draw(picture, 1, 20, 4);                             // cut by the border
  draw(picture, 30, 20, 4), draw(picture, 37, 20, 4);  // grown together
  picture.at(60, 20) = 255;                            // one hot pixel
  const auto blobs = find_marker_blobs(picture, {60, 4, 1000, 2, 1.6});
  ASSERT_EQ(blobs.size(), 3u);
  for (const auto& blob : blobs) {
    EXPECT_FALSE(blob.usable());
    EXPECT_FALSE(blob.verdict.reason.empty());
  }
}

TEST(FindMarkerBlobs, BearsEmptyAndFullPictures) {
  EXPECT_TRUE(find_marker_blobs(Image<std::uint8_t>()).empty());
  EXPECT_TRUE(find_marker_blobs(Image<std::uint8_t>({20, 20}, 0)).empty());
  const auto full = find_marker_blobs(Image<std::uint8_t>({20, 20}, 255));
  ASSERT_EQ(full.size(), 1u);
  EXPECT_FALSE(full[0].usable());
}

}  // namespace
}  // namespace mixrig::estimation
