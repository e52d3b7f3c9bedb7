// SPDX-License-Identifier: Apache-2.0
#include "studio/board/board_options.h"

#include <fmt/format.h>

namespace mixrig::studio {
namespace {

Error wrong_board(const std::string& what) { return {ErrorCode::kUsage, "studio: " + what}; }

Result<void> check_board_range(const char* what, double value, double low, double high) {
  if (value >= low && value <= high) return {};
  return wrong_board(fmt::format("{} must be {} to {}, not {}", what, low, high, value));
}

}  // namespace

Result<void> check_board_options(const BoardOptions& o) {
  MIXRIG_TRY(check_board_range("views", o.views, 1, 500));
  MIXRIG_TRY(check_board_range("width of the target picture", o.size_px.width, 64, 4096));
  MIXRIG_TRY(check_board_range("height of the target picture", o.size_px.height, 64, 4096));
  MIXRIG_TRY(check_board_range("threads", o.threads, 0, 256));
  MIXRIG_TRY(check_board_range("board columns", o.board.columns, 3, 40));
  MIXRIG_TRY(check_board_range("board rows", o.board.rows, 3, 40));
  MIXRIG_TRY(check_board_range("square", o.board.square_m, 0.005, 0.5));
  MIXRIG_TRY(check_board_range("board bend", o.board.bend_m, -0.02, 0.02));
  MIXRIG_TRY(check_board_range("most distance", o.far_m, 0.5, 10));
  MIXRIG_TRY(check_board_range("width of the fisheye's picture", o.fisheye_px.width, 64, 4096));
  MIXRIG_TRY(check_board_range("height of the fisheye's picture", o.fisheye_px.height, 64, 4096));
  MIXRIG_TRY(check_board_range("rest of the board", o.hand.rest_s, 0.1, 10));
  MIXRIG_TRY(check_board_range("move of the board", o.hand.move_s, 0.1, 10));
  MIXRIG_TRY(check_board_range("tremor", o.hand.tremor_m, 0, 0.01));
  MIXRIG_TRY(check_board_range("blur", o.blur_px, 0, 10));
  MIXRIG_TRY(check_board_range("noise", o.noise, 0, 100));
  MIXRIG_TRY(check_board_range("tolerance", o.tolerance, 0, 2));
  MIXRIG_TRY(check_board_range("lens error", o.lens_error_px, 0, 5));
  MIXRIG_TRY(check_board_range("depth error", o.depth_error_m.value_or(0), 0, 0.1));
  const bool markers = o.board.kind == BoardKind::kCharuco;
  const auto most = static_cast<int>(marker_bits().size());
  if (markers && o.board.columns * o.board.rows / 2 > most)
    return wrong_board(
        fmt::format("a ChArUco board of dictionary 4x4_50 has at most {} squares, not {}", 2 * most,
                    o.board.columns * o.board.rows));
  if (markers &&
      !(o.board.marker_m > 0.3 * o.board.square_m && o.board.marker_m < 0.95 * o.board.square_m))
    return wrong_board(fmt::format("a marker must be 0.3 to 0.95 of a square, not {:.4g}",
                                   o.board.marker_m / o.board.square_m));
  return {};
}

BoardInfo board_info_of(const BoardOptions& o) {
  BoardInfo info;
  info.name = fmt::format("board {}, {}", o.seed, name(o.rig));
  info.options = o;
  info.rig = rig_of_seed(o.rig, o.seed, o.size_px, o.tolerance, o.second_tof);
  if (o.second_tof) info.name += fmt::format("+{}", name(*o.second_tof));
  if (o.fisheye_px != info.rig.fisheye.size_px)
    info.rig.fisheye = scaled(info.rig.fisheye, o.fisheye_px);
  if (o.lens_error_px > 0) info.rig.target = with_lens_error(info.rig.target, o.lens_error_px);
  for (TofSensor* tof : {&info.rig.tof, info.rig.tof2 ? &*info.rig.tof2 : nullptr})
    if (tof != nullptr && o.depth_error_m)
      set_depth_error(*tof, *o.depth_error_m);
    else if (tof != nullptr && !o.raw_depth)
      tof->wiggle_rad *= tof->wiggle_left;
  return info;
}

}  // namespace mixrig::studio
