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
/// A block does not count where its pixels differ from the learned ones in more than light and
/// noise: by more than this part of the luminance, root mean square of the channels.
inline constexpr float kRoomLightRest = 0.1F;
/// Nor does it count where its colour is another: least channel of its light over the largest.
inline constexpr float kRoomLightHue = 0.6F;
/// The standard deviation of the room's colour about its light is measured; kColorFlicker counts
/// like this number of blocks.
inline constexpr float kRoomLightPrior = 2.0F;
/// Most of that standard deviation, as a part of the luminance.
inline constexpr float kRoomLightVary = 0.09F;
/// A pixel shows the room beyond doubt within this squared distance, in variances: the mean of
/// three channels' noise.
inline constexpr float kSurelyRoom = 3.0F;

}  // namespace mixrig::render
