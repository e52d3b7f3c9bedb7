// SPDX-License-Identifier: Apache-2.0
// FreeD packets against bytes that were put together by hand from the published layout.
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "extras/broadcast/packets/freed_receiver.h"
#include "tests/support/refusal.h"

namespace mixrig::stream {
namespace {

std::vector<std::byte> bytes_of(std::initializer_list<int> values) {
  std::vector<std::byte> bytes;
  for (const int value : values) bytes.push_back(static_cast<std::byte>(value));
  return bytes;
}

/// Camera 1; pan 12.5, tilt -3.25, roll 0.5 degrees; 1234.5, -2000, 1650.25 mm.
std::vector<std::byte> plain() {
  return bytes_of({0xD1, 0x01, 0x06, 0x40, 0x00, 0xFE, 0x60, 0x00, 0x00, 0x40,
                   0x00, 0x01, 0x34, 0xA0, 0xFE, 0x0C, 0x00, 0x01, 0x9C, 0x90,
                   0x0A, 0xBC, 0xDE, 0x01, 0x23, 0x45, 0x01, 0x02, 0x6E});
}

void set_checksum(std::vector<std::byte>& bytes) {
  unsigned sum = 0x40;
  for (std::size_t i = 0; i < 28; ++i) sum -= std::to_integer<unsigned>(bytes[i]);
  bytes[28] = static_cast<std::byte>(sum & 0xFF);
}

TEST(FreeD, ReadsTheValuesOfAPacket) {
  const auto packet = parse_freed(plain());
  ASSERT_TRUE(packet) << packet.error().context;
  constexpr double kDegree = M_PI / 180;
  EXPECT_EQ(packet->camera, 1);
  EXPECT_NEAR(packet->pan_rad, 12.5 * kDegree, 1e-12);
  EXPECT_NEAR(packet->tilt_rad, -3.25 * kDegree, 1e-12);
  EXPECT_NEAR(packet->roll_rad, 0.5 * kDegree, 1e-12);
  EXPECT_NEAR((packet->position_m - Eigen::Vector3d(1.2345, -2, 1.65025)).norm(), 0, 1e-12);
  EXPECT_EQ(packet->zoom, 0x0ABCDEU);
  EXPECT_EQ(packet->focus, 0x012345U);
  EXPECT_EQ(packet->user, 0x0102U);
  EXPECT_FALSE(packet->saturated);
  const auto again = freed_bytes(*packet);
  EXPECT_TRUE(std::equal(again.begin(), again.end(), plain().begin()));
}

TEST(FreeD, RefusesWhatIsDamaged) {
  for (std::size_t i = 0; i < kFreeDBytes; ++i) {
    auto damaged = plain();
    damaged[i] ^= std::byte{0x10};
    EXPECT_FALSE(parse_freed(damaged)) << i;
  }
  auto longer = plain();
  longer.push_back(std::byte{0});
  EXPECT_FALSE(parse_freed(longer));
  const auto whole = plain();
  for (std::size_t size = 0; size < kFreeDBytes; ++size)
    EXPECT_FALSE(parse_freed(std::span(whole).first(size))) << size;
  auto command = plain();
  command[0] = std::byte{0xD0};
  set_checksum(command);
  EXPECT_FALSE(parse_freed(command));
}

TEST(FreeD, SaturatesAndNeverWraps) {
  FreeDPacket far;
  far.pan_rad = 400 * M_PI / 180, far.tilt_rad = -400 * M_PI / 180;
  far.position_m = {200, -200, std::numeric_limits<double>::quiet_NaN()};
  const auto read = parse_freed(freed_bytes(far));
  ASSERT_TRUE(read) << read.error().context;
  EXPECT_TRUE(read->saturated);
  EXPECT_NEAR(read->pan_rad, 256 * M_PI / 180, 1e-6);
  EXPECT_NEAR(read->tilt_rad, -256 * M_PI / 180, 1e-6);
  EXPECT_NEAR(read->position_m.x(), 131.072, 1e-4);
  EXPECT_NEAR(read->position_m.y(), -131.072, 1e-4);
  EXPECT_EQ(read->position_m.z(), 0);
}

TEST(FreeDAddress, IsReadOrRefused) {
  const auto own = parse_freed_address("freed:6301");
  ASSERT_TRUE(own);
  EXPECT_EQ(own->host, "127.0.0.1");
  EXPECT_EQ(own->port, 6301);
  EXPECT_FALSE(own->number);
  const auto all = parse_freed_address("freed:0.0.0.0:40000,3");
  ASSERT_TRUE(all);
  EXPECT_EQ(all->host, "0.0.0.0");
  EXPECT_EQ(all->port, 40000);
  EXPECT_EQ(all->number, 3);
  for (const char* uri : {"", "freed", "freed:", "freed:0", "freed:70000", "freed:1x",
                          "freed:host:1", "freed::1", "freed:1,", "freed:1@", "freed:1@tracker",
                          "freed:1@10.0.0", "freed:1,256", "freed:1,-1", "fried:1"})
    EXPECT_FALSE(parse_freed_address(uri)) << uri;
}

/// Sends datagrams to a port of this machine.
class PacketSender {
 public:
  explicit PacketSender(int port) : fd_(::socket(AF_INET, SOCK_DGRAM, 0)) {
    to_.sin_family = AF_INET;
    to_.sin_port = htons(static_cast<std::uint16_t>(port));
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~PacketSender() { ::close(fd_); }
  void send(std::span<const std::byte> bytes) const {
    ASSERT_EQ(::sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_),
                       sizeof to_),
              static_cast<ssize_t>(bytes.size()));
  }

