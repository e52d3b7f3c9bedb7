// SPDX-License-Identifier: Apache-2.0
// The picture of each view, pixel by pixel.
#include "host/output/viewfinder/picture.h"

#include <limits>

#include <gtest/gtest.h>

#include "tests/unit/viewfinder/made_composite.h"

namespace mixrig::viewfinder {
namespace {

Rgb8 rgb(Rgbx8 p) { return {p.r, p.g, p.b}; }

Image<Rgbx8> drawn(const output::Composite& composite, View view) {
  Image<Rgbx8> picture;
  EXPECT_TRUE(draw_view(composite, view, {.near_m = 1, .far_m = 5}, picture)) << name(view);
  return picture;
}

TEST(ViewPicture, CompositeAndPlateAreTheImagesThemselves) {
  const auto made = made_composite();
  const Image<Rgbx8> composite = drawn(*made, View::kComposite);
  EXPECT_EQ(rgb(composite.at(150, 100)), made_color(150, 100));
  EXPECT_EQ(rgb(composite.at(0, 119)), made_color(0, 119));
  const Image<Rgbx8> plate = drawn(*made, View::kPlate);
  EXPECT_EQ(plate.size(), (Size{80, 60}));
  EXPECT_EQ(rgb(plate.at(79, 59)), kMadePlate);
}

TEST(ViewPicture, KeyMatteAndLight) {
  const auto made = made_composite();
  auto& images = made->images;
  images.state.at(1, 1) = static_cast<std::uint8_t>(render::PixelState::kForeground);
  images.light.at(1, 1) = 0, images.light.at(2, 1) = 0.5F, images.light.at(3, 1) = 7;
  EXPECT_EQ(rgb(drawn(*made, View::kKey).at(1, 1)), (Rgb8{255, 255, 255}));
  EXPECT_EQ(rgb(drawn(*made, View::kKey).at(2, 1)), (Rgb8{250, 200, 60})) << "an edge is yellow";
  EXPECT_EQ(rgb(drawn(*made, View::kMatte).at(9, 9)), (Rgb8{200, 200, 200}));
  const Image<Rgbx8> light = drawn(*made, View::kLight);
  EXPECT_EQ(rgb(light.at(1, 1)), (Rgb8{0, 0, 0}));
  EXPECT_NEAR(light.at(2, 1).r, 188, 1) << "half of the light in sRGB";
  EXPECT_EQ(rgb(light.at(3, 1)), (Rgb8{255, 255, 255}));
}

TEST(ViewPicture, DepthIsWarmNearColdFarAndBlackWhereUnknown) {
  const auto made = made_composite();
  auto& depth_m = made->images.mixed_depth_m;
  depth_m.at(0, 0) = 0, depth_m.at(1, 0) = std::numeric_limits<float>::quiet_NaN();
  depth_m.at(2, 0) = 1, depth_m.at(3, 0) = 5, depth_m.at(4, 0) = 1e9F;
  const Image<Rgbx8> picture = drawn(*made, View::kDepth);
  EXPECT_EQ(rgb(picture.at(0, 0)), (Rgb8{0, 0, 0}));
  EXPECT_EQ(rgb(picture.at(1, 0)), (Rgb8{0, 0, 0}));
  EXPECT_GT(picture.at(2, 0).r, 2 * picture.at(2, 0).b);
  EXPECT_GT(picture.at(3, 0).b, picture.at(3, 0).r);
  EXPECT_EQ(rgb(picture.at(4, 0)), rgb(picture.at(3, 0)));
}

TEST(ViewPicture, AnImageThatIsNotThereLeavesThePicture) {
  const auto made = made_composite();
  made->images.wanted = render::kColor | render::kMatte;  // as of an earlier view
  Image<Rgbx8> picture({5, 5}, Rgbx8{1, 2, 3, 4});
  for (const View view : {View::kKey, View::kDepth, View::kLight}) {
    EXPECT_FALSE(draw_view(*made, view, {}, picture)) << name(view);
    EXPECT_EQ(picture.size(), (Size{5, 5}));
    EXPECT_EQ(picture.at(4, 4).x, 4);
  }
}

TEST(ViewPicture, EveryViewHasANameAndAsksForAnImage) {
  for (std::size_t i = 0; i < kViews; ++i) {
    const auto view = static_cast<View>(i);
    EXPECT_EQ(output::view_named(name(view)), view);
    EXPECT_NE(images_of(view), 0U);
  }
  EXPECT_EQ(output::view_named("colour"), std::nullopt);
}

}  // namespace
}  // namespace mixrig::viewfinder
