// SPDX-License-Identifier: Apache-2.0
// Finds where a body stands on the floor, of which only one side was seen.
#include "extras/people/plan/body_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>

namespace mixrig::plan {
namespace {

constexpr double kTrunkFrom = 0.5, kTrunkTo = 0.82;  ///< of the height: hips to shoulders
/// Product of the trunk's half axes, per height and mean half width: tall bodies are deep.
constexpr double kDepthShare = 0.09;
constexpr double kLeastHalf_m = 0.12, kMostHalf_m = 0.28;
constexpr double kTrunk_m2 = 0.04;  ///< least seen surface of a trunk that gives a position
constexpr double kAlongSigma_m = 0.018, kAcrossSigma_m = 0.012;
// Errors by hidden parts are alike in many frames, which a filter would treat as independent. These
// sigmas are therefore about three times the errors.
constexpr double kOneSideSigma_m = 0.12;  ///< of a place from one side of the trunk
constexpr double kHeadSigma_m = 0.07;     ///< of a place from the head
constexpr double kHiddenAlong_m = 0.25;   ///< per share of the trunk's width that is hidden
constexpr double kUnseenSigma_m = 0.8;    ///< where no trunk is seen
constexpr double kSitsDown = 0.75;        ///< share of the height that is left
constexpr float kHeadHigh_m = 0.2F;       ///< height of a head
constexpr double kHead_m2 = 0.012, kLeastHead_m = 0.1, kMostHead_m = 0.3;  ///< surface, width
constexpr double kLower_m = 0.1;  ///< a top that is so much lower than the body is not the head
constexpr double kOfPixel2 = 1.0 / 6;  ///< variance of a middle or half width, in squared pixels
/// Sides are where the surface beyond is this share.
constexpr double kSideShare = 0.04;

/// Surface over the direction across the view, which counts to the left.
struct Profile {
  static constexpr int kBins = 60;
  static constexpr double kBin_m = 0.02;
  struct Bin {
    float m2 = 0, goes_on_left_m2 = 0, goes_on_right_m2 = 0;
  };
  std::array<Bin, kBins> bins{};
  double area_m2 = 0, along_m3 = 0;

  void add(const SurfacePoint& p, double u_m, double d_m) {
    const int i = std::clamp(static_cast<int>(u_m / kBin_m + kBins / 2.0), 0, kBins - 1);
    Bin& bin = bins[static_cast<std::size_t>(i)];
    bin.m2 += p.area_m2;
    if ((p.may_go_on & SurfacePoint::kLeft) != 0) bin.goes_on_left_m2 += p.area_m2;
    if ((p.may_go_on & SurfacePoint::kRight) != 0) bin.goes_on_right_m2 += p.area_m2;
    area_m2 += p.area_m2, along_m3 += double{p.area_m2} * d_m;
  }
  /// Position up to which a share of the surface lies.
  double quantile_m(double share) const {
    double before_m2 = 0;
    for (int i = 0; i < kBins; ++i) {
      const double m2 = bins[static_cast<std::size_t>(i)].m2;
      if (m2 > 0 && before_m2 + m2 >= share * area_m2)
        return (i + (share * area_m2 - before_m2) / m2 - kBins / 2.0) * kBin_m;
      before_m2 += m2;
    }
    return 0;
  }
  /// Middle of the surface's middle half.
  double middle_m() const { return 0.5 * (quantile_m(0.25) + quantile_m(0.75)); }
  double half_width_m() const { return quantile_m(0.75) - quantile_m(0.25); }
  /// End of the surface on one side, and whether it may go on behind something.
  struct Side {
    double u_m = 0;
    bool may_go_on = false;
  };
  Side right() const {
    double beyond = 0;
    int i = 0;
    while (i + 1 < kBins && (beyond += bins[static_cast<std::size_t>(i)].m2) < kSideShare * area_m2)
      ++i;
    return {(i - kBins / 2.0) * kBin_m, goes_on(0, i, &Bin::goes_on_right_m2)};
  }
  Side left() const {
    double beyond = 0;
    int i = kBins - 1;
    while (i > 0 && (beyond += bins[static_cast<std::size_t>(i)].m2) < kSideShare * area_m2) --i;
    return {(i + 1 - kBins / 2.0) * kBin_m, goes_on(i, kBins - 1, &Bin::goes_on_left_m2)};
  }

 private:
  /// A side is a column of points; where a third of them may go on, it does.
  bool goes_on(int from, int to, float Bin::*part) const {
    constexpr int kBehind = 2;  // bins behind the side
    float m2 = 0, hidden_m2 = 0;
    for (int i = std::max(0, from - kBehind); i <= std::min(kBins - 1, to + kBehind); ++i)
      m2 += bins[static_cast<std::size_t>(i)].m2,
          hidden_m2 += bins[static_cast<std::size_t>(i)].*part;
    return hidden_m2 > m2 / 6;
  }
};

/// Middle of the head across the view, where all of its width is seen.
std::optional<double> middle_of_head_m(const Profile& head) {
  if (head.area_m2 < kHead_m2) return std::nullopt;
  const auto right = head.right(), left = head.left();
  const double width_m = left.u_m - right.u_m;
  if (left.may_go_on || right.may_go_on || width_m < kLeastHead_m || width_m > kMostHead_m)
    return std::nullopt;
  return head.middle_m();
}

/// Seen part of a body of known height, in axes of the view from above.
struct SeenBody {
  double height_m;
  Eigen::Vector2d middle_m, along, across;  ///< across: to the left
  Profile trunk, head, all;

