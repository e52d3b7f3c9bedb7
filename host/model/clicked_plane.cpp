// SPDX-License-Identifier: Apache-2.0
#include "host/model/clicked_plane.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>

#include "hal/base/order_statistics.h"
#include "host/estimation/points/plane_fit.h"

namespace mixrig::model {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kLeastClickPoints = 12;     ///< around the click
constexpr double kLeastKnownClick = 0.6;  ///< of the pixels around it
constexpr double kNearClick = 2.5;        ///< pixels of the depth camera that must lie on the plane
constexpr double kMostNearOff = 0.1;      ///< share of them that may not
constexpr double kRegionSigmas = 3;
constexpr std::array<double, 4> kNoisier{1, 1.5, 2.2, 3.3};  ///< than the stated sigma
constexpr double kCurvedSigmas = 5, kCurved_m = 4e-3;        ///< over the rectangle
constexpr double kLeastArea_m2 = 0.01;
constexpr double kLeastClickSine = 0.087;  ///< 5 degrees
constexpr double kCommonShare = 0.1;       ///< of a depth's sigma, in common to a region
constexpr int kClickRounds = 3;
constexpr int kClickSquare = 6;      ///< pixels along a side, whose mean is looked at
constexpr double kSquareSigmas = 3;  ///< of that mean, beyond kCommonShare of one depth

/// A pixel of the depth camera in axes of the view.
struct ClickSample {
  Vector3d point_m = Vector3d::Zero();  ///< zero: unknown
  Vector3d ray = Vector3d::Zero();      ///< depth 1 along the depth camera's axis, its axes
  double sigma_m = 0;                   ///< of z
  bool known() const { return sigma_m > 0; }
};

class ClickGrid {
 public:
  explicit ClickGrid(const ClickPicture& picture) : picture_(picture) {
    const Size size = picture.depth_m.size;
    samples_.resize(size.area());
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) samples_[index(x, y)] = sample(x, y);
  }
  Size size() const { return picture_.depth_m.size; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(size().width) +
           static_cast<std::size_t>(x);
  }
  const ClickSample& at(int x, int y) const { return samples_[index(x, y)]; }
  const geometry::Pose& view_from_tof() const { return picture_.view_from_tof; }
  void scale_sigmas(double factor) {
    for (ClickSample& s : samples_) s.sigma_m *= factor;
  }

 private:
  ClickSample sample(int x, int y) const {
    ClickSample s;
    const auto ray = picture_.tof->unproject({x, y});
    if (!ray) return s;
    s.ray = {ray->x(), ray->y(), 1};
    const double depth_m = picture_.depth_m.at(x, y);
    if (!(depth_m > 0) || !std::isfinite(depth_m)) return s;
    const double z_m = picture_.depth_is_distance ? depth_m / s.ray.norm() : depth_m;
    s.point_m = picture_.view_from_tof * (z_m * s.ray);
    s.sigma_m = picture_.noise.sigma_m(z_m);
    return s;
  }

  const ClickPicture& picture_;
  std::vector<ClickSample> samples_;
};

struct ClickPlace {
  int x = 0, y = 0;
};

/// What lies around the click, and how much of it is unknown.
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

/// Inverse depth a . ray of a plane a . p = 1 in the depth camera's axes.
struct InversePlane {
  Vector3d a = Vector3d::Zero();
  Matrix3d covariance = Matrix3d::Zero();

  double off_m(const ClickSample& s, const geometry::Pose& tof_from_view) const {
    const Vector3d p = tof_from_view * s.point_m;
    const double w = a.dot(s.ray);
    return w > 0 ? p.z() - 1 / w : 1e9;
  }
};

class ClickRegion {
 public:
  explicit ClickRegion(const ClickGrid& grid)
      : grid_(grid), tof_from_view_(geometry::inverse(grid.view_from_tof())), part_(grid.size()) {}

  bool fits(const InversePlane& plane, ClickPlace at) const {
    const ClickSample& s = grid_.at(at.x, at.y);
    return s.known() && std::abs(plane.off_m(s, tof_from_view_)) < kRegionSigmas * s.sigma_m;
  }
  double sigmas(const InversePlane& plane, ClickPlace at) const {
    const ClickSample& s = grid_.at(at.x, at.y);
    return plane.off_m(s, tof_from_view_) / s.sigma_m;
  }

