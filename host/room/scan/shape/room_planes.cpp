// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/shape/room_planes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>

#include "hal/base/order_statistics.h"
#include "host/math/geometry/linear.h"

namespace mixrig::model {
namespace {

using Eigen::Vector3d;

constexpr int kGrid_px = 6;           ///< between samples of a panorama 720 high
constexpr int kRounds = 16;           ///< planes at most
constexpr int kGuesses = 80;          ///< hypotheses a round
constexpr double kLeast_sr = 0.08;    ///< 0.3 m^2 seen straight on from 2 m
constexpr double kSameNormal = 0.94;  ///< cosine of 20 degrees
constexpr double kPlaneGate_m = 8e-3, kPlaneSigmas = 3;
constexpr double kOnPlane_m = 3e-3;  ///< of a neighbourhood's mean

/// A place of the panorama with its normal.
struct PlaneSample {
  Vector3d ray, normal;
  double distance_m = 0, sigma_m = 0, solid_sr = 0;
  bool taken = false;

  double gate_m() const { return std::max(kPlaneGate_m, kPlaneSigmas * sigma_m); }
  bool lies_on(const Vector3d& inverse_per_m) const {
    const double w = inverse_per_m.dot(ray);
    if (w <= 0 || std::abs(1 / w - distance_m) > gate_m()) return false;
    return normal.dot(inverse_per_m) > kSameNormal * inverse_per_m.norm();
  }
};

/// Normal that points away from the origin, by the neighbours `reach` pixels around.
std::optional<Vector3d> normal_at(const Panorama& p, int x, int y, int reach) {
  const Size size = p.size();
  const auto point = [&](int u, int v) -> Vector3d {
    u = (u + size.width) % size.width;
    return p.distance_m.row(v)[u] * direction_of(size, u, v);
  };
  const double across_rad = std::cos(std::numbers::pi * (0.5 - (y + 0.5) / size.height));
  const int wide = std::min(size.width / 8, static_cast<int>(reach / std::max(across_rad, 0.05)));
  if (y < reach || y + reach >= size.height) return {};
  const Vector3d left = point(x - wide, y), right = point(x + wide, y);
  const Vector3d up = point(x, y - reach), down = point(x, y + reach);
  for (const Vector3d* at : {&left, &right, &up, &down})
    if (at->isZero()) return {};
  Vector3d normal = (right - left).cross(up - down).normalized();
  if (!normal.allFinite()) return {};
  if (normal.dot(point(x, y)) < 0) normal = -normal;
  return normal;
}

std::vector<PlaneSample> samples_of(const Panorama& p) {
  const Size size = p.size();
  const int step = std::max(1, size.height * kGrid_px / 720);
  const double pixel_rad = std::numbers::pi / size.height;
  std::vector<PlaneSample> samples;
  for (int y = step / 2; y < size.height; y += step)
    for (int x = step / 2; x < size.width; x += step) {
      if (p.views.row(y)[x] == 0) continue;
      const auto normal = normal_at(p, x, y, step);
      if (!normal) continue;
      const double across = std::sin(std::numbers::pi * (y + 0.5) / size.height);
      samples.push_back({direction_of(size, x, y), *normal, p.distance_m.row(y)[x],
                         p.sigma_m.row(y)[x], across * step * step * pixel_rad * pixel_rad});
    }
  return samples;
}

/// Least squares of inverse distances over the samples on a plane; those further off than most of
/// them are left out step by step (what hangs on a wall lies before it). Empty where they do not
/// give a plane.
std::optional<Vector3d> refined(const std::vector<PlaneSample>& samples, Vector3d inverse_per_m) {
  constexpr int kSteps = 5;
  constexpr double kMadSigmas = 2.5 * 1.4826, kLeastGate_m = 2e-3;
  double gate_m = 1;
  std::vector<double> off_m;
  for (int step = 0; step < kSteps; ++step) {
    Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
    Vector3d right = Vector3d::Zero();
    off_m.clear();
    for (const PlaneSample& s : samples) {
      if (s.taken || !s.lies_on(inverse_per_m)) continue;
      const double w = 1 / s.distance_m;
      off_m.push_back(std::abs(1 / inverse_per_m.dot(s.ray) - s.distance_m));
      if (off_m.back() > gate_m) continue;
      const double sigma = s.sigma_m * w * w;  // of the inverse distance
      const double weight = s.solid_sr / (sigma * sigma);
      squares += weight * s.ray * s.ray.transpose();
      right += weight * w * s.ray;
    }
    const geometry::SymmetricSolver<3> solver(squares);
    if (!(solver.least_pivot() > 0)) return {};
    inverse_per_m = solver.solve(right);
    if (!inverse_per_m.allFinite()) return {};
    gate_m = std::max(kLeastGate_m, kMadSigmas * upper_median_in_place(std::span(off_m)));
  }
  return inverse_per_m;
}

double support_sr(const std::vector<PlaneSample>& samples, const Vector3d& inverse_per_m,
                  std::size_t every) {
  double sum = 0;
  for (std::size_t i = 0; i < samples.size(); i += every)
    if (!samples[i].taken && samples[i].lies_on(inverse_per_m)) sum += samples[i].solid_sr;
  return sum * static_cast<double>(every);
}

/// The plane with most support among hypotheses at places of a fixed sequence.
std::optional<Vector3d> best_guess(const std::vector<PlaneSample>& samples, std::uint32_t& state) {
  constexpr std::size_t kEvery = 5;
  std::vector<const PlaneSample*> open;
  for (const PlaneSample& s : samples)
    if (!s.taken) open.push_back(&s);
  if (open.empty()) return {};
  std::optional<Vector3d> best;
  double best_sr = 0;
  for (int guess = 0; guess < kGuesses; ++guess) {
    state = state * 1664525U + 1013904223U;
    const PlaneSample& at = *open[(state >> 8) % open.size()];
    const Vector3d plane = at.normal / (at.distance_m * at.normal.dot(at.ray));
    if (!plane.allFinite()) continue;
    const double sr = support_sr(samples, plane, kEvery);
    if (sr > best_sr) best = plane, best_sr = sr;
  }
  return best;
}

/// How much of the way to the plane a pixel is moved, by the mean of what is around.
double share_to_plane(double mean_off_m, double sigma_m) {
  const double gate_m = std::max(kOnPlane_m, sigma_m);
  return std::clamp(2 - std::abs(mean_off_m) / gate_m, 0.0, 1.0);
}

class Straightener {
 public:
  Straightener(const std::vector<RoomPlane>& planes, const Panorama& before)
      : planes_(planes),
        before_(before),
        directions_(before.size()),
        nearest_(before.size(), kNoPlane),
        off_m_(before.size()) {}

