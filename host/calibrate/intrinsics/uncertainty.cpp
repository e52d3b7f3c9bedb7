// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/intrinsics/uncertainty.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "hal/base/order_statistics.h"
#include "host/math/estimation/decompositions.h"

namespace mixrig::calibration {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector2d;
using Eigen::Vector3d;
using Row2 = Eigen::Matrix<double, 2, Eigen::Dynamic>;

constexpr double kFar_m = 1e4;

Vector2d cell_middle(Size size, int columns, int rows, int c, int r) {
  return {(c + 0.5) * size.width / columns - 0.5, (r + 0.5) * size.height / rows - 0.5};
}

/// d pixel / d free intrinsics at a direction; empty where it has no pixel.
Row2 by_intrinsics(const Bundle& bundle, const geometry::Projection& at) {
  Row2 j(2, static_cast<Eigen::Index>(bundle.free.size()));
  for (std::size_t k = 0; k < bundle.free.size(); ++k)
    j.col(static_cast<Eigen::Index>(k)) = at.d_parameters.col(bundle.free[k]);
  return j;
}

/// d pixel / d all parameters of a far point that is tied to all boards equally.
Row2 by_everything(const Bundle& bundle, const geometry::Projection& at, const Vector3d& p) {
  const auto count = static_cast<Eigen::Index>(bundle.free.size());
  const auto views = static_cast<Eigen::Index>(bundle.views.size());
  Row2 j(2, count + 6 * views);
  j.leftCols(count) = by_intrinsics(bundle, at);
  for (Eigen::Index v = 0; v < views; ++v) {
    const PoseVector& pose = bundle.views[static_cast<std::size_t>(v)].camera_from_board;
    j.middleCols(count + 6 * v, 6) =
        at.d_point * pose_jacobian(pose, inverse(pose_of(pose)) * p) / static_cast<double>(views);
  }
  return j;
}

/// Information of one view about the free intrinsics, its pose eliminated.
MatrixXd information_of_view(const Bundle& bundle, const BundleView& view) {
  Bundle one;
  one.kind = bundle.kind;
  one.intrinsics = bundle.intrinsics;
  one.free = bundle.free;
  one.views = {view};
  const MatrixXd all = information(one);
  const auto count = static_cast<Eigen::Index>(bundle.free.size());
  const estimation::SymmetricSolver pose(all.bottomRightCorner(6, 6));
  return all.topLeftCorner(count, count) -
         all.topRightCorner(count, 6).lazyProduct(pose.solve(all.bottomLeftCorner(6, count)));
}

bool in_picture(const Vector2d& px, Size size) {
  return px.x() >= 0 && px.y() >= 0 && px.x() <= size.width - 1 && px.y() <= size.height - 1;
}

/// The part of the picture that has an image: all of it, or the box about the image circle in it.
struct Box {
  Vector2d low_px, high_px;
};
Box image_box(const geometry::AnyCamera& camera) {
  const Size size = geometry::size_px(camera);
  const Vector2d last(size.width, size.height);
  const auto* fisheye = std::get_if<geometry::FisheyeModel>(&camera);
  if (fisheye == nullptr || !fisheye->parameters().max_angle_rad) return {Vector2d::Zero(), last};
  const Vector2d center(fisheye->parameters().cx_px, fisheye->parameters().cy_px);
  return {(center - fisheye->rim_px()).cwiseMax(0), (center + fisheye->rim_px()).cwiseMin(last)};
}

/// Positions in which the board could be held.
struct Place {
  const char* words;
  double x, y;  // share of the image's box
};
constexpr std::array<Place, 9> kPlaces{{{"top left", 0.2, 0.2},
                                        {"top", 0.5, 0.2},
                                        {"top right", 0.8, 0.2},
                                        {"left", 0.2, 0.5},
                                        {"middle", 0.5, 0.5},
                                        {"right", 0.8, 0.5},
                                        {"bottom left", 0.2, 0.8},
                                        {"bottom", 0.5, 0.8},
                                        {"bottom right", 0.8, 0.8}}};
struct Tilt {
  const char* words;
  double about_x_rad, about_y_rad;
};
constexpr std::array<Tilt, 5> kTilts{{{"flat to the camera", 0, 0},
                                      {"its top tilted away by 35 degrees", 0.6, 0},
                                      {"its top tilted towards you by 35 degrees", -0.6, 0},
                                      {"its left side tilted away by 35 degrees", 0, 0.6},
                                      {"its right side tilted away by 35 degrees", 0, -0.6}}};

BundleView hold_board(const Intrinsics& in, const std::vector<Vector3d>& points_m,
                      const Place& place, const Tilt& tilt, double distance_m) {
  BundleView view;
  const Size size = geometry::size_px(in.camera);
  const Box box = image_box(in.camera);
  const auto ray = geometry::unproject(
      in.camera, box.low_px + Vector2d(place.x, place.y).cwiseProduct(box.high_px - box.low_px));
  if (!ray) return view;
  // From the optical axis to the ray, the short way.
  const Vector3d d = ray->normalized();
  const Eigen::Quaterniond facing = Eigen::Quaterniond(1 + d.z(), -d.y(), d.x(), 0).normalized();
  const Eigen::Quaterniond turn = facing * Eigen::AngleAxisd(tilt.about_x_rad, Vector3d::UnitX()) *
                                  Eigen::AngleAxisd(tilt.about_y_rad, Vector3d::UnitY());
  Vector3d middle = Vector3d::Zero();
  for (const auto& p : points_m) middle += p / static_cast<double>(points_m.size());
  const geometry::Pose pose{turn, distance_m * *ray - turn * middle};
  view.camera_from_board = vector_of(pose);
  for (const auto& p : points_m) {
    const auto px = geometry::project(in.camera, pose * p);
    if (!px || !in_picture(*px, size)) continue;
    view.points_m.push_back(p);
    view.px.push_back(*px);
  }
  view.used.assign(view.px.size(), 1);
  return view;
}

/// Standard deviation of the pixel of a far point, in its worse direction.
std::optional<double> far_sigma_px(const Intrinsics& in, const estimation::SymmetricSolver& solver,
                                   const Vector3d& ray) {
  const Vector3d p = kFar_m * ray;
  const auto at = geometry::project_with_jacobians(in.bundle.kind, in.bundle.intrinsics.data(), p);
  if (!at) return std::nullopt;
  const Row2 j = by_everything(in.bundle, *at, p);
  const Eigen::Matrix2d covariance = j.lazyProduct(solver.solve(j.transpose()));
  const double worse = estimation::planar_spectrum_of(covariance).values[1];
  return in.sigma_px * std::sqrt(std::max(worse, 0.0));
}

/// Rays at the largest angle of a fisheye that lie inside the picture.
std::vector<Vector3d> rim_rays(const geometry::AnyCamera& camera) {
  std::vector<Vector3d> rays;
  const auto angle = geometry::max_angle_rad(camera);
  constexpr int kDirections = 36;
  for (int i = 0; angle && i < kDirections; ++i) {
    const double phi = i * 2 * M_PI / kDirections;
    // Just inside, so that rounding does not put it outside.
    const double theta = *angle * (1 - 1e-9);
    const Vector3d ray(std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi),
                       std::cos(theta));
    const auto px = geometry::project(camera, ray);
    if (px && in_picture(*px, geometry::size_px(camera))) rays.push_back(ray);
  }
  return rays;
}

