// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/shape/room_findings.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <fmt/format.h>

#include "hal/base/angles.h"
#include "host/room/scan/panorama/floating_areas.h"
#include "host/room/scan/panorama/sphere_areas.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;

constexpr double kSquareDegrees = 1 / (kDeg * kDeg);  ///< of a steradian
constexpr int kFewSamples = 30;
constexpr double kDisagreeing = 4, kDisagreeing_m = 0.015;  ///< times the median of all, and least
constexpr double kSaturated_pct = 0.1, kEmpty_pct = 30;
constexpr double kLeastArea_sr = 1 * kDeg * kDeg;
constexpr double kLeastBehind_sr = 9 * kDeg * kDeg;

Finding at(FindingKind kind, int view, const Vector3d& direction, double value) {
  return {kind, view, std::atan2(-direction.x(), direction.y()) / kDeg,
          std::asin(std::clamp(direction.normalized().z(), -1.0, 1.0)) / kDeg, value};
}

struct Saturated {
  double pct = 0;
  Eigen::Vector2d middle_px = Eigen::Vector2d::Zero();
};

/// Whether a plate at a shorter exposure shows what saturates at (x, y).
bool shorter_shows(const ScanView& view, int x, int y) {
  if (view.light.empty()) return false;
  const RgbHalf& c = view.light.row(y)[x];
  return float_of_half(std::max({c.r, c.g, c.b})) < view.light_limit;
}

/// The pixels of the view that are white in every exposure that it has.
Saturated saturated_in(const ScanView& view) {
  const Image<Rgb8>& plate = view.plate;
  Saturated found;
  double count = 0;
  for (int y = 0; y < plate.height(); ++y)
    for (int x = 0; x < plate.width(); ++x) {
      const Rgb8& c = plate.row(y)[x];
      if (std::min({c.r, c.g, c.b}) < 254 || shorter_shows(view, x, y)) continue;
      ++count, found.middle_px += Eigen::Vector2d(x, y);
    }
  if (count == 0) return found;
  found.middle_px /= count;
  found.pct = 100 * count / static_cast<double>(plate.size().area());
  return found;
}

/// Direction in which a view's target camera sees a pixel; where its lens has no ray, straight
/// ahead.
Vector3d seen_at(const ScanView& view, const geometry::CameraModel& target,
                 const Eigen::Vector2d& px) {
  const auto ray = target.unproject(px);
  return view.base_from_target.rotation *
         (ray ? Vector3d(ray->homogeneous()) : Vector3d(Vector3d::UnitZ()));
}

double known_pct(const Image<float>& distance_m) {
  std::int64_t count = 0;
  for (int y = 0; y < distance_m.height(); ++y)
    for (int x = 0; x < distance_m.width(); ++x) count += distance_m.row(y)[x] > 0 ? 1 : 0;
  return 100.0 * static_cast<double>(count) / static_cast<double>(distance_m.size().area());
}

void find_in_view(const ScannedRoom& room, std::size_t i, std::vector<Finding>& out) {
  const ScanView& view = room.views[i];
  const ViewAgreement& agreement = room.alignment.views[i];
  const double median_m = room.alignment.median_m;
  const int number = static_cast<int>(i + 1);
  const Vector3d ahead = view.base_from_tof.rotation * Vector3d::UnitZ();
  const auto add = [&](FindingKind kind, double value) {
    out.push_back(at(kind, number, ahead, value));
  };
  if (!agreement.turn_rad.isZero())
    add(FindingKind::kTurnedView, agreement.turn_rad.norm() / kDeg);
  else if (agreement.samples < kFewSamples)
    add(FindingKind::kUncheckedView, agreement.samples);
  else if (agreement.median_m > std::max(kDisagreeing_m, kDisagreeing * median_m))
    add(FindingKind::kDisagreeingView, 1e3 * agreement.median_m);
  if (const Saturated lamp = saturated_in(view); lamp.pct > kSaturated_pct)
    out.push_back(at(FindingKind::kSaturatedView, number,
                     seen_at(view, room.target, lamp.middle_px).normalized(), lamp.pct));
  if (const double pct = known_pct(view.distance_m); pct < kEmpty_pct)
    add(FindingKind::kEmptyView, pct);
}

