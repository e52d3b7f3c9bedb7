// SPDX-License-Identifier: Apache-2.0
#include "host/room/click/clicked_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "hal/base/order_statistics.h"
#include "host/math/estimation/consensus.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/geometry/linear.h"
#include "host/room/click/click_region.h"
#include "host/room/click/click_step.h"

namespace mixrig::model {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kLeastClickPoints = 12;     ///< around the click
constexpr double kLeastKnownClick = 0.6;  ///< of the pixels around it
constexpr double kNearClick = 2.5;        ///< pixels of the depth camera that must lie on the plane
constexpr double kMostNearOff = 0.1;      ///< share of them that may not
constexpr std::array kNoisier{1.0, 1.5, 2.2, 3.3};  ///< noise in stated sigmas, as it is tried
constexpr double kMostNoisier = 3.3, kLeastNoisier = 0.25;
constexpr double kSurelyLess = 0.6;  ///< measured noise below this share of the stated is believed
constexpr double kCurvedSigmas = 5, kCurved_m = 4e-3;  ///< over the rectangle
/// Share of the depth's noise that a bend may have: errors of structured light are waves.
constexpr double kCurvedNoise = 0.8;
constexpr double kLeastArea_m2 = 0.01;
constexpr double kLeastClickSine = 0.087;  ///< 5 degrees
constexpr int kClickRounds = 3;

/// Surroundings of the click, and how much of them is unknown.
struct ClickSurroundings {
  std::vector<ClickPlace> known;
  int unknown = 0;
  double pixel_px = 1;  ///< pixels of the view that one of the depth camera covers
};

double clicked_depth_m(const ClickGrid& grid, const geometry::Pinhole& view, const Click& click,
                       const Vector2d& half_px) {
  std::vector<double> depths;
  for (int y = 0; y < grid.size().height; ++y)
    for (int x = 0; x < grid.size().width; ++x) {
      const ClickSample& s = grid.at(x, y);
      if (!s.known() || !(s.point_m.z() > 0)) continue;
      const Vector2d off = (view.project(s.point_m) - click.px).cwiseAbs();
      if (off.x() <= half_px.x() && off.y() <= half_px.y()) depths.push_back(s.point_m.z());
    }
  return upper_median(std::move(depths));
}

ClickSurroundings look_around_click(const ClickGrid& grid, const geometry::Pinhole& view,
                                    const Click& click, const Vector2d& half_px, double depth_m) {
  ClickSurroundings around;
  for (int y = 0; y < grid.size().height; ++y)
    for (int x = 0; x < grid.size().width; ++x) {
      const ClickSample& s = grid.at(x, y);
      if (s.ray.isZero()) continue;
      const Vector3d p = s.known() ? s.point_m : grid.view_from_tof() * (depth_m * s.ray);
      if (!(p.z() > 0)) continue;
      const Vector2d off = (view.project(p) - click.px).cwiseAbs();
      if (off.x() > half_px.x() || off.y() > half_px.y()) continue;
      if (s.known())
        around.known.push_back({x, y});
      else
        ++around.unknown;
    }
  const double all = static_cast<double>(around.known.size()) + around.unknown;
  around.pixel_px = std::sqrt(4 * half_px.x() * half_px.y() / std::max(all, 1.0));
  return around;
}

/// Whether the depths bend away from the plane: a quadratic over the rectangle that is certain and
/// larger than kCurved_m and than its share of `noise_m`.
bool is_curved(const ClickGrid& grid, const ClickRegion& region, const InversePlane& plane,
               const std::vector<ClickPlace>& on, double noise_m) {
  Vector2d low(1e9, 1e9), high(-1e9, -1e9);
  for (const ClickPlace& at : on) {
    low = low.cwiseMin(Vector2d(at.x, at.y)), high = high.cwiseMax(Vector2d(at.x, at.y));
  }
  const Vector2d middle = 0.5 * (low + high), half = (0.5 * (high - low)).cwiseMax(1.0);
  using Vector6d = Eigen::Matrix<double, 6, 1>;
  Eigen::Matrix<double, 6, 6> a = Eigen::Matrix<double, 6, 6>::Zero();
  Vector6d b = Vector6d::Zero();
  double sigma_m = 0;
  for (const ClickPlace& at : on) {
    const Vector2d p = (Vector2d(at.x, at.y) - middle).cwiseQuotient(half);
    Vector6d row;
    row << 1, p.x(), p.y(), p.x() * p.x(), p.y() * p.y(), p.x() * p.y();
    const double here_m = grid.at(at.x, at.y).sigma_m;
    a += row * row.transpose(), b += region.sigmas(plane, at) * here_m * row;
    sigma_m += here_m / static_cast<double>(on.size());
  }
  const geometry::SymmetricSolver<6> solver(a);
  const Vector6d bend_m = solver.solve(b);
  const Eigen::Matrix<double, 6, 6> inverse = solver.inverse();
  for (int i = 3; i < 6; ++i)
    if (std::abs(bend_m[i]) > std::max({kCurved_m, kCurvedNoise * noise_m,
                                        kCurvedSigmas * sigma_m * std::sqrt(inverse(i, i))}))
      return true;
  return false;
}

/// Places that no depth step separates from the click, even one within the noise of one depth.
std::vector<ClickPlace> keep_side(const ClickRegion& region, const ClickGrid& grid,
                                  const geometry::Pinhole& view, const Click& click,
                                  const InversePlane& plane, std::vector<ClickPlace> places) {
  const auto px = [&](ClickPlace at) { return view.project(grid.at(at).point_m); };
  std::vector<PlaceOff> offs;
  for (const ClickPlace& at : places) offs.push_back({px(at), region.sigmas(plane, at)});
  for (const StepLine& step : find_steps(offs, click.px))
    std::erase_if(places, [&](ClickPlace at) { return step.is_beyond(px(at)); });
  return places;
}

/// The plane through the middle of these places: neighbouring surfaces a sigma or two off, such as
/// a picture on a wall, may be part of the region.
void move_to(const ClickRegion& region, const ClickGrid& grid, const std::vector<ClickPlace>& on,
             InversePlane& plane) {
  double off = 0, weights = 0;
  for (const ClickPlace& at : on) {
    const ClickSample& s = grid.at(at.x, at.y);
    const double z_m = 1 / plane.a.dot(s.ray), off_m = region.sigmas(plane, at) * s.sigma_m;
    const double weight = 1 / (s.sigma_m * s.sigma_m);
    off += weight * off_m / z_m, weights += weight;  // relative: planes a . p = 1 + off
  }
  plane.a /= 1 + off / weights;
}

geometry::Plane plane_in_view(const InversePlane& plane, const geometry::Pose& view_from_tof) {
  geometry::Plane out;
  const double norm = plane.a.norm();
  out.normal = view_from_tof.rotation * Vector3d(-plane.a / norm);  // towards the camera
  const Vector3d foot = view_from_tof * Vector3d(plane.a / (norm * norm));
  out.offset_m = -out.normal.dot(foot);
  return out;
}

double area_on_plane(const ClickGrid& grid, const std::vector<ClickPlace>& places,
                     const geometry::Plane& plane) {
  double area = 0;
  for (const ClickPlace& at : places) {
    if (at.x + 1 >= grid.size().width || at.y + 1 >= grid.size().height) continue;
    const Vector3d &here = grid.at(at.x, at.y).ray, &right = grid.at(at.x + 1, at.y).ray,
                   &down = grid.at(at.x, at.y + 1).ray;
    if (right.isZero() || down.isZero()) continue;
    const double z_m = grid.at(at.x, at.y).point_m.z();
    const Vector3d p = grid.at(at.x, at.y).point_m;
    const double sine = std::abs(plane.normal.dot(p.normalized()));
    area += std::abs((right - here).x() * (down - here).y()) * z_m * z_m / std::max(sine, 0.02) *
            p.normalized().z();
  }
  return area;
}

/// Sigmas of the normal and of the plane's place at a point, from the covariance of a.
void judge_sigmas(const InversePlane& plane, const geometry::Pose& view_from_tof, double sigma_m,
                  ClickedPlane& out) {
  const double norm = plane.a.norm();
  const Vector3d n = plane.a / norm;
  const Matrix3d across = (Matrix3d::Identity() - n * n.transpose()) / norm;
  const Matrix3d turn = across * plane.covariance * across.transpose();
  const estimation::Spectrum spread = estimation::spectrum_of(turn);
  out.normal_sigma_rad = std::sqrt(std::max(0.0, spread.values[2]));
  const Vector3d p = geometry::inverse(view_from_tof) * out.point_m;
  const double statistical_m = std::sqrt(std::max(0.0, p.dot(plane.covariance * p))) / norm;
  out.offset_sigma_m = std::hypot(statistical_m, kCommonShare * sigma_m);
}

double median_sigma_m(const ClickGrid& grid, const std::vector<ClickPlace>& places) {
  std::vector<double> sigmas_m;
  for (const ClickPlace& at : places) sigmas_m.push_back(grid.at(at).sigma_m);
  return upper_median(std::move(sigmas_m));
}

/// The plane that most of the places around the click agree with, by their inverse depths: where a
/// pixel looks is exact, so that a small area carries a plane whose depths are noisy.
std::variant<InversePlane, ClickRefusal> first_plane(const ClickRegion& region,
                                                     const std::vector<ClickPlace>& around) {
  const auto fit = [&](std::span<const int> indices) {
    std::vector<ClickPlace> places;
    for (const int i : indices) places.push_back(around[static_cast<std::size_t>(i)]);
    return region.fit(places);
  };
  const auto sample = [&](std::span<const int> indices) {
    const auto plane = fit(indices);
    return plane ? std::vector<InversePlane>{*plane} : std::vector<InversePlane>{};
  };
  // Dark surfaces and those seen at an angle are noisier than the stated sigma.
  estimation::ConsensusFit<InversePlane> found;
  for (const double factor : kNoisier) {
    const auto cost = [&](const InversePlane& plane, int i) {
      return std::pow(region.sigmas(plane, around[static_cast<std::size_t>(i)]) / factor, 2);
    };
    found = estimation::fit_with_consensus<InversePlane>({static_cast<int>(around.size()), 3, 1, 3},
                                                         true, fit, sample, cost);
    if (found.model) return *found.model;
  }
  return found.reason.find("contradict") != std::string::npos ? ClickRefusal::kEdge
                                                              : ClickRefusal::kNotFlat;
}

bool is_grazing(const InversePlane& plane, const geometry::Pose& tof_from_view,
                const ClickSample& sample) {
  return std::abs(plane.a.normalized().dot((tof_from_view * sample.point_m).normalized())) <
         kLeastClickSine;
}

/// Grows the region from the places `on` the plane and fits the plane to it, in turn; at last moves
/// the plane to what lies around the click. False where nothing determines it.
bool settle(const ClickGrid& grid, const geometry::Pinhole& view, const Click& click,
            const std::vector<ClickPlace>& on, ClickRegion& region, InversePlane& plane) {
  for (int round = 0; round < kClickRounds; ++round) {
    region.grow(plane, on);
    const auto better = region.fit(region.places());
    if (!better) return false;
    plane = *better;
  }
  for (int round = 0; round < kClickRounds; ++round) {
    region.grow(plane, on);
    region.keep_flat(plane, on);
    if (static_cast<int>(region.places().size()) < kLeastClickPoints) return false;
    const auto inner = keep_side(region, grid, view, click, plane, region.inner_places());
    const auto better =
        region.fit(static_cast<int>(inner.size()) < kLeastClickPoints ? region.places() : inner);
    if (!better) return false;
    plane = *better;
  }
  move_to(region, grid, keep_side(region, grid, view, click, plane, on), plane);
  return true;
}

std::variant<ClickedPlane, ClickRefusal> describe(const ClickGrid& grid,
                                                  const geometry::Pinhole& view, const Click& click,
                                                  const InversePlane& plane, double sigma_m,
                                                  ClickRegion region) {
  ClickedPlane out;
  out.plane = plane_in_view(plane, grid.view_from_tof());
  const Vector2d xy = view.unproject(click.px);
  const Vector3d ray(xy.x(), xy.y(), 1);
  const double along = -out.plane.offset_m / out.plane.normal.dot(ray);
  if (!(along > 0)) return ClickRefusal::kGrazing;
  out.point_m = along * ray;
  if (std::abs(out.plane.normal.dot(ray.normalized())) < kLeastClickSine)
    return ClickRefusal::kGrazing;
  out.points = static_cast<int>(region.places().size());
  out.area_m2 = area_on_plane(grid, region.places(), out.plane);
  if (out.area_m2 < kLeastArea_m2) return ClickRefusal::kSmall;
  double sum = 0;
  for (const ClickPlace& at : region.places()) sum += std::pow(region.sigmas(plane, at), 2);
  out.residual = std::sqrt(sum / out.points);
  judge_sigmas(plane, grid.view_from_tof(), sigma_m, out);
  out.region = std::move(region).part();
  return out;
}

}  // namespace

