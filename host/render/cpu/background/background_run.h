// SPDX-License-Identifier: Apache-2.0
// Pass background: types shared by its files.
#pragma once

#include <array>
#include <cstdint>

#include "host/render/cpu/background/background.h"

namespace mixrig::render::cpu {

inline constexpr std::size_t kBackgroundRun = MovingBackground::kMostColumns;
/// Sigma that marks an unknown colour.
inline constexpr std::uint16_t kUnknownColor = 65535;

/// Positions of up to kBackgroundRun pixels of a view row in the faces of a model.
struct MovingBackground::Run {
  alignas(64) std::array<float, kBackgroundRun> u_px, v_px;
  alignas(64) std::array<float, kBackgroundRun> z_m;  ///< in axes of the face
  alignas(64)
      std::array<float, kBackgroundRun> score;  ///< larger for the model that saw the pixel better
  alignas(64) std::array<std::int32_t, kBackgroundRun> face;
  alignas(64) std::array<std::int32_t, kBackgroundRun> part;  ///< index of the model
  alignas(64) std::array<std::int32_t, kBackgroundRun> at;    ///< nearest pixel of the tables with
                                                              ///< 4-byte values; 0: none
  std::size_t count = 0;
  /// `at` of the kLanes pixels from `first` on; 0 beyond the run.
  IntLanes places(std::size_t first) const {
    const IntLanes within = lane_numbers() < static_cast<float>(static_cast<int>(count - first));
    return within ? load<IntLanes>(&at[first]) : IntLanes{};
  }
};

/// What find_in() sets in a Run: only the position, or `z_m`, `score` and `part` too.
enum class MovingBackground::Find { kPlace, kAll };

}  // namespace mixrig::render::cpu
