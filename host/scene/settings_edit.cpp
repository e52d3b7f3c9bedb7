// SPDX-License-Identifier: Apache-2.0
#include "host/scene/settings_edit.h"

#include <cmath>

#include "host/math/config/toml_lines.h"
#include "host/scene/scene_manifest.h"

namespace mixrig::scene {
namespace {

using config::Block;
using config::Lines;

constexpr int kSettingDigits = 6;

/// Returns the lines of a table, which is added at the end if it does not exist.
Block table_of(Lines& lines, const std::string& header) {
  const auto blocks = config::blocks_of(lines, header);
  if (!blocks.empty()) return blocks.front();
  if (!lines.empty() && !lines.back().empty()) lines.emplace_back();
  lines.push_back(header);
  return {lines.size() - 1, lines.size()};
}

Error not_editable(const std::filesystem::path& path, const char* table) {
  return {ErrorCode::kFormat, path.string() + ": its " + table +
                                  " cannot be changed: write it as a table of its own, with each "
                                  "key on one line, and values within the keys' ranges"};
}

bool is_near(double a, double b) { return std::abs(a - b) <= 1e-4 * std::abs(b); }

bool has_focus(const Scene& scene, const FocusEdit& edit) {
  if (!scene.focus) return false;
  const FocusSettings& now = *scene.focus;
  return (!edit.distance_m || (!now.pixel && is_near(now.distance_m, *edit.distance_m))) &&
         (!edit.pixel || now.pixel == edit.pixel) &&
         (!edit.f_number || is_near(now.f_number, *edit.f_number));
}

}  // namespace

Result<std::string> with_focus(std::string_view text, const std::filesystem::path& path,
                               const FocusEdit& edit) {
  MIXRIG_ASSIGN(const Scene scene, parse_scene(text, path, false));
  if (!scene.focus && !edit.distance_m && !edit.pixel)
    return Error{ErrorCode::kUsage,
                 path.string() + ": has no [focus]: give the distance or the place that is sharp"};
  Lines lines = config::lines_of(text);
  Block block = table_of(lines, "[focus]");
  if (edit.f_number)
    config::set_line_in(
        lines, block, "f_number",
        config::value_line("f_number", config::rounded(*edit.f_number, kSettingDigits)));
  if (edit.distance_m) {
    config::remove_line(lines, block, "pixel");
    config::set_line_in(
        lines, block, "distance_m",
        config::value_line("distance_m", config::rounded(*edit.distance_m, kSettingDigits)));
  }
  if (edit.pixel) {
    config::remove_line(lines, block, "distance_m");
    const std::vector<double> at{double(edit.pixel->first), double(edit.pixel->second)};
    config::set_line_in(lines, block, "pixel", config::value_line("pixel", at));
  }
  std::string edited = config::text_of_lines(lines);
  const auto check = parse_scene(edited, path, false);
  if (!check || !has_focus(*check, edit)) return not_editable(path, "[focus]");
  return edited;
}

Result<std::string> without_focus(std::string_view text, const std::filesystem::path& path) {
  MIXRIG_TRY(parse_scene(text, path, false));
  Lines lines = config::lines_of(text);
  const auto blocks = config::blocks_of(lines, "[focus]");
  if (!blocks.empty()) {
    std::size_t end = blocks.front().end;
    if (end < lines.size() && lines[end].empty()) ++end;  // the blank line after it
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(blocks.front().begin),
                lines.begin() + static_cast<std::ptrdiff_t>(end));
  }
  // A quality level of the focus is only allowed with a focus.
  if (auto quality = config::blocks_of(lines, "[quality]"); !quality.empty())
    config::remove_line(lines, quality.front(), "focus");
  std::string edited = config::text_of_lines(lines);
  const auto check = parse_scene(edited, path, false);
  if (!check || check->focus) return not_editable(path, "[focus]");
  return edited;
}

Result<std::string> with_background_model(std::string_view text, const std::filesystem::path& path,
                                          const std::filesystem::path& model) {
  MIXRIG_TRY(parse_scene(text, path, false));
  Lines lines = config::lines_of(text);
  Block block = table_of(lines, "[background]");
  config::remove_line(lines, block, "learn");
  config::set_line_in(lines, block, "model", config::value_line("model", model.string()));
  std::string edited = config::text_of_lines(lines);
  const auto check = parse_scene(edited, path, false);
  if (!check || check->background.learn || !check->background.model ||
      check->background.model->lexically_normal() !=
          (path.parent_path() / model).lexically_normal())
    return not_editable(path, "[background]");
  return edited;
}

}  // namespace mixrig::scene
