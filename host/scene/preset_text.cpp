// SPDX-License-Identifier: Apache-2.0
#include "host/scene/preset_text.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/math/config/toml_lines.h"
#include "host/scene/scene_manifest.h"

namespace mixrig::scene {
namespace {

using config::Lines;

/// Whether a table, such as "[[light.lamp]]", belongs to a preset.
bool is_of_preset(std::string header) {
  std::erase_if(header, [](char c) { return c == '[' || c == ']'; });
  const std::string root = header.substr(0, header.find('.'));
  constexpr std::array kTables{"object", "light", "focus", "look"};
  return std::find(kTables.begin(), kTables.end(), root) != kTables.end();
}

/// Lines of a file: those of a preset, and the others, in two texts. `at`: the number of other
/// lines before the first of the preset.
struct Split {
  Lines preset, others;
  std::size_t at = 0;
};

Split split(std::string_view text) {
  Split parts;
  Lines waiting;  // comments and blank lines before the next header
  bool of_preset = false;
  for (std::string& line : config::lines_of(text)) {
    const std::string header = config::header_of(line);
    if (header.empty() && config::bare(line).empty()) {
      waiting.push_back(std::move(line));
      continue;
    }
    if (!header.empty()) of_preset = is_of_preset(header);
    if (of_preset && parts.preset.empty()) parts.at = parts.others.size();
    Lines& to = of_preset ? parts.preset : parts.others;
    for (std::string& one : waiting) to.push_back(std::move(one));
    waiting.clear();
    to.push_back(std::move(line));
  }
  if (parts.preset.empty()) parts.at = parts.others.size();
  for (std::string& one : waiting) parts.others.push_back(std::move(one));
  return parts;
}

template <typename Named>
const Named* with_name(const std::vector<Named>& all, const std::string& name) {
  const auto found =
      std::find_if(all.begin(), all.end(), [&](const auto& one) { return one.name == name; });
  return found == all.end() ? nullptr : &*found;
}

using Says = std::vector<std::string>;

void compare(const Object& here, const Object& there, Says& says) {
  const double moved_m =
      (here.world_from_object.translation_m - there.world_from_object.translation_m).norm();
  const double turned_deg =
      here.world_from_object.rotation.angularDistance(there.world_from_object.rotation) * 180 /
      std::numbers::pi;
  const auto say = [&](const std::string& what) { says.push_back(there.name + ": " + what); };
  if (moved_m > 1e-3) say(fmt::format("moved by {:.2f} m", moved_m));
  if (turned_deg > 0.1) say(fmt::format("turned by {:.0f} deg", turned_deg));
  if (std::abs(here.scale - there.scale) > 1e-4 * there.scale)
    say(fmt::format("scale {:.3g}, now {:.3g}", there.scale, here.scale));
  if (here.hidden != there.hidden) say(there.hidden ? "hidden, now shown" : "shown, now hidden");
  if (here.model_path != there.model_path) say("another model");
}

std::string text_of_color(const Eigen::Vector3f& c) {
  return fmt::format("{:.3g} {:.3g} {:.3g}", c.x(), c.y(), c.z());
}

void compare(const Lamp& here, const Lamp& there, Says& says) {
  if ((here.position_m - there.position_m).norm() > 1e-3)
    says.push_back(fmt::format("{}: moved by {:.2f} m", there.name,
                               (here.position_m - there.position_m).norm()));
  if ((here.intensity - there.intensity).norm() > 1e-3F * (1 + there.intensity.norm()))
    says.push_back(fmt::format("{}: {}, now {}", there.name, text_of_color(there.intensity),
                               text_of_color(here.intensity)));
}

template <typename Named>
void compare_all(const std::vector<Named>& here, const std::vector<Named>& there, Says& says) {
  for (const Named& one : there)
    if (const Named* now = with_name(here, one.name))
      compare(*now, one, says);
    else
      says.push_back(one.name + ": is there, now not");
  for (const Named& one : here)
    if (with_name(there, one.name) == nullptr) says.push_back(one.name + ": is not there, now is");
}

std::string text_of_focus(const std::optional<FocusSettings>& focus) {
  if (!focus) return "off";
  return focus->pixel ? fmt::format("at pixel {},{}, f/{:.3g}", focus->pixel->first,
                                    focus->pixel->second, focus->f_number)
                      : fmt::format("{:.2f} m, f/{:.3g}", focus->distance_m, focus->f_number);
}

}  // namespace

std::string preset_of(std::string_view scene_text) {
  return config::text_of_lines(split(scene_text).preset);
}

Result<std::string> with_preset(std::string_view scene_text, std::string_view preset,
                                const std::filesystem::path& path) {
  Split of_preset = split(preset);
  for (const std::string& line : of_preset.others)
    if (!config::bare(line).empty())
      return Error{ErrorCode::kFormat,
                   "a preset has tables of objects, light, focus and look alone: remove \"" +
                       std::string(config::bare(line)).substr(0, 80) + "\""};
  Split parts = split(scene_text);
  Lines lines = std::move(parts.others);
  Lines& added = of_preset.preset;
  if (parts.at > 0 && !added.empty() && !added.front().empty()) added.insert(added.begin(), "");
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(parts.at), added.begin(), added.end());
  std::string text = config::text_of_lines(lines);
  MIXRIG_TRY(parse_scene(text, path, false));
  return text;
}

std::vector<std::string> differences(const Scene& here, const Scene& there) {
  constexpr std::size_t kMost = 20;
  Says says;
  compare_all(here.objects, there.objects, says);
  compare_all(here.light.lamps, there.light.lamps, says);
  if ((here.light.ambient - there.light.ambient).norm() > 1e-4F)
    says.push_back("ambient light: " + text_of_color(there.light.ambient) + ", now " +
                   text_of_color(here.light.ambient));
  const std::string was = text_of_focus(there.focus), is = text_of_focus(here.focus);
  if (was != is) says.push_back("depth of field: " + was + ", now " + is);
  if (!(here.look == there.look)) says.emplace_back("the look is another");
  if (says.size() > kMost) {
    const std::size_t more = says.size() - kMost + 1;
    says.resize(kMost - 1);
    says.push_back(fmt::format("and {} more", more));
  }
  return says;
}

}  // namespace mixrig::scene
