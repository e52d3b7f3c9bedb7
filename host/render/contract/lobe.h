// SPDX-License-Identifier: Apache-2.0
// Light from all sides in glTF's specular lobe (GGX, correlated Smith, Schlick), fitted to sums
// over 65536 directions for roughness 0.2 to 1 and cosines of the eye from 0.1: within 0.04 and
// 0.02.
#pragma once

#include <array>

namespace mixrig::render {

/// Share that a perfect mirror of facets loses: sum of r^i c^j, r roughness, c cosine of the eye:
/// i = 1 with j = 0, 1, 2, then i = 2, 3.
inline constexpr std::array<float, 9> kLobeLoss{0.8569F,  -3.2783F, 2.0998F,  -1.7368F, 9.5498F,
                                                -6.7483F, 1.0595F,  -5.3336F, 4.2425F};
/// Share by the grazing part of Fresnel's: sum of r^i (1 - c)^j: j = 2 with i = 0, 1, 2, then j
/// = 4.
inline constexpr std::array<float, 6> kLobeGrazing{-0.1197F, 0.5637F,  -0.4662F,
                                                   1.3237F,  -3.3392F, 2.1081F};

}  // namespace mixrig::render
