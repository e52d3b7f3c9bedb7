// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/lamp_tracks.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <Eigen/Cholesky>
#include <Eigen/Geometry>

#include "hal/base/angles.h"
#include "hal/base/order_statistics.h"
#include "host/math/estimation/points/triangulation.h"
#include "host/room/lamps/lamp_plane.h"
#include "host/room/lamps/track_regions.h"

namespace mixrig::lights {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Views = std::span<const LampView>;

constexpr double kWallMargin_m = 0.12;    ///< a lamp's housing in the wall
constexpr double kOnSurface_m = 0.2;      ///< of the room, beside three sigmas
constexpr double kFacesUp = 0.5;          ///< z of a normal
constexpr double kLeastSigma_rad = 3e-4;  ///< of a direction: what lens and pose leave
constexpr double kContradiction = 4;      ///< factor on sigmas with which views must agree

const BrightRegion& region_of(Views views, const Sighting& s) {
  return views[static_cast<std::size_t>(s.view)].regions[static_cast<std::size_t>(s.region)];
}
const geometry::Pose& pose_of(Views views, const Sighting& s) {
  return views[static_cast<std::size_t>(s.view)].world_from_camera;
}

/// The bearing of a direction in world axes with the uncertainty of a region's centre.
estimation::PointView view_of(const BrightRegion& region, const geometry::Pose& pose,
                              const Vector3d& world_ray, double factor) {
  const Vector3d ray = (pose.rotation.conjugate() * world_ray).normalized();
  const Vector3d u = ray.unitOrthogonal(), v = ray.cross(u);
  Eigen::Matrix<double, 2, 3> tangents;
  tangents << u.transpose(), v.transpose();
  Eigen::Matrix2d covariance = tangents * region.covariance * tangents.transpose();
  covariance += kLeastSigma_rad * kLeastSigma_rad * Eigen::Matrix2d::Identity();
  covariance *= factor * factor;
  estimation::Bearing bearing;
  bearing.direction = ray;
  bearing.whitener = covariance.llt().matrixL().solve(tangents);
  return {pose, bearing};
}

/// State of a candidate while it is judged.
struct Candidate {
  std::vector<Sighting> seen, whole;  ///< whole: not cut by a border
  std::optional<Vector3d> normal;     ///< of the plane that it is drawn onto
};

estimation::Estimate<Vector3d> fix(Views views, const Candidate& c,
                                   const std::optional<Vector3d>& about_m, double factor) {
  std::vector<estimation::PointView> points;
  for (const Sighting& s : c.whole) {
    const BrightRegion& region = region_of(views, s);
    const geometry::Pose& pose = pose_of(views, s);
    Vector3d ray = pose.rotation * region.direction;
    if (about_m && c.normal)
      if (const auto spot = spot_on_plane(region, pose, *about_m, *c.normal))
        ray = spot->centre_m - pose.translation_m;
    points.push_back(view_of(region, pose, ray, factor));
  }
  return estimation::triangulate(points);
}

/// Place of a candidate, with larger sigmas where views disagree by more than their sigmas say.
estimation::Estimate<Vector3d> robust_fix(Views views, const Candidate& c,
                                          const std::optional<Vector3d>& about_m) {
  auto found = fix(views, c, about_m, 1);
  return found.usable() ? found : fix(views, c, about_m, kContradiction);
}

double median_of(Views views, const std::vector<Sighting>& seen, double BrightRegion::*value) {
  std::vector<double> all;
  for (const Sighting& s : seen) all.push_back(region_of(views, s).*value);
  return upper_median(std::move(all));
}

double lowest_eye_m(Views views) {
  double low = 1e9;
  for (const LampView& v : views) low = std::min(low, v.world_from_camera.translation_m.z());
  return low;
}
double highest_eye_m(Views views) {
  double high = -1e9;
  for (const LampView& v : views) high = std::max(high, v.world_from_camera.translation_m.z());
  return high;
}

double longest_baseline_m(Views views, const std::vector<Sighting>& seen) {
  double longest = 0;
  for (const Sighting& s : seen)
    longest = std::max(
        longest,
        (pose_of(views, s).translation_m - pose_of(views, seen.front()).translation_m).norm());
  return longest;
}

/// The surface of the room that a place lies on, if it does.
std::optional<SurfacePoint> surface_at(const RoomSurfaces* room, const Vector3d& position_m,
                                       double sigma_m) {
  if (room == nullptr) return {};
  const auto surface = room->towards(position_m);
  if (!surface) return {};
  const double off_m = surface->normal.dot(position_m - surface->position_m);
  if (std::abs(off_m) > kOnSurface_m + 3 * sigma_m) return {};
  return surface;
}

class Judge {
 public:
  Judge(Views views, const RoomSurfaces* room, const LampOptions& options)
      : views_(views), room_(room), options_(options) {}