/// Root of the mean variance of the pixels of far points, given the information on the intrinsics.
double mean_sigma_px(const std::vector<Row2>& rows, const MatrixXd& information, double sigma_px) {
  const estimation::SymmetricSolver solver(information);
  double sum = 0;
  for (const Row2& j : rows) sum += j.lazyProduct(solver.solve(j.transpose())).trace() / 2;
  return sigma_px * std::sqrt(sum / static_cast<double>(std::max<std::size_t>(rows.size(), 1)));
}

}  // namespace

UncertaintyMap projection_uncertainty(const Intrinsics& in, int columns, int rows) {
  UncertaintyMap map;
  map.columns = columns, map.rows = rows;
  const MatrixXd information = calibration::information(in.bundle);
  const estimation::SymmetricSolver solver(information);
  std::vector<double> known;
  for (int r = 0; r < rows; ++r)
    for (int c = 0; c < columns; ++c) {
      map.sigma_px.push_back(std::numeric_limits<double>::quiet_NaN());
      const auto ray = geometry::unproject(
          in.camera, cell_middle(geometry::size_px(in.camera), columns, rows, c, r));
      const auto sigma_px = ray ? far_sigma_px(in, solver, *ray) : std::nullopt;
      if (!sigma_px) continue;
      map.sigma_px.back() = *sigma_px;
      known.push_back(*sigma_px);
    }
  map.median_px = upper_median(known);
  for (const Vector3d& ray : rim_rays(in.camera))
    map.rim_px = std::max(map.rim_px, far_sigma_px(in, solver, ray).value_or(0));
  map.worst_px = map.rim_px;
  for (const double sigma_px : known) map.worst_px = std::max(map.worst_px, sigma_px);
  return map;
}

