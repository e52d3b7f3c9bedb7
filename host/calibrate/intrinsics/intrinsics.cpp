// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/intrinsics/intrinsics.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include <fmt/format.h>

#include "hal/base/order_statistics.h"
#include "host/calibrate/intrinsics/lens_choice.h"
#include "host/calibrate/intrinsics/lens_domain.h"
#include "host/calibrate/intrinsics/start_bundle.h"
#include "host/calibrate/intrinsics/two_cameras.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::calibration {
namespace {

using geometry::LensKind;

constexpr double kBadView = 3, kBlurred = 2, kBlurredLeast_px = 1.2;

std::string number(double value) { return fmt::format("{:.3g}", value); }

BundleView bundle_view(const std::vector<Eigen::Vector3d>& points_m, const BoardView& board) {
  BundleView view;
  for (const int id : board.ids) view.points_m.push_back(points_m[static_cast<std::size_t>(id)]);
  view.px = board.px;
  view.used.assign(board.px.size(), 1);
  view.camera_from_board.setZero();
  return view;
}

/// Excludes blurred views, with the reason.
void leave_out_blurred(const std::vector<ObservedView>& views, std::vector<ViewFit>& fits) {
  std::vector<double> blur;
  for (const auto& view : views) blur.push_back(view.board.blur_px);
  const double limit = std::max(kBlurred * upper_median(blur), kBlurredLeast_px);
  for (std::size_t v = 0; v < views.size(); ++v)
    if (views[v].board.blur_px > limit)
      fits[v].why_not = "blurred: " + number(views[v].board.blur_px) + " px, the others " +
                        number(upper_median(blur)) + " px";
}

/// Marks views far worse than the rest, all their points counted; true where there is one.
bool leave_out_bad(const Bundle& bundle, const std::vector<std::size_t>& which,
                   std::vector<ViewFit>& fits) {
  std::vector<double> rms;
  for (BundleView view : bundle.views) {
    const double share = static_cast<double>(std::count(view.used.begin(), view.used.end(), 1)) /
                         static_cast<double>(view.used.size());
    rms.push_back(share < 0.5 ? 1e6 : misfit(bundle, view).rms_px());
  }
  const double typical = upper_median(rms);
  bool any = false;
  for (std::size_t i = 0; i < which.size(); ++i) {
    if (!(rms[i] > kBadView * typical)) continue;
    fits[which[i]].why_not = rms[i] >= 1e6 ? "most of its points do not fit the other views"
                                           : "does not fit the other views: " + number(rms[i]) +
                                                 " px, they " + number(typical) + " px";
    any = true;
  }
  return any;
}

std::vector<std::size_t> usable(const std::vector<ViewFit>& fits) {
  std::vector<std::size_t> which;
  for (std::size_t v = 0; v < fits.size(); ++v)
    if (fits[v].why_not.empty()) which.push_back(v);
  return which;
}

Bundle make_bundle(const BoardSpec& board, const std::vector<ObservedView>& views,
                   const std::vector<std::size_t>& which, LensKind kind) {
  const auto points_m = board_points_m(board);
  Bundle bundle;
  bundle.kind = kind;
  for (const std::size_t v : which) bundle.views.push_back(bundle_view(points_m, views[v].board));
  return bundle;
}

/// The views without the points beyond the image circle, whose number is `beyond`.
std::vector<ObservedView> within_circle(std::vector<ObservedView> views, const ImageCircle& circle,
                                        int& beyond) {
  for (ObservedView& view : views) {
    BoardView kept = view.board;
    kept.ids.clear();
    kept.px.clear();
    for (std::size_t i = 0; i < view.board.px.size(); ++i) {
      if (!circle.contains(view.board.px[i])) continue;
      kept.ids.push_back(view.board.ids[i]);
      kept.px.push_back(view.board.px[i]);
    }
    beyond += static_cast<int>(view.board.px.size() - kept.px.size());
    view.board = kept;
  }
  return views;
}

/// Excludes views of which the image circle leaves too few points for a pose.
void leave_out_empty(const std::vector<ObservedView>& views, std::vector<ViewFit>& fits) {
  constexpr std::size_t kFewestPoints = 6;
  for (std::size_t v = 0; v < views.size(); ++v)
    if (views[v].board.px.size() < kFewestPoints)
      fits[v].why_not = "fewer than " + std::to_string(kFewestPoints) +
                        " of its points lie inside the image circle";
}

Error refuse(const std::string& what) { return {ErrorCode::kData, what}; }

/// Covariance of all parameters; an error where the views do not determine them.
Result<Eigen::MatrixXd> covariance_of(const Bundle& bundle, double sigma_px) {
  const Eigen::MatrixXd information = calibration::information(bundle);
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseMax(1e-30).cwiseInverse();
  const Eigen::MatrixXd balanced = scale.asDiagonal() * information * scale.asDiagonal();
  const estimation::SymmetricSolver solver(balanced);
  constexpr double kLeastPivot = 1e-14;
  if (!(solver.least_pivot() > kLeastPivot))
    return refuse(
        "the views do not determine the camera: they are all alike: tilt the board to all sides by "
        "some 30 degrees");
  const Eigen::Index count = balanced.rows();
  return Eigen::MatrixXd(sigma_px * sigma_px * scale.asDiagonal() *
                         solver.solve(Eigen::MatrixXd::Identity(count, count)) *
                         scale.asDiagonal());
}

/// Fills in the residuals.
Result<void> sum_up(Intrinsics& out) {
  const Misfit sum = misfit(out.bundle);
  const int unknowns = static_cast<int>(out.bundle.free.size() + 6 * out.bundle.views.size());
  const int spare = 2 * sum.points - unknowns;
  if (spare < 1) return refuse("too few points for so many parameters: add views");
  out.rms_px = sum.rms_px();
  out.points = sum.points;
  out.sigma_px = std::sqrt(sum.squares / spare);
  return {};
}

/// Fills the covariance of all parameters, zero for fixed ones; refuses a focal length that is not
/// determined.
Result<void> judge(Intrinsics& out) {
  MIXRIG_ASSIGN(const Eigen::MatrixXd all, covariance_of(out.bundle, out.sigma_px));
  const Eigen::Index size = out.bundle.intrinsics.size();
  out.covariance = Eigen::MatrixXd::Zero(size, size);
  const auto& free = out.bundle.free;
  for (std::size_t i = 0; i < free.size(); ++i)
    for (std::size_t j = 0; j < free.size(); ++j)
      out.covariance(free[i], free[j]) =
          all(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j));
  const double share = std::sqrt(out.covariance(0, 0)) / out.bundle.intrinsics[0];
  constexpr double kMostUnsure = 0.03;
  if (share > kMostUnsure)
    return refuse("the views leave the focal length open to " + number(100 * share) +
                  " %: they are too much alike: tilt the board to all sides by some 30 degrees");
  return {};
}

