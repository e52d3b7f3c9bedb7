// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/views/view_collector.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include <fmt/format.h>

namespace mixrig::calibration {
namespace {

using capture::Capture;

constexpr int kFisheyeFrames = 4;  ///< in place of CollectSettings::frames, of a slower camera
constexpr std::size_t kSmall_px = 512 * 424;
constexpr int kThoroughEvery = 5;
constexpr double kFinestUnit_m = 0.00025;  ///< of depth: 16.38 m in 16 bits
constexpr double kMuchBlur = 2, kMoreBlur_px = 0.3;
constexpr double kDepthChances = 3;

int index_of(const Coverage& coverage, ViewRole role) {
  for (std::size_t c = 0; c < coverage.cameras().size(); ++c)
    if (coverage.cameras()[c].role == role) return static_cast<int>(c);
  return -1;
}

/// Mean depth about each corner, 3 x 3 pixels; 0 where none is known.
Eigen::VectorXd depths_at(const Image<float>& depth_m, const BoardView& board) {
  Eigen::VectorXd depths(static_cast<Eigen::Index>(board.px.size()));
  for (std::size_t i = 0; i < board.px.size(); ++i) {
    const auto x0 = static_cast<int>(std::lround(board.px[i].x()));
    const auto y0 = static_cast<int>(std::lround(board.px[i].y()));
    double sum = 0;
    int known = 0;
    for (int y = std::max(y0 - 1, 0); y <= std::min(y0 + 1, depth_m.height() - 1); ++y)
      for (int x = std::max(x0 - 1, 0); x <= std::min(x0 + 1, depth_m.width() - 1); ++x)
        if (const float d = depth_m.row(y)[x]; d > 0) sum += d, ++known;
    depths[static_cast<Eigen::Index>(i)] = known > 0 ? sum / known : 0;
  }
  return depths;
}

/// True where no frame's board is nearer or farther than the mean of all by more than `rest_m`
/// beyond what the noise of the single depths gives.
bool depth_rests(const std::vector<Capture>& frames, const BoardView& board, double rest_m) {
  const auto corners = static_cast<Eigen::Index>(board.px.size());
  Eigen::MatrixXd depths(corners, static_cast<Eigen::Index>(frames.size()));
  for (std::size_t f = 0; f < frames.size(); ++f)
    depths.col(static_cast<Eigen::Index>(f)) = depths_at(frames[f].depth_m, board);
  std::vector<Eigen::Index> known;
  for (Eigen::Index i = 0; i < corners; ++i)
    if (depths.row(i).minCoeff() > 0) known.push_back(i);
  if (known.size() < 4) return true;  // too little depth to tell
  Eigen::MatrixXd off = depths(known, Eigen::all);
  off.colwise() -= Eigen::VectorXd(off.rowwise().mean());
  const Eigen::RowVectorXd moved = off.colwise().mean();
  off.rowwise() -= moved;
  const auto n = static_cast<double>(known.size());
  const double sigma_m =
      std::sqrt(off.squaredNorm() / ((n - 1) * static_cast<double>(frames.size() - 1)));
  return moved.cwiseAbs().maxCoeff() <= std::hypot(rest_m, kDepthChances * sigma_m / std::sqrt(n));
}

Image<std::uint16_t> counts_of(const Image<float>& amplitude) {
  Image<std::uint16_t> counts(amplitude.size());
  for (int y = 0; y < counts.height(); ++y)
    for (int x = 0; x < counts.width(); ++x)
      counts.row(y)[x] =
          static_cast<std::uint16_t>(std::clamp(amplitude.row(y)[x] + 0.5F, 0.0F, 65535.0F));
  return counts;
}

}  // namespace

Result<ViewCollector> ViewCollector::create(const std::filesystem::path& folder,
                                            const capture::SourceInfo& info, const Capture& first,
                                            const CollectSettings& settings) {
  MIXRIG_TRY(check_view_board(settings.board));
  if (first.plate.empty() || first.depth_m.empty())
    return Error{ErrorCode::kData, "board views need a colour and a depth picture"};
  ViewFolderInfo files;
  files.name = info.name, files.board = settings.board;
  files.target_px = first.plate.size(), files.tof_px = first.depth_m.size();
  if (info.fisheye_rate_hz > 0)
    files.fisheye_px = first.fisheye.empty() ? info.fisheye_px : first.fisheye.size();
  files.amplitude = !first.amplitude.empty();
  files.depth_unit_m =
      info.depth_unit_m > 0 ? std::min(info.depth_unit_m, kFinestUnit_m) : kFinestUnit_m;
  files.depth_kind = info.depth_kind;
  if (info.tof2) {
    if (!first.depth2.amplitude.empty()) files.tof2_px = info.tof2->model.size_px();
    files.depth2_kind = info.tof2->kind;
    files.depth_unit_m = std::min(files.depth_unit_m, info.tof2->unit_m);
  }
  files.step_rad = settings.step_rad;
  std::vector<CoveredCamera> cameras{{ViewRole::kTarget, "target", files.target_px}};
  if (files.amplitude) cameras.push_back({ViewRole::kTof, "tof", files.tof_px});
  if (!files.fisheye_px.empty())
    cameras.push_back({ViewRole::kFisheye, "fisheye", files.fisheye_px});
  const double unit_m = files.depth_unit_m;
  MIXRIG_ASSIGN(ViewFolder output, ViewFolder::create(folder, std::move(files)));
  return ViewCollector(std::move(output),
                       Coverage(settings.board, std::move(cameras), info.target, settings.views),
                       settings, unit_m);
}

/// The board as the target camera sees it, else as a new picture of the fisheye shows it.
Result<std::optional<std::pair<ViewRole, BoardView>>> ViewCollector::find(const Capture& capture) {
  using Found = std::optional<std::pair<ViewRole, BoardView>>;
  gray_ = gray_of(capture.plate);
  // A thorough search of a large picture without a board takes long: where the last frame had none,
  // every fifth frame is searched so.
  const bool small = gray_.size().area() <= kSmall_px;
  const bool thorough = small || !frames_.empty() || counts_.frames % kThoroughEvery == 0;
  MIXRIG_ASSIGN(auto in_target, detect_board(gray_, settings_.board, Refinement::kModel,
                                             thorough ? Search::kThorough : Search::kQuick));
  if (in_target) {
    ++counts_.in_target;
    return Found(std::pair(ViewRole::kTarget, *std::move(in_target)));
  }
  if (index_of(coverage_, ViewRole::kFisheye) < 0 || capture.fisheye.empty() ||
      settings_.every_place ||
      capture.status_of(capture::Stream::kFisheye) != capture::StreamStatus::kFresh)
    return Found();
  MIXRIG_ASSIGN(auto in_fisheye, detect_board(gray_of(capture.fisheye), settings_.board,
                                              Refinement::kModel, Search::kQuick));
  if (!in_fisheye) return Found();
  ++counts_.in_fisheye;
  return Found(std::pair(ViewRole::kFisheye, *std::move(in_fisheye)));
}

bool ViewCollector::full() const {
  const int wanted = reference_ == ViewRole::kTarget ? settings_.frames
                                                     : std::min(settings_.frames, kFisheyeFrames);
  return static_cast<int>(frames_.size()) >= wanted &&
         frames_.back().mid_exposure - frames_.front().mid_exposure >= settings_.still_time;
}

/// A fast camera's frames are thinned, so that as many as wanted take the time that is wanted.
bool ViewCollector::too_soon(const Capture& capture) const {
  return !frames_.empty() && capture.mid_exposure - frames_.back().mid_exposure <
                                 settings_.still_time / settings_.frames;
}

void ViewCollector::push(Capture& capture, BoardView board) {
  const auto most = static_cast<std::size_t>(settings_.frames) + 1;
  if (full() || frames_.size() >= most) {
    std::rotate(frames_.begin(), frames_.begin() + 1, frames_.end());
    boards_.erase(boards_.begin());
  } else {
    frames_.emplace_back();
  }
  std::swap(frames_.back(), capture);
  boards_.push_back(std::move(board));
}

Result<CollectState> ViewCollector::add(Capture& capture) {
  ++counts_.frames;
  if (too_soon(capture)) return CollectState::kSettling;
  const bool same_fisheye =
      capture.status_of(capture::Stream::kFisheye) != capture::StreamStatus::kFresh;
  MIXRIG_ASSIGN(auto found, find(capture));
  if (!found) {
    // Between two pictures of the fisheye nothing new is known of a board that it alone sees.
    if (reference_ == ViewRole::kFisheye && !frames_.empty() && same_fisheye)
      return CollectState::kSettling;
    forget();
    return CollectState::kNoBoard;
  }
  if (found->first != reference_) forget();
  reference_ = found->first;
  push(capture, std::move(found->second));
  if (!full()) return CollectState::kSettling;
  motion_ = board_motion(boards_);
  if (is_still(motion_, settings_.rest_px)) return judge_still();
  if (motion_.corners > 0 &&
      (counts_.least_motion_px == 0 || motion_.most_px < counts_.least_motion_px))
    counts_.least_motion_px = motion_.most_px;
  return CollectState::kMoving;
}

Result<SeenBoards> ViewCollector::boards_in(const StillView& view) const {
  SeenBoards seen;
  for (const CoveredCamera& camera : coverage_.cameras()) {
    Image<std::uint8_t> gray;
    if (camera.role == ViewRole::kTarget) gray = gray_of(view.target);
    if (camera.role == ViewRole::kTof) gray = gray_of(view.amplitude);
    if (camera.role == ViewRole::kFisheye && !view.fisheye.empty()) gray = gray_of(view.fisheye);
    std::optional<BoardView> board;
    if (!gray.empty()) {
      MIXRIG_ASSIGN(board, detect_board(gray, settings_.board));
    }
    seen.push_back(std::move(board));
  }
  return seen;
}

bool ViewCollector::rests_in_tof(const BoardView& tof) const {
  std::vector<BoardView> boards;
  for (const Capture& frame : frames_)
    boards.push_back(find_again(gray_of(counts_of(frame.amplitude)), settings_.board, tof));
  const BoardMotion motion = board_motion(boards);
  // Corners that noise hides in single frames tell nothing of its motion.
  return (motion.corners == 0 || is_still(motion, settings_.rest_px)) &&
         depth_rests(frames_, tof, settings_.rest_m);
}

/// The window shows a board at rest.
Result<CollectState> ViewCollector::judge_still() {
  SeenBoards so_far(coverage_.cameras().size());
  so_far[static_cast<std::size_t>(index_of(coverage_, reference_))] = boards_.back();
  if (!coverage_.is_new(so_far)) return CollectState::kKnown;
  double blur_px = 0;
  for (const BoardView& board : boards_) blur_px = std::max(blur_px, board.blur_px);
  if (reference_ == ViewRole::kTarget) {
    if (sharpest_px_ > 0 && blur_px > kMuchBlur * sharpest_px_ + kMoreBlur_px) {
      ++counts_.blurred;
      return CollectState::kBlurred;
    }
    sharpest_px_ = sharpest_px_ > 0 ? std::min(sharpest_px_, blur_px) : blur_px;
  }
  ++counts_.still;
  std::vector<const Capture*> window;
  for (const Capture& frame : frames_) window.push_back(&frame);
  const StillView view = mean_of(window, depth_unit_m_);
  MIXRIG_ASSIGN(SeenBoards seen, boards_in(view));
  if (const int tof = index_of(coverage_, ViewRole::kTof); tof >= 0) {
    const auto& board = seen[static_cast<std::size_t>(tof)];
    if (!board && reference_ == ViewRole::kTarget) ++counts_.without_tof;
    if (board && !rests_in_tof(*board)) {
      ++counts_.moving_tof;
      return CollectState::kMoving;
    }
  }
  const bool wanted = settings_.every_place || coverage_.gain(seen) > 0;
  if (!wanted || !coverage_.is_new(seen)) return CollectState::kKnown;
  MIXRIG_TRY(folder_.add(view));
  coverage_.add(std::move(seen));
  forget();
  return CollectState::kKept;
}

Error ViewCollector::why_none(const std::string& shows) const {
  const std::string board = board_text(settings_.board);
  if (counts_.in_target + counts_.in_fisheye == 0)
    return {ErrorCode::kData,
            fmt::format("none of {} frames shows the board {}{}", counts_.frames, board,
                        shows.empty()
                            ? ": check its kind, inner corners and light; a checkerboard must be "
                              "seen whole"
                            : ", but one shows " + shows + ": give --board " + shows)};
  if (counts_.still == 0 && counts_.least_motion_px == 0)
    return {
        ErrorCode::kData,
        fmt::format("the board was seen in {} of {} frames, but not in {} in a row, a quarter of "
                    "a second or more: hold it longer, whole in the picture and nearer",
                    counts_.in_target + counts_.in_fisheye, counts_.frames, settings_.frames)};
  if (counts_.still == 0)
    return {
        ErrorCode::kData,
        fmt::format("the board was seen in {} of {} frames and never at rest: it moved by {:.2f} "
                    "px at the least, {:.2f} px count as rest: lean it on something, or allow "
                    "more with --rest{}",
                    counts_.in_target + counts_.in_fisheye, counts_.frames, counts_.least_motion_px,
                    settings_.rest_px,
                    shows.empty() ? "" : ", or is it " + shows + "? (the last picture)")};
  return {
      ErrorCode::kData,
      fmt::format("the board was at rest in the target picture, but the depth camera saw it move "
                  "each time ({} times): check that both cameras deliver frames of one moment "
                  "(mixrig diag)",
                  counts_.moving_tof)};
}

}  // namespace mixrig::calibration
