// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/light_change.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <Eigen/Core>

#include "hal/base/order_statistics.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::lights {
namespace {

constexpr std::size_t kLeastPlaces = 100;
constexpr int kFitRounds = 12, kFitSweeps = 200;
constexpr double kPriorOfOthers = 1e-4;  // weight for a source to change as the others do
constexpr double kTukeySigmas = 4.685;   // residuals beyond have no weight
constexpr double kLeastScatter = 0.02;   // of a ratio: noise and rounding of one plate pixel
constexpr double kAgrees = 0.08;         // relative difference of two changes that agree
constexpr double kSurfaceShare = 0.05;   // least mean share of a source in a surface's light
constexpr int kSurfacePlaces = 4;        // least number of places of a surface

/// Normal equations of weighted least squares.
struct Normal {
  Eigen::MatrixXd a;
  Eigen::VectorXd b;
};

Normal normal_of(std::span<const WatchedPlace> places, const std::vector<double>& weight,
                 double all_others) {
  const Eigen::Index n = places.front().share.size();
  Normal normal{Eigen::MatrixXd::Zero(n, n), Eigen::VectorXd::Zero(n)};
  double sum = 0;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const Eigen::VectorXd& share = places[i].share;
    normal.a += weight[i] * share * share.transpose();
    normal.b += weight[i] * places[i].ratio * share;
    sum += weight[i];
  }
  normal.a.diagonal().array() += kPriorOfOthers * sum;
  normal.b.array() += kPriorOfOthers * sum * all_others;
  return normal;
}

/// Least squares without negative unknowns, one unknown at a time.
void solve(const Normal& normal, Eigen::VectorXd& x) {
  for (int sweep = 0; sweep < kFitSweeps; ++sweep) {
    double largest = 0;
    for (Eigen::Index j = 0; j < x.size(); ++j) {
      const double step = (normal.b[j] - normal.a.row(j).dot(x)) / normal.a(j, j);
      const double next = std::max(0.0, x[j] + step);
      largest = std::max(largest, std::abs(next - x[j]));
      x[j] = next;
    }
    if (largest < 1e-6) break;
  }
}

/// The change that the largest part of the light agrees on.
void find_gain(LightChange& change) {
  const Eigen::VectorXd& part = change.part;
  for (Eigen::Index j = 0; j < part.size(); ++j) {
    double weight = 0, sum = 0;
    for (Eigen::Index k = 0; k < part.size(); ++k)
      if (std::abs(change.shown[k] - change.shown[j]) <= kAgrees * change.shown[j])
        weight += part[k], sum += part[k] * change.shown[k];
    if (weight > change.gain_weight && sum > 0)
      change.gain_weight = weight, change.gain = sum / weight;
  }
}

/// Evidence of one surface about a source.
struct SurfaceVote {
  int places = 0;
  double share = 0, light = 0;  ///< sums of the source's share, and of its square
  /// Sums of squared, limited residuals: where the source changed as it showed, and where it
  /// changed by LightChange::gain.
  double changed = 0, same = 0;
};

/// Finds the share of each source's light on surfaces that confirm its change. A shadow, or a thing
/// that moved, shows on few of the surfaces that a source lights.
void find_agreement(std::span<const WatchedPlace> places, double most_off, LightChange& change) {
  const Eigen::Index sources = change.shown.size();
  change.agreed = Eigen::VectorXd::Zero(sources);
  change.surfaces = Eigen::VectorXi::Zero(sources);
  const auto cut = [&](double off) { return std::min(off * off, most_off * most_off); };
  for (Eigen::Index j = 0; j < sources; ++j) {
    std::map<int, SurfaceVote> votes;
    for (const WatchedPlace& place : places) {
      const double off = place.ratio - place.share.dot(change.shown), share = place.share[j];
      SurfaceVote& vote = votes[place.surface];
      ++vote.places, vote.share += share, vote.light += share * share;
      vote.changed += cut(off), vote.same += cut(off + share * (change.shown[j] - change.gain));
    }
    double all = 0;
    for (const auto& [surface, vote] : votes) {
      if (vote.places < kSurfacePlaces || vote.share < kSurfaceShare * vote.places) continue;
      all += vote.light;
      if (vote.changed < vote.same) change.agreed[j] += vote.light, ++change.surfaces[j];
    }
    if (all > 0) change.agreed[j] /= all;
  }
}

}  // namespace

std::optional<LightChange> fit_light_change(std::span<const WatchedPlace> places) {
  if (places.size() < kLeastPlaces) return std::nullopt;
  const Eigen::Index sources = places.front().share.size();
  std::vector<double> ratios, off(places.size()), weight(places.size(), 1.0);
  ratios.reserve(places.size());
  for (const WatchedPlace& place : places) ratios.push_back(place.ratio);
  const double median = upper_median_in_place(std::span(ratios));
  LightChange change;
  change.shown = Eigen::VectorXd::Constant(sources, median);
  double most_off = 0;
  for (int round = 0; round < kFitRounds; ++round) {
    for (std::size_t i = 0; i < places.size(); ++i)
      off[i] = std::abs(places[i].ratio - places[i].share.dot(change.shown));
    ratios = off;
    const double scale =
        std::max(1.4826 * upper_median_in_place(std::span(ratios)), kLeastScatter * median);
    most_off = kTukeySigmas * scale;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const double t = off[i] / (kTukeySigmas * scale);
      // First without an end: what a lamp changes must not be an outlier of the median.
      weight[i] = round < kFitRounds / 2 ? 1 / std::max(1.0, off[i] / scale)
                                         : (t < 1 ? (1 - t * t) * (1 - t * t) : 0.0);
    }
    solve(normal_of(places, weight, median), change.shown);
  }
  double sum = 0, squares = 0;
  change.part = Eigen::VectorXd::Zero(sources);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double residual = places[i].ratio - places[i].share.dot(change.shown);
    sum += weight[i], squares += weight[i] * residual * residual;
    change.part += places[i].share / static_cast<double>(places.size());
  }
  if (!(sum > 0)) return std::nullopt;
  const Eigen::MatrixXd a = normal_of(places, weight, median).a;
  change.sigma = (estimation::inverse_of(a).diagonal() * squares / sum).cwiseSqrt();
  change.places_weight = sum / static_cast<double>(places.size());
  find_gain(change);
  find_agreement(places, most_off, change);
  return change;
}

}  // namespace mixrig::lights
