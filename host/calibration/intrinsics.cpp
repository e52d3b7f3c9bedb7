// SPDX-License-Identifier: Apache-2.0
#include "host/calibration/intrinsics.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "host/calibration/start_bundle.h"

namespace mixrig::calibration {
namespace {

using geometry::LensKind;

constexpr int kFewestViews = 3;
constexpr double kOutlierSigmas = 5, kBadView = 3, kBlurred = 2, kBlurredLeast_px = 1.2;

double median(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::string number(double value, const char* format = "%.3g") {
  char text[40];
  std::snprintf(text, sizeof(text), format, value);
  return text;
}

/// Indices of the parameters that are solved for.
std::vector<int> free_parameters(LensKind kind, int lens_terms, bool hold_center) {
  std::vector<int> free{0, 1};
  if (!hold_center) free.insert(free.end(), {2, 3});
  const int most = geometry::parameter_count(kind) - 4;
  for (int i = 0; i < std::min(lens_terms, most); ++i) free.push_back(4 + i);
  return free;
}

std::vector<int> terms_to_try(LensKind kind) {
  return kind == LensKind::kPinhole ? std::vector{2, 4, 5, 8} : std::vector{2, 4};
}

BundleView bundle_view(const std::vector<Eigen::Vector3d>& points_m, const BoardView& board) {
  BundleView view;
  for (const int id : board.ids) view.points_m.push_back(points_m[static_cast<std::size_t>(id)]);
  view.px = board.px;
  view.used.assign(board.px.size(), 1);
  view.camera_from_board.setZero();
  return view;
}

/// Distances of all points in use, px.
std::vector<double> distances(const Bundle& bundle) {
  std::vector<double> all;
  for (const BundleView& view : bundle.views)
    for (std::size_t i = 0; i < view.px.size(); ++i)
      if (const auto r = residual(bundle, view, i); view.used[i] != 0)
        all.push_back(r ? r->norm() : 1e3);
  return all;
}

/// Sigma of one coordinate from the median distance (Rayleigh: median = 1.1774 sigma).
double robust_sigma_px(const Bundle& bundle) {
  constexpr double kFloor_px = 1e-4;
  return std::max(median(distances(bundle)) / 1.1774, kFloor_px);
}

/// Leaves out points beyond some sigmas, and takes back those within. Returns how many changed.
int choose_points(Bundle& bundle, double sigma_px) {
  int changed = 0;
  for (BundleView& view : bundle.views)
    for (std::size_t i = 0; i < view.px.size(); ++i) {
      const auto r = residual(bundle, view, i);
      const char use = r && r->norm() < kOutlierSigmas * sigma_px ? 1 : 0;
      changed += use != view.used[i] ? 1 : 0;
      view.used[i] = use;
    }
  return changed;
}

/// From a start without lens to the full model, in steps that each have something to go by.
bool solve_in_steps(Bundle& bundle, const std::vector<int>& free) {
  constexpr double kFirstHuber_px = 3, kHuber_px = 1;
  bundle.free = {};
  if (!solve(bundle, kFirstHuber_px)) return false;
  for (const std::size_t count :
       {std::size_t{2}, std::min(free.size(), std::size_t{6}), free.size()}) {
    bundle.free.assign(free.begin(),
                       free.begin() + static_cast<std::ptrdiff_t>(std::min(count, free.size())));
    if (!solve(bundle, count == free.size() ? kHuber_px : kFirstHuber_px)) return false;
  }
  return true;
}

/// Robust solution of the views given; false where it fails. `points_chosen`: by a richer lens, and
/// to be kept.
bool solve_robustly(Bundle& bundle, Size size_px, const std::vector<int>& free,
                    bool points_chosen) {
  if (bundle.intrinsics.size() == 0 && !start(bundle, size_px)) return false;
  if (!solve_in_steps(bundle, free)) return false;
  if (points_chosen) return solve(bundle, 0);
  constexpr int kRounds = 4;
  for (int round = 0; round < kRounds; ++round) {
    const int changed = choose_points(bundle, robust_sigma_px(bundle));
    if (!solve(bundle, 0)) return false;
    if (changed == 0) break;
  }
  return true;
}

struct Fold {
  double squares = 0;
  int points = 0;
};

/// The error on views that are left out, five folds; infinity where a fold cannot be solved.
double held_out_px(const Bundle& solved, const std::vector<int>& free) {
  constexpr std::size_t kFolds = 5;
  Fold sum;
  for (std::size_t fold = 0; fold < std::min(kFolds, solved.views.size()); ++fold) {
    Bundle fit = solved, rest = solved;
    fit.views.clear();
    rest.views.clear();
    for (std::size_t v = 0; v < solved.views.size(); ++v)
      (v % kFolds == fold ? rest : fit).views.push_back(solved.views[v]);
    fit.free = free;
    if (fit.views.size() < kFewestViews || !solve(fit, 0))
      return std::numeric_limits<double>::infinity();
    rest.intrinsics = fit.intrinsics;
    rest.free = {};
    if (!solve(rest, 0)) return std::numeric_limits<double>::infinity();
    const Misfit one = misfit(rest);
    sum.squares += one.squares;
    sum.points += one.points;
  }
  return std::sqrt(sum.squares / std::max(sum.points, 1));
}

/// Names of views that must not take part, with the reason.
void leave_out_blurred(const std::vector<ObservedView>& views, std::vector<ViewFit>& fits) {
  std::vector<double> blur;
  for (const auto& view : views) blur.push_back(view.board.blur_px);
  const double limit = std::max(kBlurred * median(blur), kBlurredLeast_px);
  for (std::size_t v = 0; v < views.size(); ++v)
    if (views[v].board.blur_px > limit)
      fits[v].why_not = "blurred: " + number(views[v].board.blur_px) + " px, the others " +
                        number(median(blur)) + " px";
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
  const double typical = median(rms);
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

Error refuse(const std::string& what) { return {ErrorCode::kData, what}; }

/// Covariance of all parameters; an error where the views do not carry them.
Result<Eigen::MatrixXd> covariance_of(const Bundle& bundle, double sigma_px) {
  const Eigen::MatrixXd information = calibration::information(bundle);
  const Eigen::VectorXd scale = information.diagonal().cwiseSqrt().cwiseMax(1e-30).cwiseInverse();
  const Eigen::MatrixXd balanced = scale.asDiagonal() * information * scale.asDiagonal();
  const Eigen::LDLT<Eigen::MatrixXd> solver(balanced);
  constexpr double kLeastPivot = 1e-14;
  if (solver.info() != Eigen::Success || !(solver.vectorD().minCoeff() > kLeastPivot))
    return refuse(
        "the views do not carry the camera: they are all alike: tilt the board to all sides by "
        "some 30 degrees");
  const Eigen::Index count = balanced.rows();
  return Eigen::MatrixXd(sigma_px * sigma_px * scale.asDiagonal() *
                         solver.solve(Eigen::MatrixXd::Identity(count, count)) *
                         scale.asDiagonal());
}

/// Fills the covariance of all parameters, held ones zero; refuses a focal length that is not
/// known.
Result<void> judge(Intrinsics& out) {
  const Misfit sum = misfit(out.bundle);
  const int unknowns = static_cast<int>(out.bundle.free.size() + 6 * out.bundle.views.size());
  const int spare = 2 * sum.points - unknowns;
  if (spare < 1) return refuse("too few points for so many parameters: add views");
  out.rms_px = sum.rms_px();
  out.points = sum.points;
  out.sigma_px = std::sqrt(sum.squares / spare);
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

/// A solution with some number of lens terms.
struct Candidate {
  int terms = 0;
  double held_out_px = 0;
  Bundle bundle;
};

/// Solves with each number of lens terms, the richest first: it decides which points are wrong, so
/// that all are judged on the same points and none calls wrong what it cannot bend to. `folds`: a
/// lens was left out because it folds within the picture.
std::vector<Candidate> candidates(const Bundle& from, Size size_px,
                                  const IntrinsicsOptions& options, bool& folds) {
  std::vector<int> all{options.lens_terms};
  if (options.lens_terms < 0) all = terms_to_try(options.kind);
  std::reverse(all.begin(), all.end());
  std::vector<Candidate> found;
  Bundle start = from;
  for (const int terms : all) {
    Bundle tried = start;
    const auto free = free_parameters(options.kind, terms, options.hold_center);
    if (!solve_robustly(tried, size_px, free, !found.empty())) continue;
    // What was asked for is given, folds and all; the caller may look.
    if (options.lens_terms < 0 &&
        !validate(geometry::make_camera(tried.kind, size_px, tried.intrinsics))) {
      folds = true;
      continue;
    }
    for (std::size_t v = 0; v < start.views.size(); ++v) start.views[v].used = tried.views[v].used;
    found.push_back({terms, held_out_px(tried, free), tried});
  }
  return found;
}

/// Takes the number of lens terms that is asked for, or that does best on views left out; of those
/// within half a per cent of the best, the fewest.
Result<void> choose_lens(Intrinsics& out, Size size_px, const IntrinsicsOptions& options) {
  bool folds = false;
  const auto found = candidates(out.bundle, size_px, options, folds);
  if (found.empty() && folds)
    return refuse(
        "the lens that fits the views folds where none reaches: show the board near the "
        "sides of the picture, or ask for fewer terms by --lens");
  if (found.empty())
    return refuse("no camera fits these views: is the board as stated, and is --model right?");
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& c : found) least = std::min(least, c.held_out_px);
  constexpr double kAsGood = 1.005;
  const Candidate* best = &found.back();
  for (const Candidate& c : found)
    if (c.held_out_px <= kAsGood * least) best = &c;  // the richest come first
  out.bundle = best->bundle;
  out.lens_terms = best->terms;
  out.held_out_px = std::isfinite(best->held_out_px) ? best->held_out_px : 0;
  return {};
}

void tell_views(Intrinsics& out, const std::vector<std::size_t>& which) {
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
                                    const std::vector<ObservedView>& views,
                                    const IntrinsicsOptions& options) {
  Intrinsics out;
  for (const ObservedView& view : views) {
    out.views.emplace_back();
    out.views.back().name = view.name;
  }
  for (const ObservedView& view : views)
    for (const auto& px : view.board.px)
      if (!px.allFinite()) return refuse(view.name + ": holds a point that is not finite");
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
    return !view.why_not.empty() && !view.why_not.starts_with("blurred");
  });
  if (4 * static_cast<std::size_t>(foreign) > views.size())
    return refuse(
        std::to_string(foreign) + " of " + std::to_string(views.size()) +
        " views do not agree with the rest: pictures of two cameras, or a zoom that moved?");
  const double rms = misfit(out.bundle).rms_px();
  constexpr double kWrongBoard_px = 5;
  if (rms > kWrongBoard_px)
    return refuse("the board is not as stated: its points miss by " + number(rms) +
                  " px in every view: check its columns, rows and sizes");
  MIXRIG_TRY(judge(out));
  out.camera = geometry::make_camera(options.kind, size_px, out.bundle.intrinsics);
  tell_views(out, which);
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
