// SPDX-License-Identifier: Apache-2.0
#include "host/scene/scene_edit.h"

#include <algorithm>
#include <vector>

#include "host/math/config/toml_lines.h"
#include "host/math/config/writer.h"
#include "host/scene/scene_manifest.h"

namespace mixrig::scene {
namespace {

using config::Block;
using config::blocks_of;
using config::header_of;
using config::key_of;
using config::Lines;
using config::lines_of;
using config::set_line;
using config::text_of_lines;

constexpr int kLampDigits = 6, kObjectDigits = 7;

template <typename Vector>
std::vector<double> rounded_numbers(const Vector& v, int digits) {
  std::vector<double> values;
  for (int i = 0; i < v.size(); ++i) values.push_back(config::rounded(v[i], digits));
  return values;
}

Lines lamp_lines(const Lamp& lamp) {
  config::Writer table;
  table.set("name", lamp.name);
  table.set("position_m", rounded_numbers(lamp.position_m, kLampDigits));
  if (lamp.direction) table.set("direction", rounded_numbers(*lamp.direction, kLampDigits));
  table.set("size_m", rounded_numbers(lamp.size_m, kLampDigits));
  table.set("intensity", rounded_numbers(lamp.intensity, kLampDigits));
  Lines lines{"[[light.lamp]]"};
  for (std::string& line : lines_of(table.text())) lines.push_back(std::move(line));
  return lines;
}

std::string number_line(std::string_view key, std::span<const double> values) {
  return config::value_line(key, values);
}

Error cannot_edit(const std::filesystem::path& path, const std::string& what) {
  return {ErrorCode::kFormat, path.string() + ": " + what};
}

}  // namespace

Result<std::string> with_lamps(std::string_view text, const std::filesystem::path& path,
                               std::span<const Lamp> lamps,
                               const std::optional<Eigen::Vector3f>& ambient) {
  MIXRIG_TRY(parse_scene(text, path, false));
  Lines lines = lines_of(text);
  const auto old = blocks_of(lines, "[[light.lamp]]");
  std::size_t at = old.empty() ? lines.size() : old.front().begin;
  for (auto block = old.rbegin(); block != old.rend(); ++block) {
    std::size_t end = block->end;
    if (end < lines.size() && lines[end].empty()) ++end;  // the blank line after it
    lines.erase(lines.begin() + static_cast<std::ptrdiff_t>(block->begin),
                lines.begin() + static_cast<std::ptrdiff_t>(end));
  }
  auto light = blocks_of(lines, "[light]");
  if (light.empty() && ambient) {
    lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(at), {"[light]", ""});
    light = blocks_of(lines, "[light]"), at += 2;
  }
  const std::size_t before = lines.size();
  if (ambient)
    set_line(lines, light.front(), "ambient",
             number_line("ambient", rounded_numbers(*ambient, kLampDigits)));
  if (old.empty() && !light.empty())
    at = blocks_of(lines, "[light]").front().end;
  else if (!light.empty() && light.front().begin < at)
    at += lines.size() - before;
  Lines added;
  if (at > 0 && at <= lines.size() && !lines[at - 1].empty()) added.emplace_back();
  for (const Lamp& lamp : lamps) {
    for (std::string& line : lamp_lines(lamp)) added.push_back(std::move(line));
    added.emplace_back();
  }
  if (at >= lines.size() && !added.empty() && added.back().empty()) added.pop_back();
  lines.insert(lines.begin() + static_cast<std::ptrdiff_t>(std::min(at, lines.size())),
               added.begin(), added.end());
  std::string edited = text_of_lines(lines);
  const auto check = parse_scene(edited, path, false);
  if (!check || check->light.lamps.size() != lamps.size())
    return cannot_edit(path,
                       "its light cannot be changed: write [light] and [[light.lamp]] as "
                       "tables of their own, and ambient on one line");
  return edited;
}

namespace {

constexpr const char* kObjectsAreNoTables =
    "its objects cannot be changed: write each as a table [[object]], with each key on one line";

/// The lines of a scene, and those of one of its objects.
struct ObjectText {
  Scene scene;
  std::size_t index = 0;
  Lines lines;
  Block block;
};

/// Finds an object's lines. Errors: kFormat, kUsage.
Result<ObjectText> find_object(std::string_view text, const std::filesystem::path& path,
                               const std::string& name) {
  ObjectText found;
  MIXRIG_ASSIGN(found.scene, parse_scene(text, path, false));
  const auto& objects = found.scene.objects;
  std::string names;
  for (const Object& object : objects) names += (names.empty() ? "" : ", ") + object.name;
  const auto object =
      std::find_if(objects.begin(), objects.end(), [&](const auto& o) { return o.name == name; });
  if (object == objects.end())
    return Error{ErrorCode::kUsage, path.string() + ": has no object \"" + name + "\": it has " +
                                        (names.empty() ? "none" : names)};
  found.index = static_cast<std::size_t>(object - objects.begin());
  found.lines = lines_of(text);
  const auto blocks = blocks_of(found.lines, "[[object]]");
  if (blocks.size() != objects.size()) return cannot_edit(path, kObjectsAreNoTables);
  found.block = blocks[found.index];
  return found;
}

void set_pose(ObjectText& object, const geometry::Pose& pose) {
  config::remove_line(object.lines, object.block, "yaw_deg");
  config::set_line_in(
      object.lines, object.block, "rotation_xyzw",
      number_line("rotation_xyzw",
                  rounded_numbers(Eigen::Vector4d(pose.rotation.coeffs()), kObjectDigits)));
  config::set_line_in(
      object.lines, object.block, "position_m",
      number_line("position_m", rounded_numbers(pose.translation_m, kObjectDigits)));
}

/// Moves the end of the block behind the object's inner tables, and before the comments of the next
/// table.
void take_inner_tables(const Lines& lines, Block& block) {
  while (block.end < lines.size()) {
    const std::string header = header_of(lines[block.end]);
    if (!header.empty() && !header.starts_with("[object.")) break;
    ++block.end;
  }
  while (block.end > block.begin + 1 && block.end < lines.size() &&
         lines[block.end - 1].starts_with('#'))
    --block.end;
}

Result<void> check_free(const Scene& scene, const std::filesystem::path& path,
                        const std::string& name) {
  if (std::none_of(scene.objects.begin(), scene.objects.end(),
                   [&](const Object& o) { return o.name == name; }))
    return {};
  return Error{ErrorCode::kUsage,
               path.string() + ": has an object \"" + name + "\": give another name"};
}

bool is_at(const Object& object, const geometry::Pose& pose) {
  return (object.world_from_object.translation_m - pose.translation_m).norm() <=
             1e-4 * std::max(1.0, pose.translation_m.norm()) &&
         object.world_from_object.rotation.angularDistance(pose.rotation) < 1e-4;
}

}  // namespace

