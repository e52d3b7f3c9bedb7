// SPDX-License-Identifier: Apache-2.0
#include "host/output/datagrams/datagram_sender.h"

#include <gtest/gtest.h>

#include "tests/support/refusal.h"
#include "tests/support/udp_listener.h"

namespace mixrig::stream {
namespace {

TEST(DatagramSender, SendsEachTextAsADatagram) {
  test::UdpListener listener;
  auto sender = DatagramSender::open("localhost:" + std::to_string(listener.port()));
  ASSERT_TRUE(sender) << sender.error().context;
  sender->send("one"), sender->send("two");
  EXPECT_EQ(listener.awaited(), "one");
  EXPECT_EQ(listener.awaited(), "two");
  EXPECT_EQ(sender->sent(), 2U);
}

TEST(DatagramSender, WhatIsNotTakenIsCounted) {
  auto sender = DatagramSender::open("127.0.0.1:9");
  ASSERT_TRUE(sender);
  sender->send(std::string(100'000, 'x'));  // more than a datagram holds
  EXPECT_EQ(sender->dropped(), 1U);
  EXPECT_EQ(sender->sent(), 0U);
}

TEST(DatagramSender, RefusesWhatIsNoAddress) {
  for (const char* address : {"", ":", "127.0.0.1", "127.0.0.1:", "127.0.0.1:0", "127.0.0.1:65536",
                              "127.0.0.1:7x", "nobody:7", "1.2.3:7"}) {
    EXPECT_TRUE(test::refused(DatagramSender::open(address), {"give an IPv4 address and a port"},
                              ErrorCode::kUsage))
        << address;
  }
}

}  // namespace
}  // namespace mixrig::stream
