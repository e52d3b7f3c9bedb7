// SPDX-License-Identifier: Apache-2.0
#include "host/output/datagrams/osc.h"

#include <gtest/gtest.h>
#ifdef MIXRIG_HAS_LIBLO
#include <lo/lo.h>
#endif

#include "host/output/datagrams/datagram_sender.h"

namespace mixrig::stream {
namespace {

using std::string_literals::operator""s;

TEST(Osc, TheExamplesOfTheSpecification) {
  EXPECT_EQ(OscMessage("/oscillator/4/frequency").add(440.0F).bytes(),
            "/oscillator/4/frequency\0,f\0\0\x43\xdc\0\0"s);
  EXPECT_EQ(
      OscMessage("/foo")
          .add(1000)
          .add(-1)
          .add(std::string_view("hello"))
          .add(1.234F)
          .add(5.678F)
          .bytes(),
      "/foo\0\0\0\0,iisff\0\0\0\0\x03\xe8\xff\xff\xff\xffhello\0\0\0\x3f\x9d\xf3\xb6\x40\xb5\xb2\x2d"s);
}

TEST(Osc, TextsOfEachLengthEndWithAZeroAtAMultipleOfFour) {
  for (std::size_t length = 0; length < 9; ++length) {
    const std::string bytes = OscMessage("/a").add(std::string_view("abcdefgh", length)).bytes();
    EXPECT_EQ(bytes.size(), 8 + 4 * (length / 4 + 1));
    EXPECT_EQ(bytes.substr(8, length + 1), std::string("abcdefgh", length) + '\0');
  }
  EXPECT_EQ(OscMessage("/a").bytes(), "/a\0\0,\0\0\0"s);
  EXPECT_EQ(OscMessage("/a").add(std::string_view("b\0c", 3)).bytes(), "/a\0\0,s\0\0b\0\0\0"s);
}

TEST(Osc, NamesAreValidInAnAddress) {
  EXPECT_EQ(osc_name("crate"), "crate");
  EXPECT_EQ(osc_name("object 1"), "object_1");
  EXPECT_EQ(osc_name("a/b*c?d[e]{f},g#h"), "a_b_c_d_e__f__g_h");
  EXPECT_EQ(osc_name("T\xc3\xbcr\n"), "T__r_");
  EXPECT_EQ(osc_name(""), "_");
}

/// liblo, which shares no code with the writer, reads the message.
TEST(Osc, AnIndependentReceiverReadsIt) {
#ifndef MIXRIG_HAS_LIBLO
  GTEST_SKIP() << "liblo is not installed: scripts/setup peers";
#else
  struct Heard {
    std::string path, types, text;
    int number = 0;
    float value = 0;
  } heard;
  const auto hear = [](const char* path, const char* types, lo_arg** arguments, int, lo_message,
                       void* to) {
    auto& h = *static_cast<Heard*>(to);
    h.path = path, h.types = types;
    if (h.types == "sif") {
      h.text = &arguments[0]->s;
      h.number = arguments[1]->i, h.value = arguments[2]->f;
    }
    return 0;
  };
  const lo_server server = lo_server_new(nullptr, nullptr);
  ASSERT_NE(server, nullptr);
  lo_server_add_method(server, nullptr, nullptr, hear, &heard);
  auto sender = DatagramSender::open("127.0.0.1:" + std::to_string(lo_server_get_port(server)));
  ASSERT_TRUE(sender);
  sender->send(
      OscMessage("/mixrig/touch/a_b").add(std::string_view("hello")).add(-7).add(0.1F).bytes());
  EXPECT_GT(lo_server_recv_noblock(server, 2000), 0);
  lo_server_free(server);
  EXPECT_EQ(heard.path, "/mixrig/touch/a_b");
  EXPECT_EQ(heard.types, "sif");
  EXPECT_EQ(heard.text, "hello");
  EXPECT_EQ(heard.number, -7);
  EXPECT_EQ(heard.value, 0.1F);
#endif
}

}  // namespace
}  // namespace mixrig::stream
