// SPDX-License-Identifier: Apache-2.0
// Messages against golden bytes, and which changes the hash of the table must and must not detect.
#include "firmware/protocol/messages.h"

#include <algorithm>
#include <random>
#include <set>
#include <vector>

#include <gtest/gtest.h>

#include "firmware/protocol/image_header.h"

namespace mixrig::protocol {
namespace {

using Bytes = std::vector<std::uint8_t>;

template <typename M>
Bytes write(const M& message) {
  Bytes out(wire_size<M>());
  EXPECT_EQ(write_message(message, out), out.size());
  return out;
}

TEST(Messages, golden_bytes) {
  SetChannel set;
  set.channel = 3;
  set.divider = 0x0104;
  set.phase_slots = 25;
  set.width_slots = 0x1234;
  set.flags = 3;
  EXPECT_EQ(write(set), (Bytes{0x03, 0x04, 0x01, 0x19, 0x00, 0x34, 0x12, 0x03}));
  EXPECT_EQ(write(Reboot{RebootTarget::kBootloader, kRebootKey}),
            (Bytes{0x01, 'B', 'O', 'O', 'T'}));
  EXPECT_EQ(write(TriggerTick{0x01020304, 0xA0B0C0D0, 0x8001}),
            (Bytes{0x04, 0x03, 0x02, 0x01, 0xD0, 0xC0, 0xB0, 0xA0, 0x01, 0x80}));
  EXPECT_EQ(write(TriggerEdge{5, 99, 15, 1}), (Bytes{5, 0, 0, 0, 99, 15, 1}));
}

TEST(Messages, frozen_messages_have_not_changed) {
  // Any host version must be able to send Hello and flash: these sizes never change.
  EXPECT_EQ(Hello::kId, 0x01);
  EXPECT_EQ(wire_size<Hello>(), 4u);
  EXPECT_EQ(wire_size<HelloReply>(), 29u);
  EXPECT_EQ(Reboot::kId, 0x31);
  EXPECT_EQ(wire_size<Reboot>(), 5u);
}

TEST(Messages, status_is_read_back_completely) {
  StatusReply sent;
  sent.state = State::kRunning;
  sent.enabled = 0x8421;
  sent.tick = 123456;
  sent.now_us = 0x0123456789ABCDEFull;
  sent.faults[static_cast<std::size_t>(Fault::kTickMissed)] = 77;
  StatusReply got;
  ASSERT_TRUE(read_message(write(sent), got));
  EXPECT_EQ(got.state, sent.state);
  EXPECT_EQ(got.enabled, sent.enabled);
  EXPECT_EQ(got.now_us, sent.now_us);
  EXPECT_EQ(got.faults, sent.faults);
}

TEST(Messages, wrong_length_is_refused) {
  SetChannel set;
  EXPECT_FALSE(read_message(Bytes(7), set));
  EXPECT_FALSE(read_message(Bytes(9), set));
  EXPECT_TRUE(read_message(Bytes(8), set));
}

template <typename... M>
std::vector<std::uint8_t> ids(std::tuple<M...>*) {
  return {M::kId...};
}

TEST(Messages, every_id_is_unique_and_encodes_its_direction) {
  const auto all = ids(static_cast<MessageTable*>(nullptr));
  EXPECT_EQ(std::set<std::uint8_t>(all.begin(), all.end()).size(), all.size());
  for (const std::uint8_t id : all) EXPECT_TRUE(id < 0x40 || id >= 0xC0);
}

struct Small {
  static constexpr std::uint8_t kId = 0x05;
  using Reply = Empty;
  std::uint16_t a = 0;
  static constexpr auto fields(auto& m) { return std::tie(m.a); }
};
struct Wide : Small {
  std::uint32_t b = 0;
  static constexpr auto fields(auto& m) { return std::tie(m.b); }
};
struct Moved : Small {
  static constexpr std::uint8_t kId = 0x06;
};
struct Answers : Small {
  using Reply = Small;
};

template <typename M>
constexpr std::uint32_t hash_of_one() {
  return detail::hash_table(static_cast<std::tuple<M>*>(nullptr));
}

TEST(Messages, table_hash_depends_on_id_size_and_reply) {
  const std::set<std::uint32_t> hashes = {hash_of_one<Small>(), hash_of_one<Wide>(),
                                          hash_of_one<Moved>(), hash_of_one<Answers>()};
  EXPECT_EQ(hashes.size(), 4u);
}

TEST(ImageHeader, has_the_layout_that_the_host_expects) {
  EXPECT_EQ(offsetof(ImageHeader, size) + kHeaderOffset, kSizeField);
  EXPECT_EQ(offsetof(ImageHeader, crc) + 4 + kHeaderOffset, kAfterCrc);
  EXPECT_EQ(offsetof(ImageHeader, board), 16u);
}

TEST(ImageHeader, crc_excludes_exactly_size_and_crc) {
  std::mt19937 random(5);
  Bytes image(kHeaderOffset + 400);
  std::generate(image.begin(), image.end(), [&] { return static_cast<std::uint8_t>(random()); });
  const std::uint32_t before = image_crc(image);
  for (std::size_t i = 0; i < image.size(); ++i) {
    Bytes changed = image;
    changed[i] ^= 1;
    const bool left_out = i >= kSizeField && i < kAfterCrc;
    ASSERT_EQ(image_crc(changed) == before, left_out) << i;
  }
}

}  // namespace
}  // namespace mixrig::protocol