/// Refuses views that two cameras explain far better than one, and names the smaller group. Both
/// begin at `from`.
Result<void> check_one_camera(const Intrinsics& out, const Bundle& from,
                              const std::vector<std::size_t>& which) {
  const auto split = split_in_two(from);
  if (!split || !tells_apart(*split, out.sigma_px)) return {};
  const auto seconds = std::count(split->second.begin(), split->second.end(), 1);
  const char fewer = 2 * static_cast<std::size_t>(seconds) <= which.size() ? 1 : 0;
  std::string names;
  for (std::size_t i = 0; i < which.size(); ++i)
    if (split->second[i] == fewer) names += (names.empty() ? "" : ", ") + out.views[which[i]].name;
  return refuse("pictures of two cameras, or a zoom that moved: " + names + " fit the others to " +
                number(split->other_px) + " px, and two cameras fit all to " +
                number(split->own_px) + " px: calibrate each camera alone");
}

void fill_view_fits(Intrinsics& out, const std::vector<std::size_t>& which) {
  for (std::size_t i = 0; i < which.size(); ++i) {
    ViewFit& fit = out.views[which[i]];
    const BundleView& view = out.bundle.views[i];
    const Misfit sum = misfit(out.bundle, view);
    fit.used = true;
    fit.rms_px = sum.rms_px();
    fit.points = sum.points;
    fit.points_out = static_cast<int>(view.px.size()) - sum.points;
    out.points_out += fit.points_out;
    fit.camera_from_board = pose_of(view.camera_from_board);
    for (std::size_t k = 0; k < view.px.size(); ++k)
      if (const auto r = residual(out.bundle, view, k)) {
        fit.px.push_back(view.px[k]);
        fit.residual_px.push_back(*r);
      }
  }
}

}  // namespace

