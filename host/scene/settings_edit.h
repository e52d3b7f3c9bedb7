// SPDX-License-Identifier: Apache-2.0
// Edits [focus] and [background] of a scene.toml and leaves the rest of its text unchanged. Pure.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "hal/base/result.h"

namespace mixrig::scene {

/// Changes of the depth of field; absent values stay. A distance replaces a pixel, and a pixel a
/// distance.
struct FocusEdit {
  std::optional<double> distance_m;          ///< 0.01 to 10 000
  std::optional<std::pair<int, int>> pixel;  ///< pixel of the view
  std::optional<double> f_number;            ///< 0.5 to 128
};
/// Returns the text with its [focus] changed, or with a new one at its end. `path` is the scene's
/// path. Errors: kFormat if the text is no scene, or its [focus] is not a table of its own with
/// each key on a line; kUsage for a new one without a distance or a pixel.
Result<std::string> with_focus(std::string_view text, const std::filesystem::path& path,
                               const FocusEdit& edit);
/// Returns the text without [focus]. Errors: kFormat, as for with_focus().
Result<std::string> without_focus(std::string_view text, const std::filesystem::path& path);

/// Returns the text with another background; `model` is the folder's path as written in the file.
/// Frames to learn from are removed. Errors: kFormat, as for with_focus().
Result<std::string> with_background_model(std::string_view text, const std::filesystem::path& path,
                                          const std::filesystem::path& model);

}  // namespace mixrig::scene