  void grow(const InversePlane& plane, const std::vector<ClickPlace>& seeds) {
    part_.fill(0);
    places_.clear();
    for (const ClickPlace& at : seeds) take(plane, at);
    for (std::size_t i = 0; i < places_.size(); ++i) {
      const ClickPlace from = places_[i];
      for (const ClickPlace step : {ClickPlace{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
        take(plane, {from.x + step.x, from.y + step.y});
    }
  }

  /// Keeps what goes on from the seeds over squares that lie on the plane as a whole: things on a
  /// wall may be within the noise of each pixel, but not within that of their mean.
  void keep_flat(const InversePlane& plane, const std::vector<ClickPlace>& seeds) {
    const auto squares = [](int px) { return (px + kClickSquare - 1) / kClickSquare; };
    const Size size{squares(part_.width()), squares(part_.height())};
    struct Square {
      double sum = 0, count = 0;
    };
    Image<Square> sums(size);
    for (const ClickPlace& at : places_) {
      Square& square = sums.at(at.x / kClickSquare, at.y / kClickSquare);
      square.sum += sigmas(plane, at), square.count += 1;
    }
    Image<std::uint8_t> kept(size);
    std::vector<ClickPlace> open;
    const auto keep = [&](int x, int y, bool sure) {
      if (x < 0 || y < 0 || x >= size.width || y >= size.height || kept.at(x, y) != 0) return;
      const Square& square = sums.at(x, y);
      const double most = kSquareSigmas * std::sqrt(square.count) + kCommonShare * square.count;
      if (!sure && (square.count == 0 || std::abs(square.sum) > most)) return;
      kept.at(x, y) = 1, open.push_back({x, y});
    };
    for (const ClickPlace& at : seeds) keep(at.x / kClickSquare, at.y / kClickSquare, true);
    for (std::size_t i = 0; i < open.size(); ++i)
      for (const ClickPlace step : {ClickPlace{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
        keep(open[i].x + step.x, open[i].y + step.y, false);
    std::erase_if(places_, [&](const ClickPlace& at) {
      const bool out = kept.at(at.x / kClickSquare, at.y / kClickSquare) == 0;
      if (out) part_.at(at.x, at.y) = 0;
      return out;
    });
  }

  std::optional<InversePlane> fit(const std::vector<ClickPlace>& places) const {
    Matrix3d information = Matrix3d::Zero();
    Vector3d right = Vector3d::Zero();
    for (const ClickPlace& at : places) {
      const ClickSample& s = grid_.at(at.x, at.y);
      const double z_m = (tof_from_view_ * s.point_m).z();
      const double weight = std::pow(z_m * z_m / s.sigma_m, 2);
      information += weight * s.ray * s.ray.transpose();
      right += weight / z_m * s.ray;
    }
    const Eigen::LDLT<Matrix3d> solver(information);
    if (solver.info() != Eigen::Success || !solver.isPositive()) return {};
    InversePlane plane{solver.solve(right), solver.solve(Matrix3d::Identity())};
    if (!plane.a.allFinite() || !(plane.a.norm() > 0)) return {};
    return plane;
  }

  /// Those that lie two pixels within the region: at its border a pixel sees two surfaces.
  std::vector<ClickPlace> inner_places() const {
    const auto on = [&](int x, int y) {
      return x >= 0 && y >= 0 && x < part_.width() && y < part_.height() && part_.at(x, y) != 0;
    };
    std::vector<ClickPlace> inner;
    for (const auto& [x, y] : places_)
      if (on(x - 2, y) && on(x + 2, y) && on(x, y - 2) && on(x, y + 2)) inner.push_back({x, y});
    return inner;
  }
  const std::vector<ClickPlace>& places() const { return places_; }
  Image<std::uint8_t> part() && { return std::move(part_); }

 private:
  void take(const InversePlane& plane, ClickPlace at) {
    if (at.x < 0 || at.y < 0 || at.x >= part_.width() || at.y >= part_.height()) return;
    if (part_.at(at.x, at.y) != 0 || !fits(plane, at)) return;
    part_.at(at.x, at.y) = 1;
    places_.push_back(at);
  }

  const ClickGrid& grid_;
  geometry::Pose tof_from_view_;
  Image<std::uint8_t> part_;
  std::vector<ClickPlace> places_;
};

/// Whether the depths bend away from the plane: a quadratic over the rectangle that is certain and
/// larger than kCurved_m.
bool is_curved(const ClickGrid& grid, const ClickRegion& region, const InversePlane& plane,
               const std::vector<ClickPlace>& on) {
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
  const Eigen::LDLT<Eigen::Matrix<double, 6, 6>> solver(a);
  const Vector6d bend_m = solver.solve(b);
  const Eigen::Matrix<double, 6, 6> inverse = solver.solve(Eigen::Matrix<double, 6, 6>::Identity());
  for (int i = 3; i < 6; ++i)
    if (std::abs(bend_m[i]) >
        std::max(kCurved_m, kCurvedSigmas * sigma_m * std::sqrt(inverse(i, i))))
      return true;
  return false;
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
  const Eigen::SelfAdjointEigenSolver<Matrix3d> spread(turn);
  out.normal_sigma_rad = std::sqrt(std::max(0.0, spread.eigenvalues()[2]));
  const Vector3d p = geometry::inverse(view_from_tof) * out.point_m;
  const double statistical_m = std::sqrt(std::max(0.0, p.dot(plane.covariance * p))) / norm;
  out.offset_sigma_m = std::hypot(statistical_m, kCommonShare * sigma_m);
}

}  // namespace

std::string_view text_of(ClickRefusal refusal) {
  switch (refusal) {
    case ClickRefusal::kOutside:
      return "the depth camera does not look there: click farther inside the picture";
    case ClickRefusal::kUnknown:
      return "the depth is unknown there (glass, black, or too far): click beside it";
    case ClickRefusal::kEdge:
      return "several surfaces meet there: click farther from the edge, or give a smaller --rect";
    case ClickRefusal::kNotFlat:
      return "it is not flat there (an edge, a person, hair): click on a table, the floor "
             "or "
             "a wall";
    case ClickRefusal::kGrazing:
      return "the camera sees the surface from its edge: its direction is not determined";
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

  std::vector<Vector3d> points;
  std::vector<double> sigmas_m;
  for (const ClickPlace& at : around.known) {
    points.push_back(grid.at(at.x, at.y).point_m), sigmas_m.push_back(grid.at(at.x, at.y).sigma_m);
  }
  // Dark surfaces and those seen at an angle are noisier than the stated sigma.
  double sigma_m = upper_median(sigmas_m);
  estimation::Estimate<estimation::PlaneFit> first;
  for (const double factor : kNoisier) {
    first = estimation::fit_plane_robust(points, factor * sigma_m);
    if (first.usable()) break;
  }
  if (!first.usable())
    return first.verdict.reason.find("contradict") != std::string::npos ? ClickRefusal::kEdge
                                                                        : ClickRefusal::kNotFlat;
  // In the depth camera's axes, a . p = 1.
  const geometry::Pose tof_from_view = geometry::inverse(picture.view_from_tof);
  const Vector3d normal = tof_from_view.rotation * first.value.plane.normal;
  const double at_m = normal.dot(tof_from_view * first.value.centroid_m);
  const Vector3d sight = (tof_from_view * first.value.centroid_m).normalized();
  if (std::abs(normal.dot(sight)) < kLeastClickSine) return ClickRefusal::kGrazing;
  InversePlane plane{normal / at_m, {}};

  ClickRegion region(grid);
  std::vector<double> sizes;
  for (const ClickPlace& at : around.known) sizes.push_back(std::abs(region.sigmas(plane, at)));
  const double noisier = std::clamp(1.4826 * upper_median(sizes), 1.0, kNoisier.back());
  grid.scale_sigmas(noisier), sigma_m *= noisier;
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
  if (static_cast<int>(on.size()) < kLeastClickPoints || is_curved(grid, region, plane, on))
    return ClickRefusal::kNotFlat;

  for (int round = 0; round < kClickRounds; ++round) {
    region.grow(plane, on);
    const auto better = region.fit(region.places());
    if (!better) return ClickRefusal::kNotFlat;
    plane = *better;
  }
  for (int round = 0; round < kClickRounds; ++round) {
    region.grow(plane, on);
    region.keep_flat(plane, on);
    if (static_cast<int>(region.places().size()) < kLeastClickPoints) return ClickRefusal::kNotFlat;
    const auto inner = region.inner_places();
    const auto better =
        region.fit(static_cast<int>(inner.size()) < kLeastClickPoints ? region.places() : inner);
    if (!better) return ClickRefusal::kNotFlat;
    plane = *better;
  }
  move_to(region, grid, on, plane);
  ClickedPlane out;
  out.plane = plane_in_view(plane, picture.view_from_tof);
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
  judge_sigmas(plane, picture.view_from_tof, sigma_m, out);
  out.region = std::move(region).part();
  return out;
}

}  // namespace mixrig::model
