// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/intrinsics/lens_choice.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "hal/base/order_statistics.h"
#include "host/calibrate/intrinsics/lens_domain.h"
#include "host/calibrate/intrinsics/start_bundle.h"

namespace mixrig::calibration {
namespace {

using geometry::LensKind;

constexpr double kOutlierSigmas = 5;

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
  return std::max(upper_median(distances(bundle)) / 1.1774, kFloor_px);
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

/// From a start without distortion to the full model, in steps that each start close to a solution.
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

/// A solution with some number of lens terms.
struct Candidate {
  int terms = 0;
  double held_out_px = 0;
  Bundle bundle;
  geometry::AnyCamera camera;
};

/// Which part of the picture a lens must be valid in.
enum class Reach { kImage, kPoints };

Result<geometry::AnyCamera> camera_of(const Bundle& bundle, Size size_px,
                                      const IntrinsicsOptions& options, Reach reach) {
  // A pinhole with a requested number of terms is used even if it folds; the caller may check.
  if (options.lens_terms >= 0 && options.kind == LensKind::kPinhole)
    return geometry::make_camera(bundle.kind, size_px, bundle.intrinsics);
  return reach == Reach::kImage ? camera_in_image(bundle, size_px, options.circle)
                                : camera_near_points(bundle, size_px);
}

/// Solves with each number of lens terms, the most terms first. That solution decides which points
/// are outliers, so that all are judged on the same points, and no simpler lens rejects points only
/// because it cannot fit them. `fold`: why the last lens was left out that folds.
std::vector<Candidate> candidates(const Bundle& from, Size size_px,
                                  const IntrinsicsOptions& options, Reach reach,
                                  std::optional<Error>& fold) {
  std::vector<int> all{options.lens_terms};
  if (options.lens_terms < 0) all = terms_to_try(options.kind);
  std::reverse(all.begin(), all.end());
  std::vector<Candidate> found;
  Bundle start = from;
  for (const int terms : all) {
    Bundle tried = start;
    const auto free = free_parameters(options.kind, terms, options.hold_center);
    if (!solve_robustly(tried, size_px, free, !found.empty())) continue;
    auto camera = camera_of(tried, size_px, options, reach);
    if (!camera) {
      fold = camera.error();
      continue;
    }
    for (std::size_t v = 0; v < start.views.size(); ++v) start.views[v].used = tried.views[v].used;
    found.push_back({terms, held_out_px(tried, free), tried, *camera});
  }
  return found;
}

}  // namespace

Result<void> choose_lens(Intrinsics& out, Size size_px, const IntrinsicsOptions& options) {
  std::optional<Error> fold;
  auto found = candidates(out.bundle, size_px, options, Reach::kImage, fold);
  out.ends_at_points =
      found.empty() && fold && options.kind == LensKind::kFisheye && !options.circle;
  if (out.ends_at_points) found = candidates(out.bundle, size_px, options, Reach::kPoints, fold);
  if (found.empty() && fold && options.kind == LensKind::kPinhole)
    return Error{ErrorCode::kData,
                 "the lens that fits the views folds where none reaches: show the board near the "
                 "sides of the picture, or ask for fewer terms by --lens"};
  if (found.empty() && fold) return *fold;
  if (found.empty())
    return Error{ErrorCode::kData,
                 "no camera fits these views: is the board as stated, and is --model right?"};
  double least = std::numeric_limits<double>::infinity();
  for (const Candidate& c : found) least = std::min(least, c.held_out_px);
  constexpr double kAsGood = 1.005;
  const Candidate* best = &found.back();
  for (const Candidate& c : found)
    if (c.held_out_px <= kAsGood * least) best = &c;  // the richest come first
  out.bundle = best->bundle;
  out.camera = best->camera;
  out.lens_terms = best->terms;
  out.held_out_px = std::isfinite(best->held_out_px) ? best->held_out_px : 0;
  return {};
}

}  // namespace mixrig::calibration