  void judge(const std::vector<Sighting>& track, LampSearch& out) const {
    FoundLamp lamp;
    lamp.seen = track;
    lamp.surround = median_of(views_, track, &BrightRegion::surround);
    lamp.solid_angle_sr = median_of(views_, track, &BrightRegion::solid_angle_sr);
    const auto refusal = refuse(lamp);
    if (!refusal) {
      out.lamps.push_back(std::move(lamp));
      return;
    }
    const Sighting& s = track[track.size() / 2];
    RejectedLamp rejected{*refusal,
                          {},
                          pose_of(views_, s).translation_m,
                          pose_of(views_, s).rotation * region_of(views_, s).direction,
                          lamp.surround,
                          track};
    if (!lamp.covariance.isZero()) rejected.position_m = lamp.position_m;
    out.rejected.push_back(std::move(rejected));
  }

 private:
  std::optional<Refusal> refuse(FoundLamp& lamp) const {
    lamp.covariance.setZero();
    const auto needed = static_cast<std::size_t>(
        std::ceil(options_.least_share * static_cast<double>(views_.size())));
    if (lamp.seen.size() < std::max<std::size_t>(needed, views_.size() > 2 ? 3 : 1))
      return Refusal::kFewViews;
    if (lamp.solid_angle_sr < options_.least_solid_sr) return Refusal::kSmall;
    if (const auto refusal = place(lamp)) return refusal;
    if (const auto refusal = refuse_place(lamp)) return refusal;
    if (lamp.surround > options_.most_surround) return Refusal::kSoftBorder;
    return {};
  }

  std::optional<Refusal> place(FoundLamp& lamp) const {
    Candidate c{lamp.seen, {}, {}};
    for (const Sighting& s : lamp.seen)
      if (!region_of(views_, s).cut) c.whole.push_back(s);
    std::optional<Refusal> refusal = Refusal::kCut;
    if (c.whole.size() >= 2) refusal = triangulate(c, lamp);
    if (!refusal) return {};
    if (*refusal == Refusal::kMoves || room_ == nullptr) return refusal;
    return place_on_surface(c, lamp) ? std::nullopt : refusal;
  }

  std::optional<Refusal> triangulate(Candidate& c, FoundLamp& lamp) const {
    auto found = robust_fix(views_, c, {});
    if (!found.usable())
      return found.verdict.reason.find("contradict") != std::string::npos ? Refusal::kMoves
                                                                          : Refusal::kShortPath;
    for (int round = 0; round < 3; ++round) {
      const double sigma_m = std::sqrt(found.covariance.trace());
      if (const auto surface = surface_at(room_, found.value, sigma_m))
        c.normal = surface->normal;
      else if (found.value.z() > highest_eye_m(views_))
        c.normal = -Vector3d::UnitZ();
      if (!c.normal) break;
      auto better = robust_fix(views_, c, found.value);
      if (!better.usable()) break;
      found = std::move(better);
    }
    const double distance_m = (found.value - pose_of(views_, c.whole.front()).translation_m).norm();
    const double common_m = options_.common_rad * distance_m;
    lamp.position_m = found.value;
    lamp.covariance = found.covariance + common_m * common_m * Matrix3d::Identity();
    lamp.residual = std::sqrt(found.residuals.squaredNorm() /
                              (2.0 * static_cast<double>(found.residuals.size())));
    measure(c, lamp);
    if (std::sqrt(lamp.covariance.trace()) > options_.most_sigma_share * distance_m)
      return Refusal::kShortPath;
    return {};
  }

