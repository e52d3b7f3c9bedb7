// SPDX-License-Identifier: Apache-2.0
// The numbers that both back ends share (host/render/contract/constants.h) must be the same in the
// shaders.
#include <cctype>
#include <cstdlib>
#include <fstream>
#include <map>
#include <regex>
#include <string>

#include <gtest/gtest.h>

#include "shaders/shaders.h"

namespace mixrig::test {
namespace {

/// Converts a C++ name to the one in GLSL: "ReachRampPx" to "reach_ramp_px".
std::string in_glsl(const std::string& name) {
  std::string out;
  for (const char c : name) {
    if (std::isupper(c) != 0 && !out.empty()) out += '_';
    out += static_cast<char>(std::tolower(c));
  }
  return out;
}

/// Numbers of the headers that both back ends share, by their GLSL name.
std::map<std::string, double> shared_numbers() {
  static const std::regex kDefinition(
      R"(inline constexpr (?:int|float|double) k(\w+)\s*=\s*([^;]+);)");
  std::map<std::string, double> found;
  for (const char* header : {"/host/render/contract/constants.h", "/host/render/frame/room_light.h",
                             "/hal/base/srgb.h"}) {
    std::ifstream file(std::getenv("MIXRIG_SOURCE") + std::string(header));
    EXPECT_TRUE(file) << header;
    const std::string text(std::istreambuf_iterator<char>(file), {});
    for (std::sregex_iterator it(text.begin(), text.end(), kDefinition), end; it != end; ++it)
      found.emplace(in_glsl((*it)[1]), std::stod((*it)[2]));
  }
  return found;
}

/// Constants of scalar type that a stage defines outside functions, by name.
std::map<std::string, double> constants_of(std::string_view stage_name) {
  const shaders::Stage* stage = shaders::find_stage(stage_name);
  EXPECT_NE(stage, nullptr);
  std::map<std::string, double> found;
  const std::string text(stage->text);
  static const std::regex kDefinition(R"(\nconst (?:int|float) (\w+) = ([-0-9.e]+);)");
  for (std::sregex_iterator it(text.begin(), text.end(), kDefinition), end; it != end; ++it)
    EXPECT_TRUE(found.emplace((*it)[1], std::stod((*it)[2])).second) << (*it)[1] << " twice";
  return found;
}

TEST(Constants, shaders_have_the_same_numbers) {
  const auto ours = shared_numbers(), found = constants_of("key_votes.frag");
  EXPECT_GT(ours.size(), 100U);
  EXPECT_EQ(found.size(), ours.size());
  for (const auto& [name, value] : ours) {
    ASSERT_TRUE(found.contains(name)) << name << ": is it written as TYPE kName = NUMBER?";
    EXPECT_EQ(static_cast<float>(found.at(name)), static_cast<float>(value)) << name;
  }
}

TEST(Constants, no_shader_has_a_number_of_its_own_under_such_a_name) {
  static const std::regex kLocal(R"(\n +const (?:int|float) (\w+) = )");
  const auto ours = shared_numbers();
  for (const shaders::Stage& stage : shaders::all_stages()) {
    for (const auto& [name, value] : constants_of(stage.name))
      EXPECT_TRUE(ours.contains(name)) << stage.name << ": " << name << " is in no shared header";
    const std::string text(stage.text);
    for (std::sregex_iterator it(text.begin(), text.end(), kLocal), end; it != end; ++it)
      EXPECT_FALSE(ours.contains((*it)[1])) << stage.name << ": " << (*it)[1];
  }
}

}  // namespace
}  // namespace mixrig::test
