// SPDX-License-Identifier: Apache-2.0
// Bytes written by hand from the published layouts.
#include <bit>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "hal/wire/camera/kinect2_raw.h"
#include "tests/support/kinect2_pictures.h"

namespace mixrig::device {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put_f32(Bytes& bytes, float number) {
  const auto v = std::bit_cast<std::uint32_t>(number);
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(v >> (8 * i)));
}

TEST(Kinect2Tables, TheLensIsThatOfThePictureAsSeen) {
  Bytes infrared;
  for (const float v : {365.5F, 366.0F, 0.0F, 258.0F, 206.5F, 0.09F, -0.27F, 0.001F, 0.002F, 0.1F})
    put_f32(infrared, v);
  infrared.resize(92);
  const auto lens = parse_kinect2_infrared(infrared);
  ASSERT_TRUE(lens) << to_line(lens.error());
  EXPECT_NEAR(lens->cx_px, 253.5, 1e-4);  // 511.5 - 258
  EXPECT_NEAR(lens->cy_px, 206.0, 1e-4);
  EXPECT_NEAR(lens->distortion[2], 0.001, 1e-6);
  EXPECT_NEAR(lens->distortion[3], -0.002, 1e-6);
  EXPECT_FALSE(parse_kinect2_infrared(std::span(infrared).first(91)));
  infrared[3] = 0x7F, infrared[2] = 0xC0;  // NaN
  EXPECT_FALSE(parse_kinect2_infrared(infrared));
}

TEST(Kinect2Tables, OffsetsAreMirroredAndBounded) {
  Bytes bytes(1302572);
  const auto put = [&](std::size_t table, std::size_t x, std::size_t y, std::uint16_t v) {
    const std::size_t at = 32 + table * 434180 + 2 + 2 * (y * 512 + x);
    bytes[at] = static_cast<std::uint8_t>(v), bytes[at + 1] = static_cast<std::uint8_t>(v >> 8);
  };
  put(0, 0, 0, 11), put(1, 511, 5, 22), put(2, 10, 423, 33);
  const auto offsets = parse_kinect2_offsets(bytes);
  ASSERT_TRUE(offsets);
  EXPECT_EQ((*offsets)[0].at(511, 0), 11);
  EXPECT_EQ((*offsets)[1].at(0, 5), 22);
  EXPECT_EQ((*offsets)[2].at(501, 423), 33);
  bytes.pop_back();
  EXPECT_FALSE(parse_kinect2_offsets(bytes));
}

TEST(Kinect2Samples, AllCodesAndPlacesAreRead) {
  test::Kinect2Pictures pictures;
  std::vector<int> expected(512 * 424);
  for (int y = 0; y < 424; y += 9)
    for (int x = 0; x < 512; ++x) {
      const int value = ((x * 37 + y * 101) % 32000) - 16000;
      const int code = test::kinect2_code(value);
      pictures.put(0, x, y, code);
      const int m = code & 1023;
      const int size = m < 256 ? m : (m % 128 + 128) * (1 << (m / 128 - 1));
      expected[static_cast<std::size_t>(y) * 512 + x] = code > 1023 ? -size : size;
    }
  pictures.put(0, 3, 306, 1024);
  expected[306 * 512 + 3] = kKinect2Saturated;
  std::array<std::int16_t, 512> row;
  for (int y = 0; y < 424; y += 9) {
    unpack_kinect2_row(std::span(pictures.bytes).first(kKinect2PictureBytes), y, row.data());
    for (int x = 0; x < 512; ++x)
      ASSERT_EQ(row[x], expected[static_cast<std::size_t>(y) * 512 + x]) << x << " " << y;
  }
}

/// Sends pictures in packets of at most 33792 bytes, each picture ended by an empty one.
struct Depth {
  Kinect2DepthStream stream;
  std::vector<std::pair<std::uint32_t, bool>> frames;
  std::uint32_t ticks = 0;
  Bytes last;
  Kinect2RawSink sink = [this](const Kinect2RawFrame& f) {
    frames.emplace_back(f.frame, f.whole), ticks = f.ticks;
    last.assign(f.pictures.begin(), f.pictures.end());
  };
  void send(std::uint32_t picture, std::uint32_t frame, int lost_packet = -1) {
    const Bytes content(kKinect2PictureBytes, static_cast<std::uint8_t>(picture + 10 * frame));
    const Bytes bytes = test::kinect2_packet(content.data(), picture, frame, 1000 + frame);
    int n = 0;
    for (std::size_t at = 0; at < bytes.size(); at += 33792, ++n)
      stream.feed(std::span(bytes).subspan(at, std::min<std::size_t>(33792, bytes.size() - at)),
                  n != lost_packet, sink);
    stream.feed({}, true, sink);
  }
};

TEST(Kinect2DepthStream, PutsTenPicturesTogether) {
  Depth d;
  for (std::uint32_t picture = 0; picture < 10; ++picture) d.send(picture, 4);
  ASSERT_EQ(d.frames.size(), 1U);
  EXPECT_EQ(d.frames[0], (std::pair<std::uint32_t, bool>(4, true)));
  EXPECT_EQ(d.ticks, 1004U);
  EXPECT_EQ(d.last[0], 40);
  EXPECT_EQ(d.last[9 * kKinect2PictureBytes], 49);
  EXPECT_EQ(d.stream.link_errors(), 0U);
}

TEST(Kinect2DepthStream, ALostPacketCostsItsFrameOnly) {
  Depth d;
  for (std::uint32_t frame = 1; frame <= 3; ++frame)
    for (std::uint32_t picture = 0; picture < 10; ++picture)
      d.send(picture, frame, frame == 2 && picture == 6 ? 3 : -1);
  ASSERT_EQ(d.frames.size(), 3U);
  EXPECT_TRUE(d.frames[0].second);
  EXPECT_EQ(d.frames[1], (std::pair<std::uint32_t, bool>(2, false)));
  EXPECT_TRUE(d.frames[2].second);
  EXPECT_EQ(d.stream.link_errors(), 1U);
}

TEST(Kinect2DepthStream, BytesTooMuchOrAFooterThatLiesAreErrors) {
  Depth d;
  const Bytes big(kKinect2PacketBytes + 1, 3);
  d.stream.feed(big, true, d.sink);
  EXPECT_EQ(d.stream.link_errors(), 1U);
  d.stream.feed({}, true, d.sink);
  d.send(10, 1);  // there is no eleventh picture
  EXPECT_EQ(d.stream.link_errors(), 2U);
  EXPECT_TRUE(d.frames.empty());
}

}  // namespace
}  // namespace mixrig::device
