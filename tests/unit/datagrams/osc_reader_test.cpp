// SPDX-License-Identifier: Apache-2.0
#include "host/output/datagrams/osc_reader.h"

#include <string>

#include <gtest/gtest.h>

#include "host/output/datagrams/osc.h"

namespace mixrig::stream {
namespace {

using std::string_literals::operator""s;

Result<std::vector<OscReceived>> read(const std::string& bytes) {
  return parse_osc({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

TEST(OscReader, TheExamplesOfTheSpecification) {
  const auto one = read("/oscillator/4/frequency\0,f\0\0\x43\xdc\0\0"s);
  ASSERT_TRUE(one) << to_line(one.error());
  ASSERT_EQ(one->size(), 1U);
  EXPECT_EQ((*one)[0].address, "/oscillator/4/frequency");
  EXPECT_EQ((*one)[0].arguments, (std::vector<OscArgument>{440.0}));
  const auto foo = read(
      "/foo\0\0\0\0,iisff\0\0\0\0\x03\xe8\xff\xff\xff\xffhello\0\0\0\x3f\x9d\xf3\xb6\x40\xb5\xb2\x2d"s);
  ASSERT_TRUE(foo);
  const auto& arguments = (*foo)[0].arguments;
  ASSERT_EQ(arguments.size(), 5U);
  EXPECT_EQ(std::get<double>(arguments[1]), -1);
  EXPECT_EQ(std::get<std::string>(arguments[2]), "hello");
  EXPECT_NEAR(std::get<double>(arguments[4]), 5.678, 1e-6);
}

TEST(OscReader, SwitchesAndLongNumbers) {
  const auto read_back = read("/a\0\0,TFNIhd\0\0\0\0\0\0\0\0\x07\x40\x08\0\0\0\0\0\0"s);
  ASSERT_TRUE(read_back) << to_line(read_back.error());
  EXPECT_EQ((*read_back)[0].arguments, (std::vector<OscArgument>{true, false, 7.0, 3.0}));
  ASSERT_TRUE(read("/a\0\0"s)) << "old senders leave out the types";
}

TEST(OscReader, ABundleIsItsMessages) {
  const auto element = [](const std::string& bytes) {
    return std::string(3, '\0') + static_cast<char>(bytes.size()) + bytes;
  };
  const std::string head = "#bundle\0\0\0\0\0\0\0\0\x01"s;
  const std::string a = OscMessage("/a").add(1).bytes(), b = OscMessage("/b").bytes();
  const auto both = read(head + element(a) + element(head + element(b)));
  ASSERT_TRUE(both) << to_line(both.error());
  ASSERT_EQ(both->size(), 2U);
  EXPECT_EQ((*both)[1].address, "/b");
  EXPECT_TRUE(read(head)->empty());
  std::string deep = b;
  for (int i = 0; i < 4; ++i) deep = head + element(deep);
  EXPECT_TRUE(read(deep));
  EXPECT_FALSE(read(head + element(deep)));
  std::string many = head;
  for (int i = 0; i < 33; ++i) many += element(b);
  EXPECT_FALSE(read(many));
}

TEST(OscReader, DamagedOnesAreRefused) {
  for (const std::string& bytes :
       {""s, "/a"s, "a\0\0\0"s, "/a\0\0,i\0\0"s, "/a\0\0,i\0\0\0\0\0"s, "/a\0\0,x\0\0"s,
        "/a\0\0i\0\0\0\0\0\0\0"s, "/a\0\0,s\0\0abcd"s, "/a\0\0,f\0\0\x7f\x80\0\0"s,
        "#bundle\0\0\0\0\0\0\0\0\x01\0\0\0\x08/a\0\0"s})
    EXPECT_FALSE(read(bytes)) << bytes.size();
  EXPECT_FALSE(read("/a\0\0,iiiiiiiiiiiiiiiii\0\0"s + std::string(68, '\0'))) << "17 arguments";
}

}  // namespace
}  // namespace mixrig::stream
