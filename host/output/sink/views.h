// SPDX-License-Identifier: Apache-2.0
// The pictures of a run that an operator can view.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

namespace mixrig::output {

enum class View : std::uint8_t { kComposite, kPlate, kKey, kDepth, kLight, kMatte };
inline constexpr std::size_t kViews = 6;
inline constexpr std::array<std::string_view, kViews> kViewNames{"composite", "plate", "key",
                                                                 "depth",     "light", "matte"};

inline std::string_view name(View view) { return kViewNames[static_cast<std::size_t>(view)]; }
inline std::optional<View> view_named(std::string_view text) {
  for (std::size_t i = 0; i < kViews; ++i)
    if (kViewNames[i] == text) return static_cast<View>(i);
  return std::nullopt;
}

}  // namespace mixrig::output
