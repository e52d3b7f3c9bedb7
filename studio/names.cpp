// SPDX-License-Identifier: Apache-2.0
// Names of scenarios and rigs.
#include <fmt/format.h>

#include "studio/studio.h"

namespace mixrig::studio {
namespace {

template <typename T>
struct Named {
  T value;
  std::string_view name;
};

constexpr std::array<Named<Scenario>, 14> kScenarios{{{Scenario::kStill, "still"},
                                                      {Scenario::kWalk, "walk"},
                                                      {Scenario::kTalk, "talk"},
                                                      {Scenario::kPan, "pan"},
                                                      {Scenario::kSweep, "sweep"},
                                                      {Scenario::kHandheld, "handheld"},
                                                      {Scenario::kPendulum, "pendulum"},
                                                      {Scenario::kCarried, "carried"},
                                                      {Scenario::kEdges, "edges"},
                                                      {Scenario::kFar, "far"},
                                                      {Scenario::kDark, "dark"},
                                                      {Scenario::kStarts, "starts"},
                                                      {Scenario::kRounds, "rounds"},
                                                      {Scenario::kShot, "shot"}}};
constexpr std::array<Named<RigPreset>, 3> kRigs{{{RigPreset::kSr3000, "sr3000"},
                                                 {RigPreset::kKinect2, "kinect2"},
                                                 {RigPreset::kHelios2, "helios2"}}};

template <typename T, std::size_t N>
Result<T> parse(const std::array<Named<T>, N>& table, std::string_view what,
                std::string_view text) {
  std::string known;
  for (const auto& entry : table) {
    if (entry.name == text) return entry.value;
    known += (known.empty() ? "" : ", ") + std::string(entry.name);
  }
  return Error{ErrorCode::kUsage, fmt::format("unknown {} '{}': use one of {}", what, text, known)};
}

template <typename T, std::size_t N>
std::string_view name_in(const std::array<Named<T>, N>& table, T value) {
  for (const auto& entry : table)
    if (entry.value == value) return entry.name;
  return "unknown";
}

}  // namespace

std::string_view name(Scenario scenario) { return name_in(kScenarios, scenario); }
std::string_view name(RigPreset rig) { return name_in(kRigs, rig); }
Result<Scenario> parse_scenario(std::string_view text) {
  return parse(kScenarios, "scenario", text);
}
Result<RigPreset> parse_rig(std::string_view text) { return parse(kRigs, "rig", text); }

Result<RigWords> parse_rig_words(std::string_view text) {
  const std::size_t plus = text.find('+');
  RigWords words;
  MIXRIG_ASSIGN(words.rig, parse_rig(text.substr(0, plus)));
  if (plus == std::string_view::npos) return words;
  MIXRIG_ASSIGN(words.second_tof, parse_rig(text.substr(plus + 1)));
  return words;
}

}  // namespace mixrig::studio
