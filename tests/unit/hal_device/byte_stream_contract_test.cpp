// SPDX-License-Identifier: Apache-2.0
// The contract of ByteStream, tested on a pty, a socket, the line to an emulated board, and, where
// MIXRIG_LOOPBACK_PORT names a port with TX wired to RX, on a real port.
#include <array>
#include <atomic>
#include <cstdlib>
#include <functional>
#include <memory>
#include <numeric>
#include <optional>
#include <ostream>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "firmware/port/sim/sim_line.h"
#include "hal/fake/emulated_board.h"
#include "hal/linux/posix_byte_stream.h"
#include "hal/linux/serial_byte_stream.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;

struct Exchange {
  Bytes question, answer;
};

struct StreamUnderTest {
  std::shared_ptr<void> keep;  ///< what must outlive the stream
  std::unique_ptr<device::ByteStream> stream;
  std::vector<Exchange> talk;     ///< questions and the other end's answers
  std::function<void()> hang_up;  ///< closes the other end; empty where the stream cannot notice it
};

struct StreamMaker {
  std::string name;
  std::function<StreamUnderTest()> make;
  friend void PrintTo(const StreamMaker& maker, std::ostream* out) { *out << maker.name; }
};

Bytes counting(std::size_t size) {
  Bytes bytes(size);
  std::iota(bytes.begin(), bytes.end(), std::uint8_t{0});
  return bytes;
}

std::vector<Exchange> echoes() {
  return {{{0}, {0}}, {counting(256), counting(256)}, {counting(3000), counting(3000)}};
}

/// The other end of a descriptor: echoes what it receives.
class Echo {
 public:
  explicit Echo(int fd) : fd_(fd), thread_([this] { work(); }) {}
  ~Echo() { hang_up(); }
  void hang_up() {
    if (!thread_.joinable()) return;
    ::shutdown(fd_, SHUT_RDWR);
    thread_.join();
    ::close(fd_);
  }

 private:
  void work() {
    std::array<std::uint8_t, 300> some;
    for (ssize_t n = 0; (n = ::read(fd_, some.data(), some.size())) > 0;) {
      if (::write(fd_, some.data(), static_cast<std::size_t>(n)) != n) return;
    }
  }
  int fd_;
  std::thread thread_;
};

StreamUnderTest make_socket() {
  int ends[2];
  if (::socketpair(AF_UNIX, SOCK_STREAM, 0, ends) != 0) return {};
  auto echo = std::make_shared<Echo>(ends[1]);
  return {echo, std::make_unique<device::PosixByteStream>(ends[0], "socket"), echoes(),
          [echo] { echo->hang_up(); }};
}

struct PtyBench {
  TemporaryFolder folder;
  std::string error;
  std::optional<sim::SimLine> line = sim::SimLine::open_pty(folder / "port", error);
  std::atomic<bool> stop = false;
  std::thread echo;
  ~PtyBench() {
    stop = true;
    if (echo.joinable()) echo.join();
  }
};

