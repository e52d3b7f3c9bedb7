// SPDX-License-Identifier: Apache-2.0
// Values of lens encoders received over the network, at mid-exposure.
#include "host/capture/live/session/lens_stream.h"

#include <array>
#include <thread>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "extras/broadcast/lens/freed_lens.h"
#include "tests/support/progress.h"
#include "tests/support/threaded_clock.h"
#include "tests/support/throw_in.h"
#include "tests/support/udp_listener.h"

namespace mixrig::live {
namespace {

using namespace std::chrono_literals;

/// A lens that sends its zoom to a stream.
class SentLens {
 public:
  explicit SentLens(Duration delay = {}) {
    auto receiver = stream::FreeDReceiver::open({"127.0.0.1", 0, 7});
    EXPECT_TRUE(receiver) << receiver.error().context;
    to_.sin_family = AF_INET;
    to_.sin_port = htons(static_cast<std::uint16_t>(receiver->port()));
    stream_.emplace(stream::make_freed_lens(*std::move(receiver)), delay, clock_);
    to_.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  }
  ~SentLens() { ::close(fd_); }

  /// Sends a packet now, and waits until it has come.
  void send(std::uint32_t zoom, int camera = 7) {
    stream::FreeDPacket packet;
    packet.camera = camera, packet.zoom = zoom, packet.focus = zoom + 1;
    const auto bytes = stream::freed_bytes(packet);
    ASSERT_EQ(::sendto(fd_, bytes.data(), bytes.size(), 0, reinterpret_cast<const sockaddr*>(&to_),
                       sizeof to_),
              static_cast<ssize_t>(bytes.size()));
  }
  void wait_for(HostTime at, double zoom) const {
    const auto begin = std::chrono::steady_clock::now();
    for (;;) {
      const auto seen = stream_->at(at);
      if (seen && seen->zoom == zoom) return;
      ASSERT_LT(std::chrono::steady_clock::now() - begin, 60s) << zoom << " did not come";
      std::this_thread::yield();
    }
  }
  std::optional<geometry::LensEncoders> at(HostTime time) const { return stream_->at(time); }
  test::ThreadedClock clock_;

 private:
  int fd_ = ::socket(AF_INET, SOCK_DGRAM, 0);
  sockaddr_in to_{};
  std::optional<LensStream> stream_;
};

TEST(LensStream, KnowsTheLensAtMidExposure) {
  SentLens lens;
  const HostTime first = lens.clock_.now();
  EXPECT_FALSE(lens.at(first));
  for (std::uint32_t i = 0; i < 300; ++i) {  // more than it keeps
    lens.send(1000 + 10 * i);
    lens.wait_for(lens.clock_.now(), 1000 + 10 * i);
    lens.clock_.advance(20ms);
  }
  const HostTime last = lens.clock_.now() - Duration(20ms);
  ASSERT_TRUE(lens.at(last - Duration(10ms)));
  EXPECT_NEAR(lens.at(last - Duration(10ms))->zoom, 3985, 1e-9);
  EXPECT_NEAR(lens.at(last - Duration(10ms))->focus, 3986, 1e-9);
  EXPECT_NEAR(lens.at(last + Duration(49ms))->zoom, 3990, 1e-9);
  EXPECT_FALSE(lens.at(last + Duration(51ms)));
  EXPECT_FALSE(lens.at(first)) << "older values are dropped";
}

TEST(LensStream, CountsFromWhenThePacketWasMade) {
  SentLens lens(Duration(30ms));
  const HostTime sent = lens.clock_.now();
  lens.send(5, 8);  // of another camera
  lens.send(6);
  lens.wait_for(sent - Duration(30ms), 6);
  EXPECT_FALSE(lens.at(sent + Duration(21ms)));
}

TEST(LensStream, WhatItsThreadThrowsIsLoggedAndNothingIsKnown) {
  const test::ThrowIn thrown("receiving");
  SentLens lens;
  EXPECT_TRUE(test::comes_true([] { return test::logged("lens: receiving: no memory is left"); }));
  lens.send(6);
  EXPECT_FALSE(lens.at(lens.clock_.now()));
}

TEST(LensStream, IsThereWhereTheRigHasOne) {
  const SystemClock clock;
  RigConfig rig;
  Devices devices;
  auto none = LensStream::open(rig, devices, clock);
  ASSERT_TRUE(none);
  EXPECT_EQ(*none, nullptr);
  const auto pose = stream::FreeDReceiver::open({"127.0.0.1", 0, {}});
  ASSERT_TRUE(pose);
  rig.file = "rig.toml";
  rig.lens_uri = "freed:" + std::to_string(pose->port());
  devices.lens = stream::freed_lens_kind().lens;
  const auto shared = LensStream::open(rig, devices, clock);
  ASSERT_TRUE(shared) << shared.error().context;
  EXPECT_NE(*shared, nullptr) << "the camera's pose comes by the same port";
  const test::UdpListener taken;  // by another program
  rig.lens_uri = "freed:" + taken.address();
  const auto refused = LensStream::open(rig, devices, clock);
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().context.rfind("rig.toml: lens.uri: FreeD: cannot listen", 0), 0U)
      << refused.error().context;
  EXPECT_NE(refused.error().context.find("Address already in use"), std::string::npos)
      << refused.error().context;
}

TEST(LensUri, IsCheckedBeforeDevicesAreOpened) {
  SystemClock clock;
  const std::array kinds{stream::freed_lens_kind()};
  RigConfig rig;
  rig.file = "rig.toml";
  rig.lens_uri = "freed:0";
  rig.trigger_uri = "no such trigger";
  const auto refused = open_devices(rig, DeviceOpener(clock, {}, kinds));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  EXPECT_EQ(refused.error().context.rfind("rig.toml: lens.uri: ", 0), 0U)
      << refused.error().context;
  EXPECT_NE(refused.error().context.find("is no address of FreeD"), std::string::npos);
  EXPECT_TRUE(DeviceOpener(clock, {}, kinds).lens("freed:0.0.0.0:6301,2"));
  const auto other = DeviceOpener(clock, {}, kinds).lens("morse:1");
  ASSERT_FALSE(other);
  EXPECT_NE(other.error().context.find("freed:[HOST:]PORT[,CAMERA]"), std::string::npos)
      << other.error().context;
}

}  // namespace
}  // namespace mixrig::live
