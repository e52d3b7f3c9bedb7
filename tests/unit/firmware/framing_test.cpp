// SPDX-License-Identifier: Apache-2.0
// The wire codec against golden bytes, an independent bitwise CRC, and a million damaged frames.
#include "firmware/protocol/framing.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <random>
#include <vector>

#include <gtest/gtest.h>

namespace mixrig::protocol {
namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes encode(std::uint8_t type, std::uint8_t sequence, const Bytes& body) {
  std::array<std::uint8_t, kMaxWire> wire;
  const std::size_t n = encode_frame(type, sequence, body, wire);
  return {wire.begin(), wire.begin() + static_cast<long>(n)};
}

/// Bit by bit, from the definition.
unsigned slow_crc16(const Bytes& data) {
  unsigned c = 0xFFFF;
  for (const unsigned byte : data) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      const bool feedback = ((c >> 15) ^ (byte >> (7 - bit))) & 1u;
      c = (c << 1 & 0xFFFFu) ^ (feedback ? 0x1021u : 0u);
    }
  }
  return c;
}

struct Decoded {
  std::uint8_t type;
  std::uint8_t sequence;
  Bytes body;
  bool operator==(const Decoded&) const = default;
};

struct Outcome {
  std::vector<Decoded> frames;
  int bad = 0;
  int probes = 0;
};

Outcome decode(const Bytes& wire) {
  FrameDecoder decoder;
  Outcome out;
  for (const std::uint8_t byte : wire) {
    switch (decoder.push(byte)) {
      case FrameEvent::kFrame:
        out.frames.push_back(
            {decoder.type(), decoder.sequence(), {decoder.body().begin(), decoder.body().end()}});
        break;
      case FrameEvent::kBad:
        ++out.bad;
        break;
      case FrameEvent::kProbe:
        ++out.probes;
        break;
      case FrameEvent::kNone:
        break;
    }
  }
  return out;
}

TEST(Crc, matches_published_check_values) {
  const Bytes digits = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  EXPECT_EQ(crc16(digits), 0x29B1);
  EXPECT_EQ(crc32(digits), 0xCBF43926u);
}

TEST(Crc, crc16_matches_bitwise_definition) {
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    Bytes data(random() % 80);
    std::generate(data.begin(), data.end(), [&] { return static_cast<std::uint8_t>(random()); });
    ASSERT_EQ(crc16(data), slow_crc16(data));
  }
}

TEST(Crc, crc32_continues_over_pieces) {
  const Bytes digits = {'1', '2', '3', '4', '5', '6', '7', '8', '9'};
  const std::span<const std::uint8_t> all(digits);
  EXPECT_EQ(crc32(all.subspan(4), crc32(all.first(4))), crc32(digits));
}

TEST(Framing, golden_bytes) {
  // crc16(02 07) = 0x0B8A and crc16(12 00 00 05) = 0x22AA, computed with Python's binascii.crc_hqx.
  EXPECT_EQ(encode(0x02, 0x07, {}), (Bytes{0x00, 0x05, 0x02, 0x07, 0x8A, 0x0B, 0x00}));
  EXPECT_EQ(encode(0x12, 0x00, {0x00, 0x05}),
            (Bytes{0x00, 0x02, 0x12, 0x01, 0x04, 0x05, 0xAA, 0x22, 0x00}));
}

TEST(Framing, every_length_is_decoded_unchanged) {
  std::mt19937 random(2);
  for (std::size_t n = 0; n <= kMaxBody; ++n) {
    for (int i = 0; i < 100; ++i) {
      Bytes body(n);
      for (auto& byte : body) byte = random() % 3 ? static_cast<std::uint8_t>(random()) : 0;
      const auto type = static_cast<std::uint8_t>(random());
      const Bytes wire = encode(type, 9, body);
      ASSERT_EQ(std::count(wire.begin(), wire.end(), 0), 2);
      ASSERT_EQ(decode(wire).frames, (std::vector<Decoded>{{type, 9, body}}));
    }
  }
}

TEST(Framing, refuses_a_body_that_is_too_long) {
  EXPECT_TRUE(encode(0x02, 0, Bytes(kMaxBody + 1)).empty());
}

TEST(Framing, a_damaged_frame_does_not_harm_the_next) {
  Bytes wire = encode(0x02, 1, {1, 2, 3});
  wire[3] ^= 0x10;
  const Bytes good = encode(0x02, 2, {4, 5});
  wire.insert(wire.end(), good.begin(), good.end());
  const Outcome out = decode(wire);
  EXPECT_EQ(out.bad, 1);
  EXPECT_EQ(out.frames, (std::vector<Decoded>{{0x02, 2, {4, 5}}}));
}

TEST(Framing, overlong_frame_is_bad_and_bounded) {
  Bytes wire(1000, 0x55);
  wire.push_back(0);
  EXPECT_EQ(decode(wire).bad, 1);
}

TEST(Framing, typed_probe_is_distinguished_from_a_frame) {
  EXPECT_EQ(decode({'?', '\r'}).probes, 1);
  EXPECT_EQ(decode({0x00, '?', '\n'}).probes, 1);
  EXPECT_EQ(decode({'x', '?', '\n'}).probes, 0);
}

TEST(Framing, random_bytes_never_overrun_and_seldom_pass) {
  std::mt19937 random(3);
  Bytes noise(2'000'000);
  for (auto& byte : noise) byte = random() % 20 ? static_cast<std::uint8_t>(random()) : 0;
  const Outcome out = decode(noise);
  EXPECT_GT(out.bad, 50'000);
  // Each bad frame passes with a probability of 2^-16; the limit is five sigma above that.
  const double expected = out.bad / 65536.0;
  EXPECT_LE(static_cast<double>(out.frames.size()), expected + 5 * std::sqrt(expected) + 1);
}

TEST(Framing, a_million_damaged_frames_pass_no_more_often_than_the_crc_allows) {
  std::mt19937 random(4);
  FrameDecoder decoder;
  int accepted = 0;
  constexpr int kFrames = 1'000'000;
  for (int i = 0; i < kFrames; ++i) {
    Bytes body(random() % 20);
    for (auto& byte : body) byte = static_cast<std::uint8_t>(random() % 4 ? random() : 0);
    const Bytes sent = encode(0x10, static_cast<std::uint8_t>(i), body);
    Bytes wire = sent;
    const unsigned faults = 1 + random() % 4;
    for (unsigned f = 0; f < faults || wire == sent; ++f) {
      wire[random() % wire.size()] = static_cast<std::uint8_t>(random());
    }
    for (const std::uint8_t byte : wire) {
      if (decoder.push(byte) != FrameEvent::kFrame) continue;
      const bool same =
          decoder.type() == 0x10 && decoder.sequence() == static_cast<std::uint8_t>(i) &&
          std::equal(body.begin(), body.end(), decoder.body().begin(), decoder.body().end());
      accepted += !same;
    }
  }
  const double expected = kFrames / 65536.0;
  std::printf("%d damaged frames: %d accepted, a 16-bit check would let %.1f pass\n", kFrames,
              accepted, expected);
  EXPECT_LE(accepted, expected + 5 * std::sqrt(expected));
}

}  // namespace
}  // namespace mixrig::protocol