StreamUnderTest make_pty() {
  auto bench = std::make_shared<PtyBench>();
  if (!bench->line) return {};
  auto stream = device::open_byte_stream(bench->folder / "port");
  if (!stream) return {};
  bench->echo = std::thread([raw = bench.get()] {
    std::array<std::uint8_t, 300> some;
    while (!raw->stop) raw->line->write(std::span(some).first(raw->line->read(some, 20'000)));
  });
  return {bench, *std::move(stream), echoes(), [raw = bench.get()] {
            raw->stop = true;
            raw->echo.join();
            raw->line.reset();
          }};
}

StreamUnderTest make_board_line() {
  struct Bench {
    ManualClock clock;
    fake::EmulatedBoard board;
  };
  auto bench = std::make_shared<Bench>();
  bench->board.power_cycle(true);
  return {bench,
          std::make_unique<fake::BoardStream>(bench->board, bench->clock),
          {{{0x7F}, {0x79}}, {{0x02, 0xFD}, {0x79, 0x01, 0x04, 0x13, 0x79}}},
          {}};
}

StreamUnderTest make_loopback() {
  auto stream = device::SerialByteStream::open(std::getenv("MIXRIG_LOOPBACK_PORT"));
  if (!stream) return {};
  return {nullptr, *std::move(stream), echoes(), {}};
}

class ByteStreamContract : public ::testing::TestWithParam<StreamMaker> {
 protected:
  void SetUp() override {
    under_test_ = GetParam().make();
    ASSERT_TRUE(under_test_.stream);
  }
  device::ByteStream& stream() { return *under_test_.stream; }
  /// Reads `size` bytes, at most `piece` at a time.
  Bytes read(std::size_t size, std::size_t piece) {
    Bytes all, some(piece);
    for (int waits = 0; all.size() < size && waits < 200;) {
      const auto n = stream().read(some, milliseconds(100));
      EXPECT_TRUE(n) << to_line(n.error());
      if (!n) break;
      EXPECT_LE(*n, piece);
      all.insert(all.end(), some.begin(), some.begin() + static_cast<std::ptrdiff_t>(*n));
      waits = *n == 0 ? waits + 1 : 0;
    }
    return all;
  }
  void talk() {
    for (const Exchange& e : under_test_.talk) {
      ASSERT_TRUE(stream().write(e.question));
      EXPECT_EQ(read(e.answer.size(), 4096), e.answer);
    }
  }

  StreamUnderTest under_test_;
};

TEST_P(ByteStreamContract, CarriesEveryByteInOrder) { talk(); }

TEST_P(ByteStreamContract, KeepsBytesThatDidNotFitIntoARead) {
  for (const Exchange& e : under_test_.talk) {
    ASSERT_TRUE(stream().write(e.question));
    EXPECT_EQ(read(e.answer.size(), 1), e.answer);
  }
}

TEST_P(ByteStreamContract, NoBytesIsNoError) {
  std::array<std::uint8_t, 4> out;
  for (const milliseconds timeout : {milliseconds(0), milliseconds(20), milliseconds(-5)}) {
    const auto n = stream().read(out, timeout);
    ASSERT_TRUE(n) << to_line(n.error());
    EXPECT_EQ(*n, 0U);
  }
  EXPECT_TRUE(stream().write({}));
}

TEST_P(ByteStreamContract, AcceptsLineSettings) {
  for (int i = 0; i < 2; ++i) {
    ASSERT_TRUE(stream().set_line({115'200, device::Parity::kEven}));
    ASSERT_TRUE(stream().set_line({115'200, device::Parity::kEven}));
    ASSERT_TRUE(stream().set_line({}));
  }
  talk();
}

/// The contract of streams that notice a hang-up; a serial wire does not.
class HangUpContract : public ByteStreamContract {};

TEST_P(HangUpContract, AHangUpIsAnError) {
  under_test_.hang_up();
  std::array<std::uint8_t, 4> out;
  const auto n = stream().read(out, milliseconds(100));
  ASSERT_FALSE(n);
  EXPECT_EQ(n.error().code, ErrorCode::kDevice);
  EXPECT_NE(n.error().context.find("lost"), std::string::npos) << n.error().context;
  const auto written = stream().write(Bytes{1, 2, 3});
  ASSERT_FALSE(written);
  EXPECT_EQ(written.error().code, ErrorCode::kDevice);
}

/// ctest runs the first three; the last one only when this program is run by hand.
std::vector<StreamMaker> all_streams() {
  std::vector<StreamMaker> all = {
      {"socket", make_socket}, {"pty", make_pty}, {"board_line", make_board_line}};
  if (std::getenv("MIXRIG_LOOPBACK_PORT") != nullptr) all.push_back({"loopback", make_loopback});
  return all;
}

INSTANTIATE_TEST_SUITE_P(All, ByteStreamContract, ::testing::ValuesIn(all_streams()),
                         [](const auto& maker) { return maker.param.name; });

INSTANTIATE_TEST_SUITE_P(All, HangUpContract,
                         ::testing::Values(StreamMaker{"socket", make_socket},
                                           StreamMaker{"pty", make_pty}),
                         [](const auto& maker) { return maker.param.name; });

}  // namespace
}  // namespace mixrig::test
