// SPDX-License-Identifier: Apache-2.0
#include "host/room/click/click_region.h"

#include <array>
#include <cmath>

#include "host/math/geometry/linear.h"

namespace mixrig::model {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kRegionSigmas = 3;
constexpr int kClickSquare = 6;      ///< pixels along a side, whose mean is looked at
constexpr double kSquareSigmas = 3;  ///< of that mean, beyond kCommonShare of one depth

}  // namespace

double InversePlane::off_m(const ClickSample& s, const geometry::Pose& tof_from_view) const {
  const Vector3d p = tof_from_view * s.point_m;
  const double w = a.dot(s.ray);
  return w > 0 ? p.z() - 1 / w : 1e9;
}

bool ClickRegion::fits(const InversePlane& plane, ClickPlace at) const {
  const ClickSample& s = grid_.at(at.x, at.y);
  return s.known() && std::abs(plane.off_m(s, tof_from_view_)) < kRegionSigmas * s.sigma_m;
}

double ClickRegion::sigmas(const InversePlane& plane, ClickPlace at) const {
  const ClickSample& s = grid_.at(at.x, at.y);
  return plane.off_m(s, tof_from_view_) / s.sigma_m;
}

void ClickRegion::grow(const InversePlane& plane, const std::vector<ClickPlace>& seeds) {
  part_.fill(0);
  places_.clear();
  for (const ClickPlace& at : seeds) take(plane, at);
  for (std::size_t i = 0; i < places_.size(); ++i) {
    const ClickPlace from = places_[i];
    for (const ClickPlace step : {ClickPlace{1, 0}, {-1, 0}, {0, 1}, {0, -1}})
      take(plane, {from.x + step.x, from.y + step.y});
  }
}

void ClickRegion::keep_flat(const InversePlane& plane, const std::vector<ClickPlace>& seeds) {
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

std::optional<InversePlane> ClickRegion::fit(const std::vector<ClickPlace>& places) const {
  Matrix3d information = Matrix3d::Zero();
  Vector3d right = Vector3d::Zero();
  for (const ClickPlace& at : places) {
    const ClickSample& s = grid_.at(at.x, at.y);
    const double z_m = (tof_from_view_ * s.point_m).z();
    const double weight = std::pow(z_m * z_m / s.sigma_m, 2);
    information += weight * s.ray * s.ray.transpose();
    right += weight / z_m * s.ray;
  }
  const geometry::SymmetricSolver<3> solver(information);
  if (!solver.is_solved() || !solver.is_positive()) return {};
  InversePlane plane{solver.solve(right), solver.inverse()};
  if (!plane.a.allFinite() || !(plane.a.norm() > 0)) return {};
  return plane;
}

std::vector<ClickPlace> ClickRegion::inner_places() const {
  const auto on = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < part_.width() && y < part_.height() && part_.at(x, y) != 0;
  };
  std::vector<ClickPlace> inner;
  for (const auto& [x, y] : places_)
    if (on(x - 2, y) && on(x + 2, y) && on(x, y - 2) && on(x, y + 2)) inner.push_back({x, y});
  return inner;
}

void ClickRegion::take(const InversePlane& plane, ClickPlace at) {
  if (at.x < 0 || at.y < 0 || at.x >= part_.width() || at.y >= part_.height()) return;
  if (part_.at(at.x, at.y) != 0 || !fits(plane, at)) return;
  part_.at(at.x, at.y) = 1;
  places_.push_back(at);
}

}  // namespace mixrig::model
