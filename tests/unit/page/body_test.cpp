// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "host/operator/page/json_body.h"
#include "host/operator/page/route.h"

namespace mixrig::page {
namespace {

TEST(PageBody, DeepTextsAreRefusedBeforeTheyAreParsed) {
  EXPECT_TRUE(parse_json("[[[[[[[[]]]]]]]]"));
  EXPECT_FALSE(parse_json("[[[[[[[[[]]]]]]]]]"));
  EXPECT_FALSE(parse_json(std::string(60000, '[')));
  EXPECT_TRUE(parse_json(R"({"a":"[[[[[[[[[[[\"[["})"));
}

TEST(PageBody, Utf8IsTold) {
  EXPECT_TRUE(is_utf8("a\xC3\xA4\xE2\x82\xAC\xF0\x9F\x98\x80"));
  for (const char* bad : {"\xC3", "\x80", "\xC0\x80", "\xFF", "\xE2\x82", "\xF5\x80\x80\x80"})
    EXPECT_FALSE(is_utf8(bad));
  EXPECT_TRUE(is_name("K\xC3\xBCnstlerin 1"));
  EXPECT_FALSE(is_name("a\nb"));
  EXPECT_FALSE(is_name(std::string(65, 'a')));
  EXPECT_FALSE(is_name(""));
}

}  // namespace
}  // namespace mixrig::page
