// SPDX-License-Identifier: Apache-2.0
#include "host/stream/datagram_sender.h"

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace mixrig::stream {
namespace {

TEST(DatagramSender, SendsEachTextAsADatagram) {
  const int socket = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_in own{};
  own.sin_family = AF_INET;
  own.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t size = sizeof own;
  ASSERT_EQ(::bind(socket, reinterpret_cast<const sockaddr*>(&own), sizeof own), 0);
  ASSERT_EQ(::getsockname(socket, reinterpret_cast<sockaddr*>(&own), &size), 0);
  auto sender = DatagramSender::open("localhost:" + std::to_string(ntohs(own.sin_port)));
  ASSERT_TRUE(sender) << sender.error().context;
  sender->send("one"), sender->send("two");
  char text[16];
  ASSERT_EQ(::recv(socket, text, sizeof text, MSG_DONTWAIT), 3);
  EXPECT_EQ(std::string(text, 3), "one");
  ASSERT_EQ(::recv(socket, text, sizeof text, MSG_DONTWAIT), 3);
  EXPECT_EQ(std::string(text, 3), "two");
  EXPECT_EQ(sender->sent(), 2U);
  ::close(socket);
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
    const auto sender = DatagramSender::open(address);
    ASSERT_FALSE(sender) << address;
    EXPECT_EQ(sender.error().code, ErrorCode::kUsage);
    EXPECT_NE(sender.error().context.find("give an IPv4 address and a port"), std::string::npos);
  }
}

}  // namespace
}  // namespace mixrig::stream