  /// Nearest plane of each pixel of a row, and how far off it is.
  void find_row(int y) {
    for (int x = 0; x < before_.size().width; ++x) {
      if (before_.views.row(y)[x] == 0) continue;
      const Vector3d ray = directions_(x, y);
      const double distance_m = before_.distance_m.row(y)[x];
      double least_m = std::max(kPlaneGate_m, kPlaneSigmas * before_.sigma_m.row(y)[x]);
      for (std::size_t i = 0; i < planes_.size(); ++i) {
        const double there_m = planes_[i].distance_m(ray);
        if (there_m <= 0 || std::abs(distance_m - there_m) >= least_m) continue;
        least_m = std::abs(distance_m - there_m);
        nearest_.row(y)[x] = static_cast<std::uint8_t>(i);
        off_m_.row(y)[x] = static_cast<float>(distance_m - there_m);
      }
    }
  }

  /// Moves a row; pixels that stay on no plane lose it.
  void move_row(int y, Panorama& out, Image<std::uint8_t>& planes) const {
    for (int x = 0; x < before_.size().width; ++x) {
      if (nearest_.row(y)[x] == kNoPlane) continue;
      const auto mean_m = mean_off(x, y);
      if (!mean_m) continue;
      const double share = share_to_plane(*mean_m, before_.sigma_m.row(y)[x]);
      if (share <= 0) continue;
      out.distance_m.row(y)[x] -= static_cast<float>(share) * off_m_.row(y)[x];
      planes.row(y)[x] = nearest_.row(y)[x];
    }
  }

 private:
  /// Mean of the pixels of the same plane around, where they are most of those known.
  std::optional<double> mean_off(int x, int y) const {
    constexpr int kReach = 4;
    const Size size = before_.size();
    const int step_x = std::clamp(static_cast<int>(std::lround(1 / directions_.across(y))), 1, 24);
    double sum = 0;
    int same = 0, known = 0;
    for (int dy = -kReach; dy <= kReach; dy += 2)
      for (int dx = -kReach; dx <= kReach; dx += 2) {
        const int v = y + dy, u = (x + dx * step_x + 2 * size.width) % size.width;
        if (v < 0 || v >= size.height || before_.views.row(v)[u] == 0) continue;
        ++known;
        if (nearest_.row(v)[u] != nearest_.row(y)[x]) continue;
        ++same, sum += off_m_.row(v)[u];
      }
    if (2 * same <= known) return {};
    return sum / same;
  }

  const std::vector<RoomPlane>& planes_;
  const Panorama& before_;
  Directions directions_;
  Image<std::uint8_t> nearest_;
  Image<float> off_m_;
};

}  // namespace

std::vector<RoomPlane> find_planes(const Panorama& panorama) {
  std::vector<PlaneSample> samples = samples_of(panorama);
  std::vector<RoomPlane> planes;
  std::uint32_t state = 1;
  while (!samples.empty() && planes.size() < kRounds) {
    const auto guess = best_guess(samples, state);
    const auto plane = guess ? refined(samples, *guess) : std::nullopt;
    if (!plane) break;
    const double sr = support_sr(samples, *plane, 1);
    if (sr < kLeast_sr) break;
    planes.push_back({*plane, sr});
    for (PlaneSample& s : samples) s.taken |= s.lies_on(*plane);
  }
  std::sort(planes.begin(), planes.end(), [](const RoomPlane& a, const RoomPlane& b) {
    return a.solid_angle_sr > b.solid_angle_sr;
  });
  return planes;
}

Image<std::uint8_t> straighten(const std::vector<RoomPlane>& planes, Panorama& panorama,
                               Crew& crew) {
  constexpr int kStraightenGrain = 8;
  const Panorama before = panorama;
  Image<std::uint8_t> of_pixel(panorama.size(), kNoPlane);
  if (planes.empty()) return of_pixel;
  Straightener straightener(planes, before);
  const int rows = panorama.size().height;
  crew.rows(rows, kStraightenGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) straightener.find_row(y);
  });
  crew.rows(rows, kStraightenGrain, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) straightener.move_row(y, panorama, of_pixel);
  });
  return of_pixel;
}

}  // namespace mixrig::model