  SeenBody(const Cluster& cluster, const Eigen::Vector3d& eye_m, double height)
      : height_m(height),
        middle_m(cluster.center_m.head<2>()),
        along((cluster.center_m - eye_m).head<2>().normalized()),
        across(-along.y(), along.x()) {
    const auto from_m = static_cast<float>(kTrunkFrom * height_m);
    const auto to_m = static_cast<float>(kTrunkTo * height_m);
    const auto head_from_m = static_cast<float>(cluster.top_m) - kHeadHigh_m;
    for (const SurfacePoint& p : cluster.points) {
      const Eigen::Vector2d at = p.at_m.head<2>().cast<double>() - middle_m;
      const double u_m = across.dot(at), d_m = along.dot(at);
      all.add(p, u_m, d_m);
      if (p.at_m.z() > head_from_m) head.add(p, u_m, d_m);
      if (p.at_m.z() > from_m && p.at_m.z() < to_m) trunk.add(p, u_m, d_m);
    }
  }
  bool has_trunk() const { return trunk.area_m2 > kTrunk_m2; }
  bool is_whole() const {
    return has_trunk() && !trunk.right().may_go_on && !trunk.left().may_go_on;
  }
  double width_m() const { return trunk.left().u_m - trunk.right().u_m; }
};

/// Seen part of a cluster's body. A body of which only the lower part is seen keeps its height.
SeenBody look_at(const Cluster& cluster, const Eigen::Vector3d& eye_m, const KnownBody& known) {
  const double height_m = std::max(cluster.top_m, kSitsDown * known.height_m);
  SeenBody seen(cluster, eye_m, height_m);
  if (seen.is_whole() || height_m >= known.height_m) return seen;
  return {cluster, eye_m, known.height_m};
}

struct Across {
  double at_m = 0, sigma_m = 0;
};

/// Position across the view of the axis of a body whose trunk is seen.
Across axis_across(const SeenBody& seen, double reach_m, bool head_is_top) {
  const auto right = seen.trunk.right(), left = seen.trunk.left();
  if (!right.may_go_on && !left.may_go_on) return {seen.trunk.middle_m(), kAcrossSigma_m};
  if (const auto head_m = middle_of_head_m(seen.head); head_is_top && head_m)
    return {*head_m, kHeadSigma_m};
  if (!right.may_go_on) return {right.u_m + reach_m, kOneSideSigma_m};
  if (!left.may_go_on) return {left.u_m - reach_m, kOneSideSigma_m};
  return {seen.trunk.middle_m(), std::max(kOneSideSigma_m, reach_m - 0.5 * seen.width_m())};
}

BodyWidth width_of(const Profile& trunk) {
  const auto limited = [](double m) { return std::clamp(m, kLeastHalf_m, kMostHalf_m); };
  return {limited(trunk.half_width_m()), limited(0.5 * (trunk.left().u_m - trunk.right().u_m))};
}

}  // namespace

BodyPlace place_body(const Cluster& cluster, const Eigen::Vector3d& eye_m, const KnownBody& known) {
  const SeenBody seen = look_at(cluster, eye_m, known);
  const BodyWidth expected = known.width.value_or(kAverageBody);
  BodyPlace place;
  place.has_trunk = seen.has_trunk();
  place.is_whole = seen.is_whole();
  place.width = place.is_whole ? width_of(seen.trunk) : expected;
  const Profile& part = place.has_trunk ? seen.trunk : seen.all;
  Across across{part.middle_m(), kUnseenSigma_m};
  double along_sigma_m = kUnseenSigma_m;
  if (place.has_trunk) {
    across = axis_across(seen, expected.reach_m, cluster.top_m > known.height_m - kLower_m);
    const double hidden = std::max(0.0, 1 - seen.width_m() / (2 * expected.reach_m));
    along_sigma_m = kAlongSigma_m + (place.is_whole ? 0 : kHiddenAlong_m * hidden);
  }
  const double behind_m =
      std::numbers::pi / 4 * kDepthShare * seen.height_m * expected.half_m / place.width.half_m;
  place.on_floor_m = seen.middle_m + (part.along_m3 / part.area_m2 + behind_m) * seen.along +
                     across.at_m * seen.across;
  place.covariance = along_sigma_m * along_sigma_m * seen.along * seen.along.transpose() +
                     across.sigma_m * across.sigma_m * seen.across * seen.across.transpose();
  // Sides and depth of a body that few pixels show are known to a part of a pixel.
  if (!cluster.points.empty())
    place.covariance += kOfPixel2 * cluster.area_m2 / static_cast<double>(cluster.points.size()) *
                        Eigen::Matrix2d::Identity();
  return place;
}

}  // namespace mixrig::plan
