// SPDX-License-Identifier: Apache-2.0
// Pixels of a model's pictures by their headers, counted before the file is parsed. Private to this
// module.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string_view>

#include <nlohmann/json.hpp>

#include "hal/base/result.h"

namespace mixrig::scene {

inline constexpr std::size_t kMaxTexels = std::size_t{1} << 28;  ///< sixteen maps of 4096 x 4096
Error too_many_texels();

/// Adds the size that the header of a picture states, if it has one.
class TexelCount {
 public:
  void add(std::span<const std::uint8_t> picture);
  /// Adds the picture of a text "data:image/...;base64,..."; other texts add nothing.
  void add_text(std::string_view text);
  bool is_too_many() const { return texels_ > kMaxTexels; }

 private:
  std::size_t texels_ = 0;
};

/// Counts the pictures of a parsed file that lie in files of `folder` or in a buffer: in `bin`, the
/// buffer of a .glb, in a text of `json` ("data:17" where it begins at 17) or in a file. Returns
/// too_many_texels() or that there are too many pictures.
Result<void> check_pictures(const nlohmann::json& root, std::span<const std::uint8_t> json,
                            std::span<const std::uint8_t> bin, const std::filesystem::path& folder);

}  // namespace mixrig::scene
