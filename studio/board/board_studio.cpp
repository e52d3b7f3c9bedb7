// SPDX-License-Identifier: Apache-2.0
#include "studio/board/board_studio.h"

#include "studio/board/board_options.h"
#include "studio/board/board_state.h"

namespace mixrig::studio {

BoardStudio::BoardStudio(std::unique_ptr<State> state) : state_(std::move(state)) {}
BoardStudio::BoardStudio(BoardStudio&&) noexcept = default;
BoardStudio& BoardStudio::operator=(BoardStudio&&) noexcept = default;
BoardStudio::~BoardStudio() = default;

Result<BoardStudio> BoardStudio::create(const BoardOptions& options) {
  MIXRIG_TRY(check_board_options(options));
  MIXRIG_ASSIGN(const TraceDevice device, TraceDevice::create());
  return BoardStudio(std::make_unique<State>(options, device));
}

const BoardInfo& BoardStudio::info() const { return state_->info; }

void BoardStudio::render(int number, BoardView& view) {
  State& s = *state_;
  const BoardPlace place = board_place(s.info, number);
  const State::Poses pose(&place.target_from_board, 1);
  view.number = number;
  s.coarse_border = false;
  view.pan_rad = place.pan_rad, view.tilt_rad = place.tilt_rad;
  view.target_from_board = place.target_from_board;
  s.turn_to(place);
  s.draw_color(s.target, {}, pose, number, 1, s.behind_target, view.target);
  s.draw_color(s.fisheye, s.info.rig.target_from_fisheye, pose, number, 2, s.behind_fisheye,
               view.fisheye);
  s.draw_tofs([&](const TofSensor&) { return pose; }, view);
}

}  // namespace mixrig::studio