 private:
  int fd_;
  sockaddr_in to_{};
};

TEST(FreeDReceiver, ReadsItsCameraAndCountsTheRest) {
  auto receiver = FreeDReceiver::open({"127.0.0.1", 0, 1});
  ASSERT_TRUE(receiver) << receiver.error().context;
  const PacketSender sender(receiver->port());
  auto other = plain();
  other[1] = std::byte{2};
  set_checksum(other);
  auto longer = plain();
  longer.resize(60);
  auto damaged = plain();
  damaged[5] ^= std::byte{1};
  for (const auto& datagram : {plain(), other, longer, damaged, bytes_of({}), plain()})
    sender.send(datagram);
  int packets = 0;
  for (int i = 0; i < 6; ++i) {
    const auto packet = receiver->next(std::chrono::seconds(20));
    ASSERT_TRUE(packet) << packet.error().context;
    if (!*packet) continue;
    ++packets;
    EXPECT_EQ((*packet)->zoom, 0x0ABCDEU);
  }
  EXPECT_EQ(packets, 2);
  EXPECT_EQ(receiver->counts().packets, 2);
  EXPECT_EQ(receiver->counts().foreign, 1);
  EXPECT_EQ(receiver->counts().malformed, 3);
  EXPECT_FALSE(*receiver->next(Duration(0)));
}

TEST(FreeDReceiver, FollowsTheCameraOfTheFirstPacketAndTellsWhatItLeavesOut) {
  testing::internal::CaptureStderr();
  auto receiver = FreeDReceiver::open({"127.0.0.1", 0, {}});
  ASSERT_TRUE(receiver) << receiver.error().context;
  const PacketSender sender(receiver->port());
  auto other = plain(), without = plain();
  other[1] = std::byte{2};
  set_checksum(other);
  without[28] = std::byte{0};
  for (const auto& datagram : {plain(), other, without, other, without, plain()})
    sender.send(datagram);
  for (int i = 0; i < 6; ++i) {
    const auto packet = receiver->next(std::chrono::seconds(20));
    ASSERT_TRUE(packet) << packet.error().context;
    if (*packet) {
      EXPECT_EQ((*packet)->camera, 1);
    }
  }
  EXPECT_EQ(receiver->counts().packets, 2);
  EXPECT_EQ(receiver->counts().foreign, 2);
  const std::string said = testing::internal::GetCapturedStderr();
  EXPECT_NE(said.find("cameras 1 and 2 send to port"), std::string::npos) << said;
  EXPECT_NE(said.find("the checksum is 00, 6E was expected"), std::string::npos) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 2) << said;
}

TEST(FreeDReceiver, SeveralReadTheWholeStreamOfOnePort) {
  auto pose = FreeDReceiver::open({"127.0.0.1", 0, 1});
  ASSERT_TRUE(pose) << pose.error().context;
  auto lens = FreeDReceiver::open({"127.0.0.1", pose->port(), 1});
  auto other = FreeDReceiver::open({"127.0.0.1", pose->port(), 2});
  ASSERT_TRUE(lens && other) << lens.error().context;
  const PacketSender sender(pose->port());
  constexpr int kPackets = 50;
  for (int i = 0; i < kPackets; ++i) {
    FreeDPacket packet;
    packet.camera = 1 + i % 2;
    packet.zoom = static_cast<std::uint32_t>(i);
    sender.send(freed_bytes(packet));
  }
  const auto zooms = [](FreeDReceiver& receiver) {
    std::vector<std::uint32_t> read;
    for (int i = 0; i < kPackets; ++i)
      if (const auto packet = receiver.next(std::chrono::seconds(20)); packet && *packet)
        read.push_back((*packet)->zoom);
    return read;
  };
  std::vector<std::uint32_t> even, odd;
  for (std::uint32_t i = 0; i < kPackets; i += 2) even.push_back(i), odd.push_back(i + 1);
  EXPECT_EQ(zooms(*lens), even);
  EXPECT_EQ(zooms(*pose), even);
  EXPECT_EQ(zooms(*other), odd);
}

