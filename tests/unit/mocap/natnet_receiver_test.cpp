// SPDX-License-Identifier: Apache-2.0
// Frames over the loopback, from a server that was written apart from the receiver.
#include "host/pose/mocap/natnet_receiver.h"

#include <gtest/gtest.h>

#include "host/pose/mocap/mocap_poses.h"
#include "tests/support/natnet_sender.h"
#include "tests/support/progress.h"
#include "tests/support/throw_in.h"
#include "tests/unit/mocap/natnet_server.h"

namespace mixrig::stream {
namespace {

std::vector<std::byte> packet(int number) {
  return frame_with_body(number, 0.1F * static_cast<float>(number), number / 120.0, false)
      .packet(7);
}

NatNetAddress address_of(const NatNetServer& server) {
  return *parse_natnet_address("natnet:127.0.0.1:" + std::to_string(server.port()));
}

/// Reads until `last` has come; a minute is what a test may take, not what it needs.
std::vector<NatNetFrame> read_until(NatNetReceiver& receiver, int last) {
  std::vector<NatNetFrame> frames;
  for (int looks = 0; looks < 600 && (frames.empty() || frames.back().number != last); ++looks) {
    auto frame = receiver.next(std::chrono::milliseconds(100));
    EXPECT_TRUE(frame) << frame.error().context;
    if (frame && *frame) {
      frames.push_back(**frame);
      looks = 0;
    }
  }
  return frames;
}

TEST(NatNetAddress, IsReadOrRefused) {
  EXPECT_EQ(parse_natnet_address("natnet")->host, "127.0.0.1");
  EXPECT_EQ(parse_natnet_address("natnet:")->command_port, 1510);
  const auto whole = parse_natnet_address("natnet:studio-pc:2510,239.255.42.99:2511");
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->host, "studio-pc");
  EXPECT_EQ(whole->command_port, 2510);
  EXPECT_EQ(whole->group, "239.255.42.99");
  EXPECT_EQ(whole->data_port, 2511);
  EXPECT_EQ(parse_natnet_address("natnet,239.1.2.3")->host, "127.0.0.1");
  for (const char* uri : {"", "nat", "natnetx", "natnet:a:0", "natnet:a:70000", "natnet:a:1x",
                          "natnet:a:", "natnet:a,", "natnet:a,g:0", "natnet::5"})
    EXPECT_FALSE(parse_natnet_address(uri)) << uri;
}

TEST(NatNetReceiver, ReadsWhatAServerSendsAndCountsTheRest) {
  std::vector<std::byte> cut = packet(6);
  cut.resize(30);
  const NatNetServer server(
      {packet(1), packet(2), packet(2), packet(5), cut, packet(4), {std::byte{7}}, packet(7)});
  const SystemClock clock;
  auto receiver = NatNetReceiver::open(address_of(server), {4, 1}, clock);  // the server sends 3.0
  ASSERT_TRUE(receiver) << receiver.error().context;
  const auto frames = read_until(*receiver, 7);
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(frames[2].number, 5);
  EXPECT_NEAR(frames[2].bodies.at(0).world_from_body.translation_m.x(), 0.5, 1e-6);
  const NatNetCounts& counts = receiver->counts();
  EXPECT_EQ(counts.frames, 4);
  EXPECT_EQ(counts.lost, 2 + 1) << "3 and 4, then 6";
  EXPECT_EQ(counts.late, 2) << "2 twice, 4 after 5";
  EXPECT_EQ(counts.malformed, 2);
  EXPECT_EQ(counts.foreign, 0);
}

TEST(NatNetReceiver, AServerThatRestartsLosesNoFrameThatItNeverSent) {
  std::vector<std::vector<std::byte>> packets;
  for (int i = 1; i <= 100; ++i) packets.push_back(packet(i));
  for (int i = 1; i <= 20; ++i) packets.push_back(packet(i));  // numbers begin again
  packets.push_back(packet(2'000'000'000));                    // and jump
  const NatNetServer server(packets);
  const SystemClock clock;
  auto receiver = NatNetReceiver::open(address_of(server), {3, 0}, clock);
  ASSERT_TRUE(receiver) << receiver.error().context;
  const auto frames = read_until(*receiver, 2'000'000'000);
  EXPECT_EQ(frames.size(), 100U + 16U + 1U);
  EXPECT_EQ(receiver->counts().late, 4) << "the fifth in a row is no late one";
  EXPECT_EQ(receiver->counts().lost, 0);
}

TEST(NatNetReceiver, ASecondServerOnTheSameMachineIsForeignUntilTheFirstHasGone) {
  test::NatNetSender sender;
  ManualClock clock;
  NatNetAddress address;
  address.command_port = sender.port();
  auto receiver = NatNetReceiver::open(address, {3, 0}, clock);
  ASSERT_TRUE(receiver) << receiver.error().context;
  const auto look = [&] {
    auto frame = receiver->next(std::chrono::milliseconds(20));
    EXPECT_TRUE(frame) << frame.error().context;
    return frame && *frame ? (*frame)->number : 0;
  };
  const auto read = [&] {
    int number = 0;
    for (int i = 0; i < 100 && number == 0; ++i) number = look();
    return number;
  };
  ASSERT_TRUE(test::comes_true([&] { return look() == 0 && sender.has_client(1); }));
  sender.send(packet(10));
  EXPECT_EQ(read(), 10);
  sender.send_from_elsewhere(packet(500));
  sender.send(packet(11));
  EXPECT_EQ(read(), 11);
  EXPECT_EQ(receiver->counts().foreign, 1);
  EXPECT_EQ(receiver->counts().lost, 0);
  clock.advance(std::chrono::seconds(3));
  sender.send_from_elsewhere(packet(501));
  EXPECT_EQ(read(), 501);
  EXPECT_EQ(receiver->counts().foreign, 1);
}

TEST(NatNetReceiver, JoinsAGroup) {
  const NatNetServer server({packet(1), packet(2)}, true);
  NatNetAddress address = address_of(server);
  address.group = NatNetServer::kGroup;
  address.data_port = server.port();
  const SystemClock clock;
  auto receiver = NatNetReceiver::open(address, {3, 0}, clock);
  ASSERT_TRUE(receiver) << receiver.error().context;
  EXPECT_EQ(read_until(*receiver, 2).size(), 2U);
}

TEST(NatNetReceiver, ASilentServerIsNoErrorAndNoFrame) {
  NatNetAddress address;
  address.command_port = 9;  // no server there: the kernel refuses, and a later read returns that
  ManualClock clock;
  auto receiver = NatNetReceiver::open(address, {3, 0}, clock);
  ASSERT_TRUE(receiver);
  for (int i = 0; i < 3; ++i) {
    const auto frame = receiver->next(std::chrono::milliseconds(1));
    ASSERT_TRUE(frame) << frame.error().context;
    EXPECT_FALSE(frame->has_value());
    clock.advance(std::chrono::seconds(2));
  }
  address.host = "no such host.invalid";
  EXPECT_EQ(NatNetReceiver::open(address, {3, 0}, clock).error().code, ErrorCode::kNotFound);
}

TEST(MocapPoses, WhatItsThreadThrowsIsLoggedAndNoPoseIsKnown) {
  const NatNetServer server({packet(1)});
  const SystemClock clock;
  const test::ThrowIn thrown("receiving");
  pose::MocapOptions options;
  options.body_id = 1;
  const auto poses =
      pose::open_mocap_poses("127.0.0.1:" + std::to_string(server.port()), options, clock);
  ASSERT_TRUE(poses) << poses.error().context;
  EXPECT_TRUE(test::comes_true(
      [] { return test::logged("motion capture: receiving: no memory is left"); }));
  EXPECT_FALSE((*poses)->pose_of({}).ok());
}

}  // namespace
}  // namespace mixrig::stream
