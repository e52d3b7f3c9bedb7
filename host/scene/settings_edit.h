// SPDX-License-Identifier: Apache-2.0
// Changes of the [focus] and the [background] of a scene.toml that leave the rest of its text as it
// is. Pure.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "hal/base/result.h"

namespace mixrig::scene {

/// What of the depth of field is changed; absent: it stays. A distance takes the place of a pixel,
/// and a pixel that of a distance.
struct FocusEdit {
  std::optional<double> distance_m;          ///< 0.01 to 10 000
  std::optional<std::pair<int, int>> pixel;  ///< of the view
  std::optional<double> f_number;            ///< 0.5 to 128
};
/// The text with its [focus] changed, or with a new one at its end. `path` is where the scene lies.
/// Errors: kFormat where the text is no scene, or its [focus] is not a table of its own with each
/// key on a line; kUsage for a new one without a distance or a pixel.
Result<std::string> with_focus(std::string_view text, const std::filesystem::path& path,
                               const FocusEdit& edit);
/// The text without [focus]. Errors: kFormat as above.
Result<std::string> without_focus(std::string_view text, const std::filesystem::path& path);

/// The text with another background: `model` is the folder as the file is to have it; frames to
/// learn from go. Errors: kFormat as above.
Result<std::string> with_background_model(std::string_view text, const std::filesystem::path& path,
                                          const std::filesystem::path& model);

}  // namespace mixrig::scene