std::string_view text_of(ClickRefusal refusal) {
  switch (refusal) {
    case ClickRefusal::kOutside:
      return "the depth camera does not look there: click farther inside the picture";
    case ClickRefusal::kUnknown:
      return "the depth is unknown there (glass, black, or too far): click beside it";
    case ClickRefusal::kEdge:
      return "several surfaces meet there: click farther from the edge";
    case ClickRefusal::kNotFlat:
      return "it is not flat there (an edge, a person, hair): click on a table, the floor or "
             "a wall";
    case ClickRefusal::kGrazing:
      return "the camera sees the surface from its edge, which leaves its direction open: click on "
             "another surface, or move the camera";
    case ClickRefusal::kSmall:
      return "the flat part is smaller than 10 x 10 cm: click on a larger surface";
  }
  return {};
}

std::variant<ClickedPlane, ClickRefusal> plane_under(const ClickPicture& picture,
                                                     const Click& click) {
  const geometry::Pinhole& view = picture.view;
  if (!click.px.allFinite() || click.px.minCoeff() < -0.5 ||
      click.px.x() > view.size_px.width - 0.5 || click.px.y() > view.size_px.height - 0.5)
    return ClickRefusal::kOutside;
  ClickGrid grid(picture);
  const double sixteenth_px = view.size_px.width / 16.0;
  const Vector2d half_px = 0.5 * click.rect_px.value_or(Vector2d(sixteenth_px, sixteenth_px));
  const double depth_m = clicked_depth_m(grid, view, click, half_px);
  const ClickSurroundings around =
      look_around_click(grid, view, click, half_px, depth_m > 0 ? depth_m : 3.0);
  const auto known = static_cast<double>(around.known.size());
  if (known + around.unknown < kLeastClickPoints) return ClickRefusal::kOutside;
  if (known < kLeastClickPoints || known < kLeastKnownClick * (known + around.unknown))
    return ClickRefusal::kUnknown;

  ClickRegion region(grid);
  const auto first = first_plane(region, around.known);
  if (const auto* refusal = std::get_if<ClickRefusal>(&first)) return *refusal;
  auto plane = std::get<InversePlane>(first);
  if (is_grazing(plane, geometry::inverse(grid.view_from_tof()), grid.at(around.known[0])))
    return ClickRefusal::kGrazing;
  const double stated_m = median_sigma_m(grid, around.known);
  std::vector<double> sizes;
  for (const ClickPlace& at : around.known) sizes.push_back(std::abs(region.sigmas(plane, at)));
  const double measured = 1.4826 * upper_median(sizes);
  const double noisier =
      std::clamp(measured, measured < kSurelyLess ? kLeastNoisier : 1.0, kMostNoisier);
  grid.scale_sigmas(noisier);
  std::vector<ClickPlace> on;
  int near = 0, near_off = 0;
  for (const ClickPlace& at : around.known) {
    const bool fits = region.fits(plane, at);
    if (fits) on.push_back(at);
    const Vector2d px = view.project(grid.at(at.x, at.y).point_m);
    if ((px - click.px).norm() > kNearClick * around.pixel_px) continue;
    ++near, near_off += fits ? 0 : 1;
  }
  if (near == 0) return ClickRefusal::kUnknown;
  if (near_off > kMostNearOff * near) return ClickRefusal::kEdge;
  if (static_cast<int>(on.size()) < kLeastClickPoints ||
      is_curved(grid, region, plane, on, std::min(noisier, 1.0) * stated_m))
    return ClickRefusal::kNotFlat;

  if (!settle(grid, view, click, on, region, plane)) return ClickRefusal::kNotFlat;
  return describe(grid, view, click, plane, median_sigma_m(grid, around.known), std::move(region));
}

}  // namespace mixrig::model