/// Opposite of where the sweep looks in the mean: nobody expects to see there. Zero where it looks
/// all around.
Vector3d away_from(std::span<const ScanView> views) {
  Vector3d sum = Vector3d::Zero();
  for (const ScanView& view : views) sum += view.base_from_tof.rotation * Vector3d::UnitZ();
  return sum.norm() > 0.1 * static_cast<double>(views.size()) ? Vector3d(-sum.normalized())
                                                              : Vector3d::Zero();
}

/// Whether a sweep of that field has to show a direction; its border is less sure than the plan's
/// step of 1.5 degrees.
bool is_asked(const Size& field_deg, const Vector3d& ray) {
  constexpr double kUnsure_deg = 1.5, kWhole_deg = 180;
  const double pan_deg = std::abs(std::atan2(-ray.x(), ray.y())) / kDeg;
  const double tilt_deg = std::abs(std::asin(std::clamp(ray.z(), -1.0, 1.0))) / kDeg;
  return (field_deg.width >= 2 * kWhole_deg || pan_deg < 0.5 * field_deg.width - kUnsure_deg) &&
         (field_deg.height >= kWhole_deg || tilt_deg < 0.5 * field_deg.height - kUnsure_deg);
}

void find_unseen(const ScannedRoom& room, const Directions& directions, std::vector<Finding>& out) {
  const Panorama& p = room.panorama;
  const Vector3d away = room.field_deg ? Vector3d(Vector3d::Zero()) : away_from(room.views);
  const auto areas = areas_of(p.size(), directions, away, [&](int x, int y) {
    return p.field.row(y)[x] == 0 &&
           (!room.field_deg || is_asked(*room.field_deg, directions(x, y)));
  });
  for (const SphereArea& area : areas)
    if (area.solid_angle_sr > kLeastArea_sr && !area.holds_marked)
      out.push_back(
          at(FindingKind::kUnseen, 0, area.direction, kSquareDegrees * area.solid_angle_sr));
}

void find_without_depth(const Panorama& p, const Directions& directions,
                        std::vector<Finding>& out) {
  const auto unknown = [&](int x, int y) {
    return p.field.row(y)[x] != 0 && p.distance_m.row(y)[x] <= 0;
  };
  std::vector<RoomArea> holes = p.flat_holes;
  for (const SphereArea& area : areas_of(p.size(), directions, Vector3d::Zero(), unknown))
    holes.push_back({area.direction, area.solid_angle_sr});
  for (const RoomArea& hole : holes)
    if (hole.solid_angle_sr > kLeastArea_sr)
      out.push_back(
          at(FindingKind::kWithoutDepth, 0, hole.direction, kSquareDegrees * hole.solid_angle_sr));
}

/// Surfaces behind a plane, most of whose border lies on that plane.
void find_behind(const Panorama& p, const Directions& directions, const RoomPlane& plane,
                 std::vector<Finding>& out) {
  constexpr double kBehind_m = 0.15, kOn_m = 0.04, kMostOn = 0.6;
  const auto off_m = [&](int x, int y) {
    const double there_m = plane.distance_m(directions(x, y));
    return there_m > 0 && p.distance_m.row(y)[x] > 0 ? p.distance_m.row(y)[x] - there_m : -1.0;
  };
  const auto areas = areas_of(p.size(), directions, Vector3d::Zero(),
                              [&](int x, int y) { return off_m(x, y) > kBehind_m; });
  for (const SphereArea& area : areas) {
    if (area.solid_angle_sr < kLeastBehind_sr) continue;
    const auto on = std::count_if(area.border.begin(), area.border.end(), [&](const auto& px) {
      return std::abs(off_m(px[0], px[1])) < kOn_m;
    });
    if (static_cast<double>(on) > kMostOn * static_cast<double>(area.border.size()))
      out.push_back(
          at(FindingKind::kBehindWall, 0, area.direction, kSquareDegrees * area.solid_angle_sr));
  }
}

