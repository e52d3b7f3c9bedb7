// SPDX-License-Identifier: Apache-2.0
#include "host/math/estimation/markers/constellation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <string>

#include "host/math/estimation/points/rigid_fit.h"

namespace mixrig::estimation {
namespace {

using Eigen::Vector3d;
using Points = std::span<const Vector3d>;

/// A labelling: marker of each observed point, how many, and the squared error in sigmas.
struct Labelling {
  std::vector<int> marker_of_point;
  int count = 0;
  double cost = 0;
  bool better_than(const Labelling& other) const {
    return count != other.count ? count > other.count : cost < other.cost;
  }
};

/// Gives every marker its nearest free observed point within the gate.
Labelling label(Points markers, Points observed, const geometry::Pose& pose, double sigma_m) {
  // The pose comes from three noisy points: hence a wide gate; the refit judges the result.
  const double gate_m = 6 * sigma_m;
  Labelling result{std::vector<int>(observed.size(), -1), 0, 0};
  for (std::size_t m = 0; m < markers.size(); ++m) {
    const Vector3d at = pose * markers[m];
    double nearest = gate_m;
    int chosen = -1;
    for (std::size_t i = 0; i < observed.size(); ++i) {
      const double distance = (observed[i] - at).norm();
      if (result.marker_of_point[i] < 0 && distance < nearest)
        nearest = distance, chosen = static_cast<int>(i);
    }
    if (chosen < 0) continue;
    result.marker_of_point[chosen] = static_cast<int>(m);
    ++result.count;
  }
  return result;
}

/// Corresponding points of a labelling, markers first.
std::array<std::vector<Vector3d>, 2> pairs_of(const Labelling& labelling, Points markers,
                                              Points observed) {
  std::array<std::vector<Vector3d>, 2> pairs;
  for (std::size_t i = 0; i < observed.size(); ++i) {
    if (labelling.marker_of_point[i] < 0) continue;
    pairs[0].push_back(markers[labelling.marker_of_point[i]]);
    pairs[1].push_back(observed[i]);
  }
  return pairs;
}

/// Least-squares pose of a labelling; sets its cost.
std::optional<geometry::Pose> refit(Labelling& labelling, Points markers, Points observed,
                                    double sigma_m) {
  const auto pairs = pairs_of(labelling, markers, observed);
  std::vector<int> all(pairs[0].size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  const auto pose = align_points(pairs[0], pairs[1], all);
  if (!pose) return std::nullopt;
  labelling.cost = 0;
  for (std::size_t i = 0; i < all.size(); ++i)
    labelling.cost += (pairs[1][i] - *pose * pairs[0][i]).squaredNorm() / (sigma_m * sigma_m);
  return pose;
}

/// Calls visit(pose) for every assignment of three markers to three observed points whose sides
/// agree within the noise. False if there are too many such assignments.
template <typename Visit>
bool visit_triples(Points markers, Points observed, double sigma_m, Visit&& visit) {
  constexpr std::size_t kMostWork = 20'000'000;
  std::size_t work = 0;
  const double tolerance_m = 6 * sigma_m;
  const auto agree = [&](int p, int q, int i, int j) {
    return std::abs((markers[p] - markers[q]).norm() - (observed[i] - observed[j]).norm()) <
           tolerance_m;
  };
  const int m = static_cast<int>(markers.size()), n = static_cast<int>(observed.size());
  constexpr int kAll[] = {0, 1, 2};
  for (int p = 0; p < m; ++p)
    for (int q = p + 1; q < m; ++q)
      for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
          if (i == j || !agree(p, q, i, j)) continue;
          for (int r = q + 1; r < m; ++r) {
            work += observed.size();
            if (work > kMostWork) return false;
            for (int k = 0; k < n; ++k) {
              if (k == i || k == j || !agree(p, r, i, k) || !agree(q, r, j, k)) continue;
              const std::array<Vector3d, 3> a = {markers[p], markers[q], markers[r]};
              const std::array<Vector3d, 3> b = {observed[i], observed[j], observed[k]};
              work += 8 * markers.size() * observed.size();
              if (const auto pose = align_points(a, b, kAll)) visit(*pose);
            }
          }
        }
  return true;
}

/// The best labelling and the best other one that explains as many points.
struct Ranking {
  Labelling best, rival;
  bool complete = false;  // all labellings were seen
};

constexpr const char* kTooAlike =
    "too many markers look alike within their noise: use fewer, or farther apart";

Ranking rank_labellings(Points markers, Points observed, double sigma_m) {
  Ranking ranking;
  ranking.complete = visit_triples(markers, observed, sigma_m, [&](const geometry::Pose& pose) {
    Labelling found = label(markers, observed, pose, sigma_m);
    if (found.count < std::max(3, ranking.rival.count)) return;
    if (found.marker_of_point == ranking.best.marker_of_point ||
        found.marker_of_point == ranking.rival.marker_of_point)
      return;
    if (!refit(found, markers, observed, sigma_m)) return;
    if (found.cost > chi2_limit(3 * found.count - 6, kFitZ)) return;
    if (found.better_than(ranking.best)) std::swap(found, ranking.best);
    if (found.better_than(ranking.rival)) ranking.rival = std::move(found);
  });
  return ranking;
}

/// Whether both labellings fit the data about equally well.
bool is_ambiguous(const Ranking& r) {
  return r.rival.count > 0 && r.rival.count == r.best.count && r.rival.cost - r.best.cost < 9;
}

std::string input_fault(Points markers, Points observed, double sigma_m) {
  constexpr std::size_t kMost = 64;
  if (markers.size() < 3) return "a constellation needs at least 3 markers";
  if (markers.size() > kMost || observed.size() > kMost)
    return "more than 64 markers or observed points";
  if (!(sigma_m > 0) || !std::isfinite(sigma_m)) return "the stated noise must be positive";
  for (const Points& set : {markers, observed})
    for (const Vector3d& p : set)
      if (!p.allFinite()) return "a point is not finite";
  return {};
}

}  // namespace

Estimate<ConstellationMatch> match_constellation(Points markers_m, Points observed_m,
                                                 const ConstellationOptions& options) {
  using Answer = Estimate<ConstellationMatch>;
  if (auto fault = input_fault(markers_m, observed_m, options.sigma_m); !fault.empty())
    return Answer::degenerate(fault);
  const int least = options.min_markers > 0 ? std::max(3, options.min_markers)
                                            : std::min(4, static_cast<int>(markers_m.size()));
  const Ranking ranking = rank_labellings(markers_m, observed_m, options.sigma_m);
  if (!ranking.complete) return Answer::degenerate(kTooAlike);
  if (ranking.best.count < least)
    return Answer::degenerate("only " + std::to_string(ranking.best.count) + " markers match, " +
                              std::to_string(least) + " are needed");
  if (is_ambiguous(ranking))
    return Answer::degenerate("two labellings fit equally well: the constellation is symmetric");
  const auto pairs = pairs_of(ranking.best, markers_m, observed_m);
  auto fit = rigid_fit(pairs[0], pairs[1], {options.sigma_m, {}});
  if (!fit.usable()) return Answer::degenerate(fit.verdict.reason);
  Answer answer;
  answer.value = {fit.value, ranking.best.marker_of_point};
  answer.covariance = std::move(fit.covariance);
  answer.verdict = std::move(fit.verdict);
  answer.residuals = Eigen::VectorXd::Constant(static_cast<Eigen::Index>(observed_m.size()),
                                               std::numeric_limits<double>::infinity());
  for (std::size_t i = 0; i < observed_m.size(); ++i) {
    const int marker = ranking.best.marker_of_point[i];
    if (marker < 0) continue;
    answer.residuals[static_cast<Eigen::Index>(i)] =
        (observed_m[i] - fit.value * markers_m[marker]).norm();
    answer.inliers.push_back(static_cast<int>(i));
  }
  return answer;
}

Verdict check_constellation(Points markers_m, double sigma_m) {
  if (auto fault = input_fault(markers_m, markers_m, sigma_m); !fault.empty())
    return Verdict::degenerate(fault);
  const auto self = rigid_fit(markers_m, markers_m, {sigma_m, {}});
  if (!self.usable()) return Verdict::degenerate(self.verdict.reason);
  const Ranking ranking = rank_labellings(markers_m, markers_m, sigma_m);
  if (!ranking.complete) return Verdict::degenerate(kTooAlike);
  if (ranking.rival.count < static_cast<int>(markers_m.size())) return self.verdict;
  std::string confused;
  for (std::size_t i = 0; i < markers_m.size(); ++i)
    if (ranking.rival.marker_of_point[i] != static_cast<int>(i))
      confused += " " + std::to_string(i);
  return Verdict::degenerate("the constellation looks the same when turned; markers that swap:" +
                             confused);
}

}  // namespace mixrig::estimation
