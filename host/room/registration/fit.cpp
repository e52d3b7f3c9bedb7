// SPDX-License-Identifier: Apache-2.0
#include "host/room/registration/fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <span>

#include "hal/base/order_statistics.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/geometry/linear.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;
using geometry::Pose;

constexpr double kLeastScale_m = 3e-3;  ///< walls of two scans differ by as much
constexpr double kUnitGate_m = 0.05, kUnitCosine = 0.95, kUnitCell_m = 2;
constexpr double kLeastCommon = 0.3;   ///< of the sigma of a distance
constexpr double kCommonLength_m = 2;  ///< over which the error common to both scans changes

double fit_scale_m(const std::vector<FitRow>& rows) {
  return std::max(kLeastScale_m, 1.4826 * median_off_m(rows));
}

double fit_weight(double off_m, double scale_m) {
  const double r = off_m / (1.5 * scale_m);
  return 1 / (1 + r * r);
}

Pose stepped(const Pose& a_from_b, const Vector6d& step) {
  const Vector3d turn = step.tail<3>();
  const double angle = turn.norm();
  Pose out = a_from_b;
  if (angle > 1e-12)
    out.rotation =
        (Eigen::Quaterniond(Eigen::AngleAxisd(angle, turn / angle)) * out.rotation).normalized();
  out.translation_m += step.head<3>();
  return out;
}

/// One weighted step of least squares; false where it leads nowhere.
bool fit_step(const std::vector<FitRow>& rows, Vector6d& step) {
  constexpr double kWeakPrior = 1e-6;  // keeps an open direction where it is
  const double scale_m = fit_scale_m(rows);
  Matrix6d squares = Matrix6d::Identity() * kWeakPrior * static_cast<double>(rows.size());
  Vector6d right = Vector6d::Zero();
  for (const FitRow& row : rows) {
    const double weight = fit_weight(row.off_m, scale_m);
    squares += weight * row.slope * row.slope.transpose();
    right -= weight * row.off_m * row.slope;
  }
  step = geometry::SymmetricSolver<6>(squares).solve(right);
  return step.allFinite() && step.norm() <= 1;
}

struct UnitPlane {
  Vector3d normal;
  double away_m = 0;
  bool holds(const FitRow& row) const {
    return std::abs(normal.dot(row.at_m) - away_m) < kUnitGate_m &&
           normal.dot(row.normal) > kUnitCosine;
  }
};

/// Planes of a, then those of b, in a's axes.
std::vector<UnitPlane> unit_planes(const std::vector<RoomPlane>& of_a,
                                   const std::vector<RoomPlane>& of_b, const Pose& a_from_b) {
  std::vector<UnitPlane> planes;
  for (const RoomPlane& p : of_a)
    planes.push_back({p.inverse_per_m.normalized(), 1 / p.inverse_per_m.norm()});
  for (const RoomPlane& p : of_b) {
    const Vector3d normal = a_from_b.rotation * p.inverse_per_m.normalized();
    planes.push_back({normal, 1 / p.inverse_per_m.norm() + normal.dot(a_from_b.translation_m)});
  }
  return planes;
}

/// Weighted sums over the rows of a unit.
struct UnitSums {
  Vector6d slope = Vector6d::Zero();
  double off_m = 0, weight = 0, squares = 0;
};

std::vector<UnitSums> sums_of(const std::vector<FitRow>& rows, const std::vector<int>& units,
                              double scale_m) {
  std::vector<UnitSums> sums(
      static_cast<std::size_t>(*std::max_element(units.begin(), units.end()) + 1));
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const double w = fit_weight(rows[i].off_m, scale_m);
    UnitSums& unit = sums[static_cast<std::size_t>(units[i])];
    unit.slope += w * rows[i].slope, unit.off_m += w * rows[i].off_m;
    unit.weight += w, unit.squares += w * w;
  }
  return sums;
}

/// Standard deviation of the errors that whole units have, by moments: the mean residual of a unit
/// is its own error less what the fit absorbed of the errors of all units.
double common_sigma_m(const std::vector<UnitSums>& sums, const Matrix6d& inverse, double single_m) {
  constexpr double kFewPlaces = 30;  // that say little of their unit
  double found = 0, expected = 0;
  for (const UnitSums& c : sums) {
    double kept = 0;
    for (const UnitSums& d : sums) {
      const double taken = c.slope.dot(inverse * d.slope) / c.weight;
      const double share = (&c == &d ? 1 : 0) - taken;
      kept += share * share;
    }
    const double mean_m = c.off_m / c.weight;
    const double own2 = single_m * single_m * c.squares / (c.weight * c.weight);
    const double says = c.weight / (c.weight + kFewPlaces);
    found += says * (mean_m * mean_m - own2);
    expected += says * kept;
  }
  return std::sqrt(std::max(0.0, expected > 0 ? found / expected : 0));
}

double median_sigma_m(const std::vector<FitRow>& rows) {
  std::vector<double> sigma_m;
  for (const FitRow& row : rows) sigma_m.push_back(row.sigma_m);
  return upper_median_in_place(std::span(sigma_m));
}

}  // namespace

