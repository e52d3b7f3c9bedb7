// SPDX-License-Identifier: Apache-2.0
// Changes of a scene.toml that leave the rest of its text as it is.
#pragma once

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "hal/base/result.h"
#include "host/scene/scene.h"

namespace mixrig::scene {

/// The text with these lamps in place of its [[light.lamp]] tables, and with `ambient` in [light]
/// where it is given. Comments within the lamps' tables go with them. `path` is where the scene
/// lies. Errors: kFormat, where the text is no scene, or its light is not written in tables of its
/// own; the text is checked by reading it again.
Result<std::string> with_lamps(std::string_view text, const std::filesystem::path& path,
                               std::span<const Lamp> lamps,
                               const std::optional<Eigen::Vector3f>& ambient);

/// The text with another pose of the object `name`. Errors: kFormat as above; kUsage where there is
/// no such object, naming those that there are.
Result<std::string> with_object_pose(std::string_view text, const std::filesystem::path& path,
                                     const std::string& name,
                                     const geometry::Pose& world_from_object);

/// What of an object can be changed; absent: it stays.
struct ObjectEdit {
  std::optional<geometry::Pose> world_from_object;
  std::optional<double> scale;  ///< 1e-6 to 1e6
  std::optional<bool> hidden;
};
/// The text with an object changed. Errors: as with_object_pose().
Result<std::string> with_object(std::string_view text, const std::filesystem::path& path,
                                const std::string& name, const ObjectEdit& edit);
/// The text with another [[object]] at its end: its name, model (a path as the file is to have it),
/// pose and scale. Errors: kFormat; kUsage where the name is taken.
Result<std::string> with_new_object(std::string_view text, const std::filesystem::path& path,
                                    const Object& object);
/// The text without an object. Errors: as with_object_pose().
Result<std::string> without_object(std::string_view text, const std::filesystem::path& path,
                                   const std::string& name);

}  // namespace mixrig::scene
