// SPDX-License-Identifier: Apache-2.0
// Bytes written by hand from the published layouts.
#include "extras/kinect2/kinect2_protocol.h"

#include <bit>
#include <cstring>
#include <string>

#include <gtest/gtest.h>

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

TEST(Kinect2Answers, TheColourLensIsThatOfThePictureAsSeen) {
  Bytes color{1};
  for (const float v : {1081.37F, 959.5F, 539.5F}) put_f32(color, v);
  color.resize(12981);
  const auto pinhole = parse_kinect2_color(color);
  ASSERT_TRUE(pinhole);
  EXPECT_NEAR(pinhole->cx_px, 960.0, 1e-3);
  EXPECT_NEAR(pinhole->cy_px, 539.0, 1e-3);
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