std::vector<int> coverage(const Intrinsics& in, int columns, int rows) {
  const Size size = geometry::size_px(in.camera);
  std::vector<int> counts(static_cast<std::size_t>(columns * rows), 0);
  for (const ViewFit& view : in.views)
    for (const Vector2d& px : view.px) {
      const int c =
          std::clamp(static_cast<int>(columns * (px.x() + 0.5) / size.width), 0, columns - 1);
      const int r = std::clamp(static_cast<int>(rows * (px.y() + 0.5) / size.height), 0, rows - 1);
      ++counts[static_cast<std::size_t>(r * columns + c)];
    }
  return counts;
}

Advice advise(const Intrinsics& in, const BoardSpec& board) {
  const auto points_m = board_points_m(board);
  std::vector<Row2> rows;
  constexpr int kGrid = 7;
  for (int i = 0; i < kGrid * kGrid; ++i)
    if (const auto ray = geometry::unproject(
            in.camera,
            cell_middle(geometry::size_px(in.camera), kGrid, kGrid, i % kGrid, i / kGrid)))
      if (const auto at =
              geometry::project_with_jacobians(in.bundle.kind, in.bundle.intrinsics.data(), *ray))
        rows.push_back(by_intrinsics(in.bundle, *at));
  const auto count = static_cast<Eigen::Index>(in.bundle.free.size());
  MatrixXd now = MatrixXd::Zero(count, count);
  std::vector<double> distances_m;
  for (const BundleView& view : in.bundle.views) {
    now += information_of_view(in.bundle, view);
    distances_m.push_back(view.camera_from_board.tail<3>().norm());
  }
  Advice best;
  best.mean_now_px = best.mean_then_px = mean_sigma_px(rows, now, in.sigma_px);
  for (const double nearer : {1.0, 0.7})
    for (const Place& place : kPlaces)
      for (const Tilt& tilt : kTilts) {
        const BundleView view =
            hold_board(in, points_m, place, tilt, nearer * upper_median(distances_m));
        // A checkerboard must be seen whole, the others at least by half.
        const std::size_t least =
            board.kind == BoardKind::kCheckerboard ? points_m.size() : points_m.size() / 2;
        if (view.px.size() < least) continue;
        const double then =
            mean_sigma_px(rows, now + information_of_view(in.bundle, view), in.sigma_px);
        if (then >= best.mean_then_px) continue;
        best.mean_then_px = then;
        best.camera_from_board = pose_of(view.camera_from_board);
        best.where = std::string("in the ") + place.words + " of the picture, " + tilt.words +
                     (nearer < 1 ? ", nearer than usual" : "");
      }
  return best;
}

}  // namespace mixrig::calibration
