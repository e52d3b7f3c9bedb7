// SPDX-License-Identifier: Apache-2.0
// Pass background: what its files share.
#pragma once

#include <array>
#include <cstdint>

#include "host/render/cpu/background/background.h"

namespace mixrig::render::cpu {

inline constexpr std::size_t kBackgroundRun = MovingBackground::kMostColumns;
/// Spread of a colour that is not known.
inline constexpr std::uint16_t kUnknownColor = 65535;

/// Where up to kBackgroundRun pixels of a row of the view lie in the faces of a model.
struct MovingBackground::Run {
  alignas(64) std::array<float, kBackgroundRun> u_px, v_px;
  alignas(64) std::array<float, kBackgroundRun> z_m;    ///< in axes of the face
  alignas(64) std::array<float, kBackgroundRun> score;  ///< of models, the larger the better it saw
                                                        ///< the pixel
  alignas(64) std::array<std::int32_t, kBackgroundRun> face;
  alignas(64) std::array<std::int32_t, kBackgroundRun> part;  ///< which model
  alignas(64) std::array<std::int32_t, kBackgroundRun> at;    ///< nearest pixel of the tables of
                                                              ///< 4-byte values; 0: none
  std::size_t count = 0;
  /// `at` of the kLanes pixels from `first` on; beyond the run none.
  IntLanes places(std::size_t first) const {
    const IntLanes within = lane_numbers() < static_cast<float>(static_cast<int>(count - first));
    return within ? load<IntLanes>(&at[first]) : IntLanes{};
  }
};

/// What of a Run is found: `z_m`, `score` and `part` too, or only where it lies.
enum class MovingBackground::Find { kPlace, kAll };

}  // namespace mixrig::render::cpu