  /// Places the lamp where the views' rays meet the room.
  bool place_on_surface(Candidate& c, FoundLamp& lamp) const {
    Vector3d sum = Vector3d::Zero();
    std::vector<SurfacePoint> met;
    for (const Sighting& s : c.whole.empty() ? c.seen : c.whole) {
      const geometry::Pose& pose = pose_of(views_, s);
      const auto surface =
          room_->meet(pose.translation_m, pose.rotation * region_of(views_, s).direction);
      if (!surface) continue;
      met.push_back(*surface), sum += surface->position_m;
    }
    if (met.empty()) return false;
    const Vector3d mean_m = sum / static_cast<double>(met.size());
    lamp.position_m = mean_m;
    c.normal = met[met.size() / 2].normal;
    // The middle of the area, as where it is triangulated.
    Vector3d middle = Vector3d::Zero();
    int spots = 0;
    for (const Sighting& s : c.whole)
      if (const auto spot =
              spot_on_plane(region_of(views_, s), pose_of(views_, s), lamp.position_m, *c.normal))
        middle += spot->centre_m, ++spots;
    if (spots > 0) lamp.position_m = middle / spots;
    Matrix3d scatter = std::pow(met.front().sigma_m + 5e-3, 2) * Matrix3d::Identity();
    for (const SurfacePoint& p : met) {
      const Vector3d off = p.position_m - mean_m;
      scatter += off * off.transpose() / static_cast<double>(met.size());
    }
    lamp.covariance = scatter, lamp.by_surface = true;
    measure(c, lamp);
    return true;
  }

  /// Direction and size: medians over the views that show the whole lamp.
  void measure(const Candidate& c, FoundLamp& lamp) const {
    std::vector<double> u_m, v_m, radius_m;
    for (const Sighting& s : c.whole) {
      const BrightRegion& region = region_of(views_, s);
      const geometry::Pose& pose = pose_of(views_, s);
      radius_m.push_back(std::sqrt(region.solid_angle_sr / kPi) *
                         (lamp.position_m - pose.translation_m).norm());
      if (!c.normal) continue;
      const auto spot = spot_on_plane(region, pose, lamp.position_m, *c.normal);
      if (spot) u_m.push_back(spot->size_m.x()), v_m.push_back(spot->size_m.y());
    }
    if (!u_m.empty()) {
      lamp.direction = *c.normal;
      lamp.size_m = {upper_median(u_m), upper_median(v_m)};
    } else if (!radius_m.empty()) {
      lamp.size_m.setConstant(std::sqrt(kPi) *
                              upper_median(radius_m));  // a square of the disk's area
    }
  }

  std::optional<Refusal> refuse_place(const FoundLamp& lamp) const {
    const double sigma_m = std::sqrt(lamp.covariance.trace());
    if (room_ != nullptr) {
      if (room_->behind_plane(lamp.position_m, kWallMargin_m + 3 * sigma_m))
        return Refusal::kBehind;
      const auto surface = surface_at(room_, lamp.position_m, sigma_m);
      if (surface && surface->normal.z() > kFacesUp) return Refusal::kFacesUp;
    }
    if (!options_.low_lamps && lamp.position_m.z() < lowest_eye_m(views_)) return Refusal::kLow;
    return {};
  }

