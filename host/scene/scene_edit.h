// SPDX-License-Identifier: Apache-2.0
// Edits a scene.toml and leaves the rest of its text unchanged.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "hal/base/result.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// Returns the text with these lamps in place of its [[light.lamp]] tables, and with `ambient` in
/// [light] if it is given. Comments within the lamps' tables are removed too. `path` is the scene's
/// path. Errors: kFormat if the text is no scene, or its light is not written in tables of its own;
/// the result is checked by reading it again.
Result<std::string> with_lamps(std::string_view text, const std::filesystem::path& path,
                               std::span<const Lamp> lamps,
                               const std::optional<Eigen::Vector3f>& ambient);

/// Returns the text with another pose of the object `name`. Errors: kFormat if the text is no scene
/// or cannot be edited; kUsage if there is no such object, naming the existing ones.
Result<std::string> with_object_pose(std::string_view text, const std::filesystem::path& path,
                                     const std::string& name,
                                     const geometry::Pose& world_from_object);

/// Changes of an object; absent values stay.
struct ObjectEdit {
  std::optional<geometry::Pose> world_from_object;
  std::optional<double> scale;  ///< 1e-6 to 1e6
  std::optional<bool> hidden;
  std::optional<std::string> name{};
};
/// Returns the text with an object changed. Errors: those of with_object_pose(); kUsage if a new
/// name is taken.
Result<std::string> with_object(std::string_view text, const std::filesystem::path& path,
                                const std::string& name, const ObjectEdit& edit);
/// Returns the text with a new [[object]] at its end: its name, model (path as written in the
/// file), pose and scale. Errors: kFormat; kUsage if the name is taken.
Result<std::string> with_new_object(std::string_view text, const std::filesystem::path& path,
                                    const Object& object);
/// Returns the text with a copy of an object behind it: all its keys, but this name and pose.
/// Errors: those of with_object_pose(); kUsage if the name is taken.
Result<std::string> with_object_copy(std::string_view text, const std::filesystem::path& path,
                                     const std::string& name, const std::string& copy,
                                     const geometry::Pose& world_from_copy);
/// Returns the text without an object. Errors: those of with_object_pose().
Result<std::string> without_object(std::string_view text, const std::filesystem::path& path,
                                   const std::string& name);

}  // namespace mixrig::scene
