// SPDX-License-Identifier: Apache-2.0
// The board in the hands of a person who takes it from view to view.
#pragma once

#include "studio/board/board_studio.h"

namespace mixrig::studio {

/// Pose of the board at a time: it rests at the pose of view 1 from time 0 on, is taken to that of
/// view 2, rests there, and so on (HandMotion); without hands, those of a board that stands still.
geometry::Pose hand_pose(const BoardInfo& info, double time_s);

/// True while `time_s` lies in a rest.
bool hand_rests(const HandMotion& hand, double time_s);

}  // namespace mixrig::studio