std::vector<FitRow> fit_rows(const Sides& sides, const Pose& a_from_b, double gate_m,
                             bool held_out) {
  std::vector<FitRow> rows;
  const Eigen::Matrix3d turn = a_from_b.rotation.toRotationMatrix();
  look_all(sides, a_from_b, gate_m,
           [&](const Side& side, std::size_t i, const Vector3d& at_m, const Vector3d& normal,
               const Seen& seen) {
             if (seen.sight != RoomSight::kAgrees || (i % 3 == 0) != held_out) return;
             FitRow row;
             row.normal = side.of_b ? normal : side.places[i].normal;
             row.at_m = side.of_b ? at_m : side.places[i].at_m;
             const Vector3d lever =
                 side.of_b ? Vector3d(at_m - a_from_b.translation_m) : Vector3d(turn * at_m);
             row.slope << row.normal, lever.cross(row.normal);
             row.off_m = side.of_b ? seen.off_m : -seen.off_m;
             row.sigma_m = std::hypot(seen.sigma_m, side.places[i].sigma_m);
             rows.push_back(row);
           });
  return rows;
}

double median_off_m(const std::vector<FitRow>& rows) {
  std::vector<double> off_m;
  for (const FitRow& row : rows) off_m.push_back(std::abs(row.off_m));
  return upper_median_in_place(std::span(off_m));
}

Pose refined_pose(const Sides& sides, Pose a_from_b, std::initializer_list<double> gates_m) {
  constexpr int kSteps = 8;
  for (const double gate_m : gates_m)
    for (int i = 0; i < kSteps; ++i) {
      const std::vector<FitRow> rows = fit_rows(sides, a_from_b, gate_m, false);
      Vector6d step;
      if (rows.size() < 12 || !fit_step(rows, step)) return a_from_b;
      a_from_b = stepped(a_from_b, step);
      if (step.norm() < 1e-6) break;
    }
  return a_from_b;
}

std::vector<int> units_of(const std::vector<FitRow>& rows, const std::vector<RoomPlane>& of_a,
                          const std::vector<RoomPlane>& of_b, const Pose& a_from_b) {
  const std::vector<UnitPlane> planes = unit_planes(of_a, of_b, a_from_b);
  std::map<std::array<int, 4>, int> numbers;  // of a plane, or of a cell and where it faces
  std::vector<int> units;
  for (const FitRow& row : rows) {
    std::array<int, 4> key{};
    const auto plane = std::find_if(planes.begin(), planes.end(),
                                    [&](const UnitPlane& p) { return p.holds(row); });
    if (plane != planes.end()) {
      key[3] = -1 - static_cast<int>(plane - planes.begin());
    } else {
      Eigen::Index axis = 0;
      row.normal.cwiseAbs().maxCoeff(&axis);
      for (std::size_t k = 0; k < 3; ++k)
        key[k] = static_cast<int>(std::floor(row.at_m[static_cast<Eigen::Index>(k)] / kUnitCell_m));
      key[3] = static_cast<int>(axis) + (row.normal[axis] < 0 ? 3 : 0);
    }
    units.push_back(numbers.try_emplace(key, static_cast<int>(numbers.size())).first->second);
  }
  return units;
}

FitCovariance covariance_of(const std::vector<FitRow>& rows, const std::vector<int>& units,
                            const Pose& a_from_b) {
  FitCovariance out;
  if (rows.empty()) return out;
  out.single_m = 1.4826 * median_off_m(rows);
  const double scale_m = std::max(kLeastScale_m, out.single_m);
  const std::vector<UnitSums> sums = sums_of(rows, units, scale_m);
  Matrix6d squares = 1e-9 * static_cast<double>(rows.size()) * Matrix6d::Identity();
  Matrix6d singles = Matrix6d::Zero(), common = Matrix6d::Zero();
  for (const FitRow& row : rows) {
    const double w = fit_weight(row.off_m, scale_m);
    squares += w * row.slope * row.slope.transpose();
    singles += w * w * row.slope * row.slope.transpose();
  }
  const Matrix6d inverse = geometry::SymmetricSolver<6>(squares).inverse();
  out.common_m =
      std::max(kLeastCommon * median_sigma_m(rows), common_sigma_m(sums, inverse, out.single_m));
  for (const UnitSums& c : sums) common += c.slope * c.slope.transpose();
  for (const UnitSums& c : sums_of(rows, units_of(rows, {}, {}, a_from_b), scale_m))
    common += c.slope * c.slope.transpose();
  out.covariance = inverse *
                   (out.common_m * out.common_m * common + out.single_m * out.single_m * singles) *
                   inverse;
  const Vector3d longer_m = out.common_m / kCommonLength_m * a_from_b.translation_m;
  out.covariance.topLeftCorner<3, 3>() += longer_m * longer_m.transpose();
  return out;
}

Hold hold_of(const std::vector<FitRow>& rows, const std::vector<int>& units, int left_out) {
  Matrix6d squares = 1e-9 * static_cast<double>(rows.size()) * Matrix6d::Identity();
  for (std::size_t i = 0; i < rows.size(); ++i)
    if (units[i] != left_out) squares += rows[i].slope * rows[i].slope.transpose();
  const Matrix6d inverse = geometry::SymmetricSolver<6>(squares).inverse();
  const estimation::Spectrum shift = estimation::spectrum_of(inverse.topLeftCorner<3, 3>());
  const double most = shift.values[2] * static_cast<double>(rows.size());
  return {shift.axes.col(2), most > 0 ? 1 / most : 0};
}

}  // namespace mixrig::model