  Views views_;
  const RoomSurfaces* room_;
  LampOptions options_;
};

/// Tracks whose places agree are one lamp that was not seen for a while.
void join_same(Views views, std::vector<std::vector<Sighting>>& tracks) {
  constexpr double kSame_m = 0.15;
  struct Placed {
    std::size_t track;
    Vector3d at_m;
  };
  std::vector<Placed> placed;
  for (std::size_t i = 0; i < tracks.size(); ++i) {
    Candidate c{tracks[i], {}, {}};
    for (const Sighting& s : tracks[i])
      if (!region_of(views, s).cut) c.whole.push_back(s);
    if (c.whole.size() < 3 || longest_baseline_m(views, c.whole) < 0.02) continue;
    const auto found = robust_fix(views, c, {});
    if (!found.usable()) continue;
    const auto same = std::find_if(placed.begin(), placed.end(), [&](const Placed& p) {
      return (p.at_m - found.value).norm() < kSame_m + 2 * std::sqrt(found.covariance.trace());
    });
    if (same == placed.end()) {
      placed.push_back({i, found.value});
      continue;
    }
    auto& into = tracks[same->track];
    into.insert(into.end(), tracks[i].begin(), tracks[i].end());
    tracks[i].clear();
  }
  std::erase_if(tracks, [](const auto& t) { return t.empty(); });
}

std::vector<LampView> chosen(Views views, std::vector<int>& numbers) {
  std::vector<LampView> some;
  const auto count = static_cast<int>(views.size());
  const int wanted = std::min(count, kMostViews);
  for (int k = 0; k < wanted; ++k) {
    const int i =
        wanted == 1 ? 0 : static_cast<int>(std::lround(double(k) * (count - 1) / (wanted - 1)));
    numbers.push_back(i), some.push_back(views[static_cast<std::size_t>(i)]);
  }
  return some;
}

struct Words {
  Refusal refusal;
  std::string_view name, text;
};
constexpr std::array<Words, 10> kWords{{
    {Refusal::kFewViews, "few_views", "seen in too few pictures"},
    {Refusal::kSmall, "small", "too small to light the room"},
    {Refusal::kSoftBorder, "soft_border", "its light fades at its border: a lit white surface"},
    {Refusal::kMoves, "moves",
     "its place differs from view to view: a highlight on a curved surface, or a lamp that "
     "something in front of it cuts"},
    {Refusal::kShortPath, "short_path",
     "its distance is not determined: the camera's path is too short; move 0.3 m or more, or give "
     "the scanned room"},
    {Refusal::kCut, "cut", "the border of the picture cuts it in all views"},
    {Refusal::kBehind, "behind_wall",
     "it lies behind a wall or below the floor: an image in a mirror, or outside"},
    {Refusal::kFacesUp, "faces_up",
     "it lies on a surface that faces up: a reflection or a white object"},
    {Refusal::kLow, "low",
     "it lies below every camera: a reflection or a white object; --low-lamps allows it"},
    {Refusal::kDark, "dark", "its light does not show in the room's shading"},
}};

const Words& words_of(Refusal refusal) {
  return *std::find_if(kWords.begin(), kWords.end(),
                       [&](const Words& w) { return w.refusal == refusal; });
}

}  // namespace

std::string_view name(Refusal refusal) { return words_of(refusal).name; }
std::string_view text_of(Refusal refusal) { return words_of(refusal).text; }

LampSearch find_lamps(std::span<const LampView> all, const RoomSurfaces* room,
                      const LampOptions& options) {
  LampSearch search;
  if (all.empty()) return search;
  std::vector<int> numbers;
  const std::vector<LampView> views = chosen(all, numbers);
  auto tracks = track_regions(views);
  join_same(views, tracks);
  const Judge judge(views, room, options);
  for (const auto& track : tracks) judge.judge(track, search);
  const auto renumber = [&](std::vector<Sighting>& seen) {
    for (Sighting& s : seen) s.view = numbers[static_cast<std::size_t>(s.view)];
  };
  for (FoundLamp& lamp : search.lamps) renumber(lamp.seen);
  for (RejectedLamp& rejected : search.rejected) renumber(rejected.seen);
  std::stable_sort(search.lamps.begin(), search.lamps.end(), [](const auto& a, const auto& b) {
    return a.solid_angle_sr > b.solid_angle_sr;
  });
  std::stable_sort(search.rejected.begin(), search.rejected.end(),
                   [](const auto& a, const auto& b) { return a.seen.size() > b.seen.size(); });
  return search;
}

}  // namespace mixrig::lights
