// SPDX-License-Identifier: Apache-2.0
#include "host/calibrate/board/fit_corner.h"

#include <algorithm>
#include <cmath>

#include "host/math/estimation/decompositions.h"

namespace mixrig::calibration {
namespace {

using Eigen::Vector2d;

enum : int { kX, kY, kAngleA, kAngleB, kLogBlur, kGain, kOffset, kShadeX, kShadeY, kCount };
using Parameters = Eigen::Matrix<double, kCount, 1>;
using Normal = Eigen::Matrix<double, kCount, kCount>;

struct Window {
  ImageView<const std::uint8_t> image;
  Vector2d center;
  double radius_px;
};

struct Sums {
  Normal information = Normal::Zero();
  Parameters gradient = Parameters::Zero();
  double squares = 0, weight = 0;
};

/// One edge at a pixel: its profile and the derivative of the profile.
struct Edge {
  double value, slope;  // erf(u), d erf / d u
  double along, across;
};

Edge edge_at(const Vector2d& d, double angle, double scale) {
  const Vector2d direction(std::cos(angle), std::sin(angle));
  const double across = -direction.y() * d.x() + direction.x() * d.y();
  const double u = across * scale;
  return {std::erf(u), M_2_SQRTPI * std::exp(-u * u), direction.dot(d), across};
}

/// Weight of a pixel: 1 inside, falling to 0 over the last pixel of the radius.
double weight_at(double distance_px, double radius_px) {
  return std::clamp(radius_px - distance_px + 0.5, 0.0, 1.0);
}

Sums accumulate(const Window& window, const Parameters& v) {
  Sums sums;
  const double scale = std::exp(-v[kLogBlur]) / std::sqrt(2.0);
  const int x0 = static_cast<int>(std::floor(window.center.x() - window.radius_px)),
            x1 = static_cast<int>(std::ceil(window.center.x() + window.radius_px)),
            y0 = static_cast<int>(std::floor(window.center.y() - window.radius_px)),
            y1 = static_cast<int>(std::ceil(window.center.y() + window.radius_px));
  const Vector2d na(-std::sin(v[kAngleA]), std::cos(v[kAngleA]));
  const Vector2d nb(-std::sin(v[kAngleB]), std::cos(v[kAngleB]));
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x) {
      const Vector2d p(x, y);
      const double weight = weight_at((p - window.center).norm(), window.radius_px);
      if (weight <= 0) continue;
      const Vector2d d = p - v.head<2>();
      const Edge a = edge_at(d, v[kAngleA], scale), b = edge_at(d, v[kAngleB], scale);
      const double shade = 1 + v[kShadeX] * d.x() + v[kShadeY] * d.y();
      const double flat = v[kOffset] + v[kGain] * a.value * b.value;
      const double by_a = shade * v[kGain] * a.slope * b.value * scale;  // d I / d a.across
      const double by_b = shade * v[kGain] * b.slope * a.value * scale;
      Parameters j;
      j.head<2>() = -by_a * na - by_b * nb - flat * v.segment<2>(kShadeX);
      j[kAngleA] = -by_a * a.along;
      j[kAngleB] = -by_b * b.along;
      j[kLogBlur] = -by_a * a.across - by_b * b.across;
      j[kGain] = shade * a.value * b.value;
      j[kOffset] = shade;
      j[kShadeX] = flat * d.x();
      j[kShadeY] = flat * d.y();
      const double residual = shade * flat - window.image.at(x, y);
      sums.information.selfadjointView<Eigen::Lower>().rankUpdate(j, weight);
      sums.gradient += weight * residual * j;
      sums.squares += weight * residual * residual;
      sums.weight += weight;
    }
  sums.information = sums.information.selfadjointView<Eigen::Lower>();
  return sums;
}

/// Gain and offset from the window's own brightness, with the sign of the profile.
void start_brightness(const Window& window, Parameters& v) {
  v[kGain] = 1;
  v[kOffset] = 0;
  const Sums sums = accumulate(window, v);  // of residual s1 s2 - I, by gain and by offset
  Eigen::Matrix2d n = sums.information.block<2, 2>(kGain, kGain);
  const Vector2d wanted = n * Vector2d(1, 0) - sums.gradient.segment<2>(kGain);
  n.diagonal().array() += 1e-9;
  v.segment<2>(kGain) = n.ldlt().solve(wanted);
}

bool is_plausible(const Window& window, const Parameters& v) {
  constexpr double kMinSine = 0.2;
  const double blur = std::exp(v[kLogBlur]);
  return v.allFinite() && (v.head<2>() - window.center).norm() < 0.5 * window.radius_px &&
         blur > 0.1 && blur < window.radius_px &&
         std::abs(std::sin(v[kAngleA] - v[kAngleB])) > kMinSine;
}

/// Levenberg-Marquardt; true if it converged.
bool settle(const Window& window, Parameters& v, Sums& sums) {
  double damping = 1e-3;
  constexpr int kMaxSteps = 40;
  for (int step = 0; step < kMaxSteps; ++step) {
    Normal damped = sums.information;
    damped.diagonal() *= 1 + damping;
    damped.diagonal().array() += 1e-12;
    const Parameters delta = -estimation::SymmetricSolver(damped).solve(sums.gradient);
    const Parameters next = v + delta;
    if (!delta.allFinite()) return false;
    const Sums tried = is_plausible(window, next) ? accumulate(window, next) : Sums{};
    if (tried.weight > 0 && tried.squares <= sums.squares) {
      v = next;
      sums = tried;
      damping = std::max(damping * 0.2, 1e-9);
      if (delta.head<2>().norm() < 1e-5) return true;
    } else {
      damping *= 8;
      if (damping > 1e8) return delta.head<2>().norm() < 1e-3;
    }
  }
  return false;
}

}  // namespace

