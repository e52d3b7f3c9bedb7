// SPDX-License-Identifier: Apache-2.0
// Where on the floor a body stands of which one side was seen.
#include "host/plan/body_place.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace mixrig::plan {
namespace {

constexpr double kTrunkFrom = 0.5, kTrunkTo = 0.82;  ///< of the height: hips to shoulders
constexpr double kHalfAxes_m2 = 0.2 * 0.14;          ///< product of the trunk's half axes
constexpr double kHalfWidth_m = 0.2;                 ///< of an average body
constexpr double kLeastHalf_m = 0.12, kMostHalf_m = 0.28;
constexpr double kTrunk_m2 = 0.04;  ///< seen, for it to tell a place
constexpr double kAlongSigma_m = 0.03, kAcrossSigma_m = 0.03;
// Of what is hidden the error is the same for many frames, which a filter takes for that many
// witnesses: these are three times the errors.
constexpr double kOneSideSigma_m = 0.12;  ///< of a place from one side of the trunk
constexpr double kHiddenAlong_m = 0.3;    ///< per share of the trunk's width that is hidden
constexpr double kUnseenSigma_m = 0.8;    ///< where no trunk is seen
constexpr double kSitsDown = 0.75;        ///< share of the height that is left
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
  /// Where the surface ends, and whether it may go on behind something.
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
    constexpr int kDeep = 2;  // bins behind the side
    float m2 = 0, hidden_m2 = 0;
    for (int i = std::max(0, from - kDeep); i <= std::min(kBins - 1, to + kDeep); ++i)
      m2 += bins[static_cast<std::size_t>(i)].m2,
          hidden_m2 += bins[static_cast<std::size_t>(i)].*part;
    return hidden_m2 > m2 / 6;
  }
};

}  // namespace

BodyPlace place_body(const Cluster& cluster, const Eigen::Vector3d& eye_m, const KnownBody& known) {
  const Eigen::Vector2d along = (cluster.center_m - eye_m).head<2>().normalized();
  const Eigen::Vector2d across(-along.y(), along.x());  // to the left
  const Eigen::Vector2f center = cluster.center_m.head<2>().cast<float>();
  const double height_m = std::max(cluster.top_m, kSitsDown * known.height_m);
  const auto from_m = static_cast<float>(kTrunkFrom * height_m);
  const auto to_m = static_cast<float>(kTrunkTo * height_m);
  Profile trunk, all;
  for (const SurfacePoint& p : cluster.points) {
    const Eigen::Vector2d at = (p.at_m.head<2>() - center).cast<double>();
    all.add(p, across.dot(at), along.dot(at));
    if (p.at_m.z() > from_m && p.at_m.z() < to_m) trunk.add(p, across.dot(at), along.dot(at));
  }
  BodyPlace place;
  place.has_trunk = trunk.area_m2 > kTrunk_m2;
  const Profile& seen = place.has_trunk ? trunk : all;
  const auto right = seen.right(), left = seen.left();
  const double middle_m = 0.5 * (left.u_m + right.u_m);
  place.is_whole = place.has_trunk && !left.may_go_on && !right.may_go_on;
  const double known_half_m = known.half_width_m.value_or(kHalfWidth_m);
  place.half_width_m = std::clamp(place.is_whole ? 0.5 * (left.u_m - right.u_m) : known_half_m,
                                  kLeastHalf_m, kMostHalf_m);
  double across_m = middle_m, sigma_m = kAcrossSigma_m;
  if (!place.has_trunk) {
    sigma_m = kUnseenSigma_m;
  } else if (left.may_go_on && right.may_go_on) {
    sigma_m = std::max(kOneSideSigma_m, 0.5 * (2 * known_half_m - (left.u_m - right.u_m)));
  } else if (!place.is_whole) {
    across_m = left.may_go_on ? right.u_m + known_half_m : left.u_m - known_half_m;
    sigma_m = kOneSideSigma_m;
  }
  const double behind_m = std::numbers::pi / 4 * kHalfAxes_m2 / place.half_width_m;
  place.on_floor_m = cluster.center_m.head<2>() +
                     (seen.along_m3 / seen.area_m2 + behind_m) * along + across_m * across;
  const double hidden =
      place.is_whole ? 0 : std::max(0.0, 1 - (left.u_m - right.u_m) / (2 * known_half_m));
  const double along_sigma_m =
      place.has_trunk ? kAlongSigma_m + kHiddenAlong_m * hidden : kUnseenSigma_m;
  place.covariance = along_sigma_m * along_sigma_m * along * along.transpose() +
                     sigma_m * sigma_m * across * across.transpose();
  return place;
}

}  // namespace mixrig::plan