Result<Intrinsics> solve_intrinsics(const BoardSpec& board, Size size_px,
                                    const std::vector<ObservedView>& given,
                                    const IntrinsicsOptions& options) {
  Intrinsics out;
  out.circle = options.circle;
  std::vector<ObservedView> views = given;
  for (const ObservedView& view : views) {
    out.views.emplace_back();
    out.views.back().name = view.name;
  }
  for (const ObservedView& view : views)
    for (const auto& px : view.board.px)
      if (!px.allFinite()) return refuse(view.name + ": holds a point that is not finite");
  if (options.circle) {
    views = within_circle(std::move(views), *options.circle, out.points_beyond);
    leave_out_empty(views, out.views);
  }
  leave_out_blurred(views, out.views);
  std::vector<std::size_t> which;
  constexpr int kRounds = 5;
  for (int round = 0; round < kRounds; ++round) {
    which = usable(out.views);
    if (which.size() < kFewestViews)
      return refuse("only " + std::to_string(which.size()) + " usable views of the board, " +
                    std::to_string(kFewestViews) +
                    " are the least and 10 to 20 are good: add views");
    out.bundle = make_bundle(board, views, which, options.kind);
    MIXRIG_TRY(choose_lens(out, size_px, options));
    if (!leave_out_bad(out.bundle, which, out.views)) break;
  }
  which = usable(out.views);
  if (which.size() != out.bundle.views.size())
    return refuse("the views do not agree with each other: pictures of two cameras?");
  const auto foreign = std::count_if(out.views.begin(), out.views.end(), [](const ViewFit& view) {
    return !view.why_not.empty() && !view.why_not.starts_with("blurred") &&
           !view.why_not.starts_with("fewer than");
  });
  // Three of them are enough for a camera of their own.
  constexpr std::size_t kMostShare = 5;
  if (const auto n = static_cast<std::size_t>(foreign);
      4 * n > views.size() || (n >= kFewestViews && kMostShare * n >= views.size()))
    return refuse(
        std::to_string(foreign) + " of " + std::to_string(views.size()) +
        " views do not agree with the rest: pictures of two cameras, or a zoom that moved?");
  const double rms = misfit(out.bundle).rms_px();
  constexpr double kWrongBoard_px = 5;
  if (rms > kWrongBoard_px)
    return refuse("the board is not as stated: its points miss by " + number(rms) +
                  " px in every view: check its columns, rows and sizes");
  MIXRIG_TRY(sum_up(out));
  MIXRIG_TRY(check_one_camera(out, out.bundle, which));
  if (auto judged = judge(out); !judged) {
    // Two cameras can pull one so far off that neither is found from there.
    if (Bundle again = out.bundle; start(again, size_px))
      MIXRIG_TRY(check_one_camera(out, again, which));
    return judged.error();
  }
  out.point_angle_rad = largest_point_angle_rad(out.bundle);
  fill_view_fits(out, which);
  return out;
}

double pose_only_rms_px(const geometry::AnyCamera& camera, const BoardSpec& board,
                        const std::vector<ObservedView>& views) {
  std::vector<std::size_t> which(views.size());
  for (std::size_t i = 0; i < which.size(); ++i) which[i] = i;
  Bundle bundle = make_bundle(board, views, which, geometry::kind_of(camera));
  bundle.intrinsics = geometry::parameters_of(camera);
  for (BundleView& view : bundle.views)
    view.camera_from_board = pose_from_rays(camera, view).value_or(PoseVector::Unit(5));
  if (!solve(bundle, 0)) return std::numeric_limits<double>::infinity();
  return misfit(bundle).rms_px();
}

}  // namespace mixrig::calibration
