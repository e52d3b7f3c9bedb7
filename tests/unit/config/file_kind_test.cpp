// SPDX-License-Identifier: Apache-2.0
#include "host/math/config/file_kind.h"

#include <vector>

#include <gtest/gtest.h>

namespace mixrig::config {
namespace {

TEST(FileKind, AFileOfAnotherKindIsNamedAndOneOfThisKindIsNot) {
  const std::set<std::string, std::less<>> scene{"camera", "background", "object"};
  const std::set<std::string, std::less<>> take{"format", "color", "depth"}, other{"keys"};
  const std::vector<std::string> of_take{"format", "color", "depth"}, of_scene{"camera", "object"};
  EXPECT_EQ(other_kind(of_take, scene), "this is the file of a take: name that of a scene");
  EXPECT_EQ(other_kind(of_scene, take), "this is the file of a scene: name that of a take");
  EXPECT_EQ(other_kind(of_take, take), "");
  EXPECT_EQ(other_kind(of_scene, scene), "");
  EXPECT_EQ(other_kind(of_take, other), "") << "a kind that is not known";
  EXPECT_EQ(other_kind(std::vector<std::string>{"cameras", "background"}, scene), "")
      << "a misspelt key in the right file";
  EXPECT_EQ(other_kind(std::vector<std::string>{"treshold"}, scene), "");
}

}  // namespace
}  // namespace mixrig::config
