// SPDX-License-Identifier: Apache-2.0
#include "host/math/config/file_kind.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace mixrig::config {

namespace {

struct Kind {
  std::string_view key, name;
};
// The key of a kind is one that no other kind has.
constexpr std::array kKinds{Kind{"color", "a take"},          Kind{"trigger", "a rig"},
                            Kind{"cameras", "a calibration"}, Kind{"background", "a scene"},
                            Kind{"object", "a scene"},        Kind{"projection", "a room"}};

/// The name of the first kind with a key for which `has` is true; empty: none.
template <typename Has>
std::string_view kind_with(Has has) {
  const auto found = std::ranges::find_if(kKinds, has, &Kind::key);
  return found == kKinds.end() ? std::string_view() : found->name;
}

}  // namespace

std::string other_kind(std::span<const std::string> keys,
                       const std::set<std::string, std::less<>>& asked) {
  const auto is_there = [&](std::string_view key) {
    return std::ranges::find(keys, key) != keys.end();
  };
  const auto is_wanted = [&](std::string_view key) { return asked.contains(key); };
  const auto is_both = [&](std::string_view key) { return is_there(key) && is_wanted(key); };
  if (!kind_with(is_both).empty()) return {};
  const std::string_view is = kind_with(is_there), wanted = kind_with(is_wanted);
  if (is.empty() || wanted.empty() || is == wanted) return {};
  return "this is the file of " + std::string(is) + ": name that of " + std::string(wanted);
}

std::string binary_kind(std::string_view first_bytes) {
  struct Begin {
    std::string_view bytes, is, advice;
  };
  constexpr std::string_view kRecording = "make a take of a recording by mixrig import";
  constexpr std::string_view kOther = "give the right file";
  constexpr std::array<Begin, 5> kBegins{
      {{"\x1A\x45\xDF\xA3", "a Matroska file", kRecording},
       {"#ROSBAG", "a ROS bag", kRecording},
       {"NI10", "an .oni recording", "name it as openni2:FILE in rig.toml and record it"},
       {"\x89PNG", "a PNG picture", kOther},
       {"\xFF\xD8\xFF", "a JPEG picture", kOther}}};
  for (const Begin& begin : kBegins)
    if (first_bytes.starts_with(begin.bytes))
      return std::string(begin.is) + ": " + std::string(begin.advice);
  return {};
}

std::string advice_for_unread(std::string_view file_name, bool is_folder) {
  struct Advice {
    std::string_view end, text;
  };
  constexpr std::array<Advice, 4> kAdvice{
      {{"take.toml", "name the folder of a take"},
       {"manifest.toml", "name a room that mixrig scan has written"},
       {"background.toml", "name a background that mixrig scan has written"},
       {"rig.toml", "write it by mixrig rig init, or name another"}}};
  if (is_folder) return "name a file";
  for (const Advice& advice : kAdvice)
    if (file_name.ends_with(advice.end)) return std::string(advice.text);
  return "check the path";
}

}  // namespace mixrig::config
