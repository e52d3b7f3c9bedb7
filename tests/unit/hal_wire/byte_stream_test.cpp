// SPDX-License-Identifier: Apache-2.0
// The streams on real descriptors: a pty and a socket.
#include <array>
#include <thread>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include "firmware/port/sim/sim_line.h"
#include "hal/linux/posix_byte_stream.h"
#include "hal/linux/serial_byte_stream.h"
#include "tests/support/temporary_folder.h"

namespace mixrig::device {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST(ByteStreams, pty_carries_every_byte_value_both_ways) {
  const test::TemporaryFolder folder;
  std::string error;
  auto line = sim::SimLine::open_pty(folder.path() / "port", error);
  ASSERT_TRUE(line) << error;
  auto stream = open_byte_stream(folder.path() / "port");
  ASSERT_TRUE(stream) << to_line(stream.error());
  ASSERT_TRUE((*stream)->set_line({115'200, Parity::kEven}));
  std::array<std::uint8_t, 256> sent, got;
  for (std::size_t i = 0; i < 256; ++i) sent[i] = static_cast<std::uint8_t>(i);
  ASSERT_TRUE((*stream)->write(sent));
  std::size_t n = 0;
  while (n < 256) n += line->read(std::span(got).subspan(n), 1'000'000);
  EXPECT_EQ(got, sent);
  line->write(sent);
  got.fill(0);
  for (n = 0; n < 256;) {
    const auto read = (*stream)->read(std::span(got).subspan(n), seconds(1));
    ASSERT_TRUE(read);
    ASSERT_GT(*read, 0u);
    n += *read;
  }
  EXPECT_EQ(got, sent);
}

TEST(ByteStreams, no_bytes_is_no_error_but_a_hang_up_is) {
  int ends[2];
  ASSERT_EQ(socketpair(AF_UNIX, SOCK_STREAM, 0, ends), 0);
  PosixByteStream stream(ends[0], "pair");
  std::array<std::uint8_t, 4> out;
  EXPECT_EQ(*stream.read(out, milliseconds(0)), 0u);
  close(ends[1]);
  const auto read = stream.read(out, milliseconds(0));
  ASSERT_FALSE(read);
  EXPECT_EQ(read.error().code, ErrorCode::kDevice);
  EXPECT_NE(read.error().context.find("lost pair"), std::string::npos);
}

TEST(ByteStreams, missing_ports_are_one_line) {
  for (const char* name : {"unix:/nonexistent/socket", "/nonexistent/tty"}) {
    const auto stream = open_byte_stream(name);
    ASSERT_FALSE(stream);
    EXPECT_EQ(stream.error().code, ErrorCode::kNotFound) << to_line(stream.error());
  }
  EXPECT_FALSE(open_byte_stream("unix:/" + std::string(200, 'x')));
}

}  // namespace
}  // namespace mixrig::device
