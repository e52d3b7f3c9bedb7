// SPDX-License-Identifier: Apache-2.0
// Ports that are not there. What a stream does is its contract (tests/unit/hal_device).
#include <gtest/gtest.h>

#include "hal/linux/serial_byte_stream.h"

namespace mixrig::device {
namespace {

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