Result<std::string> with_object(std::string_view text, const std::filesystem::path& path,
                                const std::string& name, const ObjectEdit& edit) {
  MIXRIG_ASSIGN(ObjectText object, find_object(text, path, name));
  if (edit.world_from_object) set_pose(object, *edit.world_from_object);
  if (edit.scale)
    config::set_line_in(object.lines, object.block, "scale",
                        config::value_line("scale", config::rounded(*edit.scale, kObjectDigits)));
  if (edit.hidden)
    config::set_line_in(object.lines, object.block, "hidden",
                        config::value_line("hidden", *edit.hidden));
  if (edit.name && *edit.name != name) {
    MIXRIG_TRY(check_free(object.scene, path, *edit.name));
    config::set_line_in(object.lines, object.block, "name",
                        config::value_line("name", std::string_view(*edit.name)));
  }
  std::string edited = text_of_lines(object.lines);
  const auto check = parse_scene(edited, path, false);
  if (!check || check->objects.size() != object.scene.objects.size())
    return cannot_edit(path, kObjectsAreNoTables);
  const Object& now = check->objects[object.index];
  if ((edit.world_from_object && !is_at(now, *edit.world_from_object)) ||
      (edit.hidden && now.hidden != *edit.hidden) || (edit.name && now.name != *edit.name))
    return cannot_edit(path, kObjectsAreNoTables);
  return edited;
}

Result<std::string> with_object_pose(std::string_view text, const std::filesystem::path& path,
                                     const std::string& name,
                                     const geometry::Pose& world_from_object) {
  return with_object(text, path, name, {world_from_object, std::nullopt, std::nullopt});
}

Result<std::string> with_new_object(std::string_view text, const std::filesystem::path& path,
                                    const Object& object) {
  MIXRIG_ASSIGN(const Scene scene, parse_scene(text, path, false));
  MIXRIG_TRY(check_free(scene, path, object.name));
  config::Writer table;
  table.set("name", object.name);
  table.set("model", object.model_path.string());
  table.set("position_m", rounded_numbers(object.world_from_object.translation_m, kObjectDigits));
  table.set(
      "rotation_xyzw",
      rounded_numbers(Eigen::Vector4d(object.world_from_object.rotation.coeffs()), kObjectDigits));
  table.set("scale", config::rounded(object.scale, kObjectDigits));
  std::string edited(text);
  if (!edited.empty() && edited.back() != '\n') edited += '\n';
  edited += "\n[[object]]\n" + table.text();
  const auto check = parse_scene(edited, path, false);
  if (!check || check->objects.size() != scene.objects.size() + 1)
    return cannot_edit(path, kObjectsAreNoTables);
  return edited;
}

Result<std::string> with_object_copy(std::string_view text, const std::filesystem::path& path,
                                     const std::string& name, const std::string& copy,
                                     const geometry::Pose& world_from_copy) {
  MIXRIG_ASSIGN(ObjectText object, find_object(text, path, name));
  MIXRIG_TRY(check_free(object.scene, path, copy));
  Block all = object.block;
  take_inner_tables(object.lines, all);
  const auto at = [&](std::size_t i) {
    return object.lines.begin() + static_cast<std::ptrdiff_t>(i);
  };
  Lines added(at(all.begin), at(all.end));
  while (!added.empty() && added.back().empty()) added.pop_back();
  Block block{0, std::min(object.block.end - object.block.begin, added.size())};
  config::set_line_in(added, block, "name", config::value_line("name", std::string_view(copy)));
  added.insert(added.begin(), "");
  if (all.end < object.lines.size()) added.emplace_back();
  object.lines.insert(at(all.end), added.begin(), added.end());
  return with_object_pose(text_of_lines(object.lines), path, copy, world_from_copy);
}

Result<std::string> without_object(std::string_view text, const std::filesystem::path& path,
                                   const std::string& name) {
  MIXRIG_ASSIGN(ObjectText object, find_object(text, path, name));
  Block& block = object.block;
  take_inner_tables(object.lines, block);
  object.lines.erase(object.lines.begin() + static_cast<std::ptrdiff_t>(block.begin),
                     object.lines.begin() + static_cast<std::ptrdiff_t>(block.end));
  std::string edited = text_of_lines(object.lines);
  const auto check = parse_scene(edited, path, false);
  if (!check || check->objects.size() + 1 != object.scene.objects.size())
    return cannot_edit(path, kObjectsAreNoTables);
  return edited;
}

}  // namespace mixrig::scene
