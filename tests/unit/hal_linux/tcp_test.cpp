// SPDX-License-Identifier: Apache-2.0
// The pan-tilt driver and the emulated unit on the two ends of a TCP connection on this host.
#include <array>
#include <atomic>
#include <cstdio>
#include <thread>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include "hal/fake/flir_ptu_emulator.h"
#include "hal/linux/serial_byte_stream.h"
#include "hal/wire/pan_tilt/flir_ptu.h"
#include "hal/wire/reopening_byte_stream.h"
#include "tests/support/progress.h"

namespace mixrig::device {
namespace {

/// Listens on the loopback interface and answers as the unit, one connection after the other.
class NetworkUnit {
 public:
  NetworkUnit() : listener_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    if (::bind(listener_, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
        ::listen(listener_, 4) != 0 ||
        ::getsockname(listener_, reinterpret_cast<sockaddr*>(&address), &size) != 0)
      return;
    port_ = ntohs(address.sin_port);
    thread_ = std::thread([this] { work(); });
  }
  ~NetworkUnit() {
    stop_ = true;
    if (thread_.joinable()) thread_.join();
    ::close(listener_);
  }
  std::string name() const { return "tcp:127.0.0.1:" + std::to_string(port_); }
  void hang_up() { hang_up_ = true; }

 private:
  void work() {
    while (!stop_) {
      if (!readable(listener_)) continue;
      const int line = ::accept(listener_, nullptr, nullptr);
      answer(line);
      ::close(line);
    }
  }
  void answer(int line) {
    std::array<std::uint8_t, 256> bytes;
    while (!stop_ && !hang_up_.exchange(false)) {
      if (!readable(line)) continue;
      const ssize_t count = ::read(line, bytes.data(), bytes.size());
      if (count <= 0) return;
      clock_.advance(std::chrono::seconds(10));  // its axes have always arrived
      emulator_.receive({bytes.data(), static_cast<std::size_t>(count)}, clock_.now());
      std::string& out = emulator_.output();
      if (::send(line, out.data(), out.size(), MSG_NOSIGNAL) < 0) return;
      out.clear();
    }
  }
  static bool readable(int fd) {
    pollfd poll{fd, POLLIN, 0};
    return ::poll(&poll, 1, 20) > 0;
  }
  int listener_, port_ = 0;
  std::atomic<bool> stop_ = false, hang_up_ = false;
  fake::FlirPtuEmulator emulator_{11};
  ManualClock clock_;
  std::thread thread_;
};

TEST(FlirPtuOverTcp, MovesAndComesBackAfterALostConnection) {
  NetworkUnit unit;
  SystemClock clock;
  auto stream = ReopeningByteStream::make([&unit] { return open_byte_stream(unit.name()); }, clock);
  ASSERT_TRUE(stream) << to_line(stream.error());
  ASSERT_TRUE((*stream)->set_line({.baud = 9600}));
  auto opened = FlirPtu::open(*std::move(stream), clock, "flir-ptu:" + unit.name(), Duration(0));
  ASSERT_TRUE(opened) << to_line(opened.error());
  FlirPtu& head = **opened;
  const double step_rad = head.info().resolution.pan_rad;
  const auto reaches = [&](int steps) {
    if (!head.move_to({steps * step_rad, 0})) return false;
    const auto sample = head.sample();
    return sample && std::lround(sample->angles.pan_rad / step_rad) == steps;
  };
  for (const int steps : {500, -1200, 7}) EXPECT_TRUE(reaches(steps)) << steps;
  const HostTime begin = clock.now();
  for (int i = 0; i < 50; ++i) EXPECT_TRUE(head.sample());
  std::printf("  measured: %.0f positions a second over this host's TCP\n",
              50 / seconds(clock.now() - begin));
  EXPECT_GE(clock.now() - begin, 49 * std::chrono::milliseconds(2)) << "it is not flooded";
  unit.hang_up();
  EXPECT_TRUE(test::comes_true([&] { return reaches(300) && head.health().returns == 1; }));
}

TEST(TcpByteStream, AnAddressThatIsNoneAndAPortWhereNobodyListensAreNamed) {
  for (const char* name : {"tcp:", "tcp:host", "tcp:host:", "tcp:host:0", "tcp:host:65536",
                           "tcp:host:12x", "tcp::4000"}) {
    const auto stream = open_byte_stream(name);
    ASSERT_FALSE(stream) << name;
    EXPECT_EQ(stream.error().code, ErrorCode::kUsage) << name;
    EXPECT_NE(to_line(stream.error()).find("give tcp:HOST:PORT"), std::string::npos) << name;
  }
  const auto refused = open_byte_stream("tcp:127.0.0.1:1");
  ASSERT_FALSE(refused);
  EXPECT_NE(to_line(refused.error()).find("cannot connect to 127.0.0.1:1"), std::string::npos)
      << to_line(refused.error());
}

}  // namespace
}  // namespace mixrig::device
