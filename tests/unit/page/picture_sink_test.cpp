// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/pictures/picture_sink.h"

#include <gtest/gtest.h>

#include "host/math/image_io/image_io.h"

namespace mixrig::page {
namespace {

output::CompositePtr composite_of(const Image<Rgb8>& color, int number) {
  auto composite = std::make_shared<output::Composite>();
  auto capture = std::make_shared<capture::Capture>();
  capture->number = number;
  capture->mid_exposure = HostTime(Duration(1000 * number));
  capture->plate = color;
  composite->capture = capture;
  composite->images.color = color;
  composite->images.matte.reset(color.size(), 255);
  composite->images.mixed_depth_m.reset(color.size(), 2.0F);
  composite->images.wanted = render::kComposite;
  return composite;
}

Image<Rgb8> ramp() {
  Image<Rgb8> image({64, 48});
  for (int y = 0; y < 48; ++y)
    for (int x = 0; x < 64; ++x)
      image.at(x, y) = {static_cast<std::uint8_t>(4 * x), static_cast<std::uint8_t>(5 * y), 100};
  return image;
}

TEST(PagePictures, NothingIsMadeWhileNobodyLooks) {
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  auto pictures = std::make_shared<Pictures>(orders);
  PictureSink sink(pictures);
  EXPECT_EQ(sink.wanted(1), 0U);
  ASSERT_TRUE(sink.write(composite_of(ramp(), 1)));
  EXPECT_EQ(pictures->newest(View::kComposite), nullptr);
  pictures->look(View::kComposite);
  EXPECT_EQ(sink.wanted(1), render::kColor);
  pictures->look(View::kLight);
  EXPECT_EQ(sink.wanted(1), render::kColor | render::kLight);
  ASSERT_TRUE(orders.give(output::FreezePictures{true}));
  EXPECT_EQ(sink.wanted(1), 0U);
  ASSERT_TRUE(orders.give(output::FreezePictures{false}));
  pictures->look_away(View::kLight);
  pictures->look_away(View::kComposite);
  EXPECT_EQ(sink.wanted(1), 0U);
}

TEST(PagePictures, TheJpegShowsTheComposite) {
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  auto pictures = std::make_shared<Pictures>(orders);
  PictureSink sink(pictures);
  pictures->look(View::kComposite);
  ASSERT_TRUE(sink.write(composite_of(ramp(), 5)));
  ASSERT_TRUE(sink.write(composite_of(ramp(), 6)));
  const PicturePtr newest = pictures->newest(View::kComposite);
  ASSERT_NE(newest, nullptr);
  EXPECT_EQ(newest->serial, 2U);
  EXPECT_EQ(newest->frame, 6);
  EXPECT_EQ(newest->mid_exposure, HostTime(Duration(6000)));
  Image<Rgb8> read;
  ASSERT_TRUE(image_io::decode_rgb8(reinterpret_cast<const std::uint8_t*>(newest->jpeg.data()),
                                    newest->jpeg.size(), "jpeg", read));
  ASSERT_EQ(read.size(), ramp().size());
  double sum = 0;
  for (int y = 0; y < read.height(); ++y)
    for (int x = 0; x < read.width(); ++x) sum += std::abs(read.at(x, y).r - ramp().at(x, y).r);
  EXPECT_LT(sum / 3072, 4) << "mean difference of red";
}

TEST(PagePictures, EachViewIsMadeOfItsImage) {
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  auto pictures = std::make_shared<Pictures>(orders);
  PictureSink sink(pictures);
  for (const View view : {View::kPlate, View::kDepth, View::kMatte, View::kKey})
    pictures->look(view);
  ASSERT_TRUE(sink.write(composite_of(ramp(), 1)));
  EXPECT_NE(pictures->newest(View::kPlate), nullptr);
  EXPECT_NE(pictures->newest(View::kDepth), nullptr);
  EXPECT_NE(pictures->newest(View::kMatte), nullptr);
  // This frame was composited before anybody requested the key: it has no key states.
  EXPECT_EQ(pictures->newest(View::kKey), nullptr);
}

}  // namespace
}  // namespace mixrig::page
