// SPDX-License-Identifier: Apache-2.0
// Bytes written by hand from the published layouts.
#include <bit>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

#include "hal/wire/camera/kinect2_streams.h"
#include "tests/support/kinect2_pictures.h"

namespace mixrig::device {
namespace {

using Bytes = std::vector<std::uint8_t>;

void put_u32(Bytes& bytes, std::uint32_t v) {
  for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<std::uint8_t>(v >> (8 * i)));
}
void put_f32(Bytes& bytes, float v) { put_u32(bytes, std::bit_cast<std::uint32_t>(v)); }

TEST(Kinect2Command, HasHeaderAndParameters) {
  const Kinect2Request request{.command = Kinect2Command::kPage,
                               .parameters = {2},
                               .parameter_count = 1,
                               .most_answer = 0x1C0000};
  Bytes expected;
  for (const std::uint32_t v : {0x06022009U, 7U, 0x1C0000U, 0x22U, 0U, 2U}) put_u32(expected, v);
  EXPECT_EQ(pack_kinect2_request(request, 7), expected);
}

TEST(Kinect2Answers, CompletionIsKnownByItsMagic) {
  Bytes bytes;
  for (const std::uint32_t v : {0x0A6FE000U, 9U, 0U, 0U}) put_u32(bytes, v);
  EXPECT_EQ(parse_kinect2_complete(bytes), 9U);
  bytes[0] = 1;
  EXPECT_FALSE(parse_kinect2_complete(bytes));
  EXPECT_FALSE(parse_kinect2_complete(std::span(bytes).first(12)));
}

TEST(Kinect2Answers, SerialFirmwareAndStatus) {
  Bytes serial;
  for (const char c : std::string("0123457A"))
    serial.push_back(static_cast<std::uint8_t>(c)), serial.push_back(0);
  serial.resize(0x80);
  EXPECT_EQ(parse_kinect2_serial(serial).value(), "0123457A");
  EXPECT_FALSE(parse_kinect2_serial(Bytes(4)));
  EXPECT_FALSE(parse_kinect2_serial(Bytes(0x80, 7)));
  Bytes versions(48);
  for (const std::uint32_t v : {4U << 16 | 3U, 3911U, 7U, 0U}) put_u32(versions, v);
  EXPECT_EQ(parse_kinect2_firmware(versions).value(), "4.3.3911.7");
  EXPECT_FALSE(parse_kinect2_firmware(std::span(versions).first(59)));
  EXPECT_FALSE(parse_kinect2_status(Bytes(3)));
  EXPECT_EQ(parse_kinect2_status(Bytes{1, 2, 0, 0}).value(), 0x201U);
}

TEST(Kinect2Answers, LensesAreThoseOfThePictureAsSeen) {
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
  Bytes color{1};
  for (const float v : {1081.37F, 959.5F, 539.5F}) put_f32(color, v);
  color.resize(12981);
  const auto pinhole = parse_kinect2_color(color);
  ASSERT_TRUE(pinhole);
  EXPECT_NEAR(pinhole->cx_px, 960.0, 1e-3);
  EXPECT_NEAR(pinhole->cy_px, 539.0, 1e-3);
}

TEST(Kinect2Answers, OffsetsAreMirroredAndBounded) {
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

Bytes color_packet(std::uint32_t frame, std::size_t jpeg, int padding, std::uint32_t filler) {
  Bytes bytes;
  put_u32(bytes, frame), put_u32(bytes, 0x42424242);
  bytes.resize(bytes.size() + jpeg - 2, 0x11);
  bytes.push_back(0xFF), bytes.push_back(0xD9);
  bytes.resize(bytes.size() + static_cast<std::size_t>(padding), 0xA5);
  bytes.resize(bytes.size() + filler, 'Z');
  const auto size = static_cast<std::uint32_t>(bytes.size() + 56);
  for (const std::uint32_t v : {0x39393939U, frame, filler, 0U, 0U, 8000U}) put_u32(bytes, v);
  put_f32(bytes, 12.5F), put_f32(bytes, 1);
  put_u32(bytes, 0x42424242), put_u32(bytes, size), put_f32(bytes, 1);
  for (int i = 0; i < 3; ++i) put_u32(bytes, 0);
  return bytes;
}

TEST(Kinect2ColorStream, FindsTheJpegInsideAPacket) {
  Kinect2ColorStream stream;
  int packets = 0;
  const auto sink = [&](const Kinect2ColorPacket& p) {
    ++packets;
    EXPECT_EQ(p.jpeg.size(), 50000U);
    EXPECT_EQ(p.frame, 5U);
    EXPECT_EQ(p.ticks, 8000U);
    EXPECT_EQ(p.exposure_ms, 12.5);
  };
  const Bytes bytes = color_packet(5, 50000, 3, 1000);
  for (std::size_t at = 0; at < bytes.size(); at += 16384)
    stream.feed(std::span(bytes).subspan(at, std::min<std::size_t>(16384, bytes.size() - at)),
                sink);
  EXPECT_EQ(packets, 1);
  EXPECT_EQ(stream.link_errors(), 0U);
}

TEST(Kinect2ColorStream, ContradictionsAreErrorsAndTheNextPacketIsRead) {
  Kinect2ColorStream stream;
  int packets = 0;
  const auto sink = [&](const Kinect2ColorPacket&) { ++packets; };
  Bytes torn = color_packet(1, 3060, 0, 0);
  torn.erase(torn.begin() + 500, torn.begin() + 600);
  stream.feed(torn, sink);
  Bytes long_filler = color_packet(2, 3060, 0, 0);
  long_filler[8 + 3060 + 8] = 0xFF, long_filler[8 + 3060 + 9] = 0xFF;
  stream.feed(long_filler, sink);
  const Bytes endless(16384, 1);
  for (int i = 0; i < 200; ++i) stream.feed(endless, sink);
  stream.feed(color_packet(3, 3060, 1, 0), sink);  // ends what was too long
  EXPECT_EQ(packets, 0);
  EXPECT_EQ(stream.link_errors(), 3U);
  stream.feed(color_packet(4, 3060, 0, 0), sink);
  EXPECT_EQ(packets, 1);
}

}  // namespace
}  // namespace mixrig::device
