// SPDX-License-Identifier: Apache-2.0
// Pass key, still camera: numbers of both back ends for the light of the room beside people,
// relative to the learned light (docs/method/compositor.md, "key").
#pragma once

namespace mixrig::render {

/// Radius, blocks, in which blocks without foreground are compared with the learned colours, 5x5.
inline constexpr int kRoomLightBlocks = 2;
/// Rows of a block that are compared: one of kRoomLightRows, from kRoomLightRow on.
inline constexpr int kRoomLightRow = 2;
inline constexpr int kRoomLightRows = 4;
/// Least number of compared pixels of a block, half of them.
inline constexpr float kRoomLightLeast = 8.0F;
/// A pixel brighter than the learned light by more than this factor shows no room.
inline constexpr float kRoomLightMost = 1.5F;
/// A block does not count where its pixels differ from the learned ones in more than light: by more
/// than this part of it, root mean square.
inline constexpr float kRoomLightRest = 0.1F;
/// Nor does it count where its colour is another: least channel of its light over the largest.
inline constexpr float kRoomLightHue = 0.6F;
/// A pixel shows the room beyond doubt within this squared distance, in variances: the mean of
/// three channels' noise.
inline constexpr float kSurelyRoom = 3.0F;

}  // namespace mixrig::render