std::optional<CornerFit> fit_corner(ImageView<const std::uint8_t> image, const Vector2d& start_px,
                                    const Vector2d& edge_a, const Vector2d& edge_b,
                                    double radius_px) {
  constexpr double kMinRadius_px = 2.5, kMinContrast = 4, kMaxResidual = 0.25;
  if (!start_px.allFinite() || !(radius_px >= kMinRadius_px)) return std::nullopt;
  const double reach = radius_px + 1;
  if (start_px.x() < reach || start_px.y() < reach || start_px.x() > image.size.width - 1 - reach ||
      start_px.y() > image.size.height - 1 - reach)
    return std::nullopt;
  const Window window{image, start_px, radius_px};
  Parameters v = Parameters::Zero();
  v.head<2>() = start_px;
  v[kAngleA] = std::atan2(edge_a.y(), edge_a.x());
  v[kAngleB] = std::atan2(edge_b.y(), edge_b.x());
  if (!is_plausible(window, v)) return std::nullopt;
  start_brightness(window, v);
  Sums sums = accumulate(window, v);
  if (!settle(window, v, sums)) return std::nullopt;
  CornerFit fit;
  fit.px = v.head<2>();
  fit.blur_px = std::exp(v[kLogBlur]);
  fit.contrast = 2 * std::abs(v[kGain]);
  fit.residual = std::sqrt(sums.squares / sums.weight) / std::max(fit.contrast, 1e-9);
  if (fit.contrast < kMinContrast || fit.residual > kMaxResidual) return std::nullopt;
  const double variance =
      sums.squares /
      std::max(sums.weight - static_cast<double>(Parameters::SizeAtCompileTime), 1.0);
  const Eigen::Matrix2d covariance =
      variance *
      estimation::SymmetricSolver(sums.information).solve(Normal::Identity()).topLeftCorner<2, 2>();
  fit.sigma_px = std::sqrt(std::max(estimation::planar_spectrum_of(covariance).values[1], 0.0));
  return fit;
}

}  // namespace mixrig::calibration