void find_before(const Panorama& p, std::vector<Finding>& out) {
  const auto add = [&](FindingKind kind, const Vector3d& direction, double solid_angle_sr) {
    out.push_back(at(kind, 0, direction, kSquareDegrees * solid_angle_sr));
  };
  for (const FloatingArea& area : floating_areas(p, p.planes))
    add(FindingKind::kBeforeWall, area.direction, area.solid_angle_sr);
  for (const RoomArea& area : p.wrapped)
    add(FindingKind::kWrapped, area.direction, area.solid_angle_sr);
}

struct Words {
  FindingKind kind;
  std::string_view name, text;  ///< text: with the value
};
constexpr std::array<Words, 10> kWords{{
    {FindingKind::kTurnedView, "turned_view",
     "its angles disagree with its neighbours by {:.2f} deg: turned to agree, unless --no-align"},
    {FindingKind::kDisagreeingView, "disagreeing_view",
     "its surfaces are {:.0f} mm from its neighbours', and no turn mends that: scan it again"},
    {FindingKind::kUncheckedView, "unchecked_view",
     "it overlaps with other views in {:.0f} places only: its angles were not checked"},
    {FindingKind::kSaturatedView, "saturated_view",
     "{:.2f} % of its colour is saturated: a lamp or a window; expose less"},
    {FindingKind::kEmptyView, "empty_view", "only {:.0f} % of its pixels have a depth"},
    {FindingKind::kUnseen, "unseen", "{:.0f} square degrees that no view shows: unknown"},
    {FindingKind::kWithoutDepth, "without_depth",
     "{:.0f} square degrees without depth (glass, black or too far): unknown, or the wall around "
     "it"},
    {FindingKind::kBehindWall, "behind_wall",
     "{:.0f} square degrees lie behind the wall around them: a mirror, a window or an opening"},
    {FindingKind::kBeforeWall, "before_wall",
     "{:.0f} square degrees float before the wall around them: a thing that hangs, or stands on "
     "what is too thin to be measured"},
    {FindingKind::kWrapped, "wrapped",
     "{:.0f} square degrees float before the wall around them and are noisier than it: a "
     "mirror that shows what is beyond the range of the depth camera; unknown"},
}};

const Words& words_of(FindingKind kind) { return kWords[static_cast<std::size_t>(kind)]; }

}  // namespace

std::string_view name(FindingKind kind) { return words_of(kind).name; }

std::string text_of(const Finding& f) {
  const std::string where = f.view > 0 ? fmt::format("view {}", f.view) : std::string("room");
  return fmt::format("{} at azimuth {:.0f}, elevation {:.0f} deg: {}", where, f.azimuth_deg,
                     f.elevation_deg, fmt::format(fmt::runtime(words_of(f.kind).text), f.value));
}

std::vector<Finding> find_faults(const ScannedRoom& room) {
  std::vector<Finding> found, of_room;
  for (std::size_t i = 0; i < room.views.size(); ++i) find_in_view(room, i, found);
  const Panorama& panorama = room.panorama;
  const Directions directions(panorama.size());
  find_unseen(room, directions, of_room);
  find_without_depth(panorama, directions, of_room);
  for (const RoomPlane& plane : panorama.planes) find_behind(panorama, directions, plane, of_room);
  find_before(panorama, of_room);
  std::sort(of_room.begin(), of_room.end(),
            [](const Finding& a, const Finding& b) { return a.value > b.value; });
  found.insert(found.end(), of_room.begin(), of_room.end());
  return found;
}

}  // namespace mixrig::model