TEST(FreeDReceiver, ALeftReceiverDoesNotEndTheOthersAndThePortIsFreeAfterTheLast) {
  auto first = FreeDReceiver::open({"127.0.0.1", 0, {}});
  ASSERT_TRUE(first);
  const int port = first->port();
  auto second = FreeDReceiver::open({"127.0.0.1", port, {}});
  ASSERT_TRUE(second);
  first = Error{ErrorCode::kUsage, "closed"};
  PacketSender(port).send(plain());
  EXPECT_TRUE(*second->next(std::chrono::seconds(20)));
  second = Error{ErrorCode::kUsage, "closed"};
  EXPECT_TRUE(FreeDReceiver::open({"0.0.0.0", port, {}}));
}

TEST(FreeDReceiver, RefusesAPortThatIsTaken) {
  const auto first = FreeDReceiver::open({"127.0.0.1", 0, {}});
  ASSERT_TRUE(first);
  const std::string port = std::to_string(first->port());
  EXPECT_TRUE(test::refused(
      FreeDReceiver::open({"0.0.0.0", first->port(), {}}),
      {"cannot listen on 0.0.0.0:", "listens on 127.0.0.1:" + port, "camera.pose", "lens.uri"}));
  const int fd = ::socket(AF_INET, SOCK_DGRAM, 0);  // another program's
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof own;
  ASSERT_EQ(::bind(fd, reinterpret_cast<const sockaddr*>(&own), size), 0);
  ASSERT_EQ(::getsockname(fd, reinterpret_cast<sockaddr*>(&own), &size), 0);
  const auto taken = FreeDReceiver::open({"127.0.0.1", ntohs(own.sin_port), {}});
  ASSERT_FALSE(taken);
  EXPECT_NE(to_line(taken.error()).find("Address already in use"), std::string::npos)
      << to_line(taken.error());
  ::close(fd);
}

TEST(FollowedSender, KeepsTheFirstSenderUntilItIsSilent) {
  testing::internal::CaptureStderr();
  FollowedSender followed("FreeD", "cameras", {"127.0.0.1", 7000, {}});
  constexpr std::uint32_t kHead = 0xC0A80114, kOther = 0xC0A80115;
  for (int i = 0; i < 500; ++i) {  // two heads that say they are camera 1
    EXPECT_TRUE(followed.takes(1, kHead, 7000));
    EXPECT_FALSE(followed.takes(1, kOther, 7000));
    EXPECT_FALSE(followed.takes(2, kOther, 7000));
  }
  int refused = 0;
  while (!followed.takes(1, kOther, 7000)) ++refused;
  EXPECT_EQ(refused, FollowedSender::kSilent - 1) << "one came after the last one of the first";
  const std::string said = testing::internal::GetCapturedStderr();
  for (const char* part :
       {"192.168.1.20 and 192.168.1.21 send as 1 to port 7000", "like 7000,1@192.168.1.20",
        "cameras 1 and 2 send", "192.168.1.20 is silent: 192.168.1.21 is followed now"})
    EXPECT_NE(said.find(part), std::string::npos) << said;
  EXPECT_EQ(std::count(said.begin(), said.end(), '\n'), 3) << said;
}

TEST(FollowedSender, AStatedSenderIsTheOnlyOne) {
  const auto stated = parse_freed_address("freed:0.0.0.0:7000,1@192.168.1.20");
  ASSERT_TRUE(stated) << stated.error().context;
  EXPECT_EQ(stated->sender, 0xC0A80114U);
  EXPECT_EQ(parse_freed_address("freed:7000@10.0.0.1")->sender, 0x0A000001U);
  FollowedSender followed("FreeD", "cameras", *stated);
  for (int i = 0; i < 2 * FollowedSender::kSilent; ++i)
    EXPECT_FALSE(followed.takes(1, 0xC0A80115, 7000)) << "even where it came first, and alone";
  EXPECT_TRUE(followed.takes(1, 0xC0A80114, 7000));
  EXPECT_FALSE(followed.takes(2, 0xC0A80114, 7000));
}

}  // namespace
}  // namespace mixrig::stream
