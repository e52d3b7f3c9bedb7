// SPDX-License-Identifier: Apache-2.0
// Pass key: what lies beside what a mirror shows.
#pragma once

namespace mixrig::render {

/// What is unknown in a block is background where the 3x3 blocks around show what a mirror shows,
/// at least this part of their foreground: who is seen there has hair and sleeves without depth,
/// which look like people. Chosen on walk 7 and 11, edges 5 and talk 8 (docs/edges.md).
inline constexpr float kMirrorPart = 0.1F;

}  // namespace mixrig::render
