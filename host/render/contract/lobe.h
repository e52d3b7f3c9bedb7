// SPDX-License-Identifier: Apache-2.0
// Reflection of uniform light by glTF's specular lobe (GGX, correlated Smith, Schlick): polynomials
// fitted to sums over 65536 directions, for roughness 0.2 to 1 and view cosines from 0.1 on. Errors
// are within 0.04 (loss) and 0.02 (grazing).
#pragma once

#include <array>

namespace mixrig::render {

/// Share of light that a rough perfect mirror loses: sum of r^i c^j with roughness r and view
/// cosine c, in the order i = 1, 2, 3, each with j = 0, 1, 2.
inline constexpr std::array<float, 9> kLobeLoss{0.8569F,  -3.2783F, 2.0998F,  -1.7368F, 9.5498F,
                                                -6.7483F, 1.0595F,  -5.3336F, 4.2425F};
/// Share by the grazing part of Fresnel's term: sum of r^i (1 - c)^j, first j = 2 with i = 0, 1, 2,
/// then j = 4.
inline constexpr std::array<float, 6> kLobeGrazing{-0.1197F, 0.5637F,  -0.4662F,
                                                   1.3237F,  -3.3392F, 2.1081F};

}  // namespace mixrig::render
