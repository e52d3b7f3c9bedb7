// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/shading.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "hal/base/angles.h"
#include "hal/base/order_statistics.h"
#include "hal/base/srgb.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/geometry/lamp.h"

namespace mixrig::lights {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kDarkest = 8, kBrightest = 248;  ///< grey levels that are measured
constexpr double kOnPlane_m = 0.015, kOnPlaneSigmas = 2.5, kSameNormal = 0.94;
constexpr int kLeastSamples = 60, kLeastOfPlane = 30;
constexpr int kRoundsOfFit = 30;
constexpr double kTukey = 4.7;
constexpr int kPanelSide = 3;
constexpr double kMostSigma = 0.3;  ///< of the sum of the intensities

/// A place on a large plane.
struct LitPlace {
  int plane = 0;
  Vector3d linear;          ///< measured light
  Eigen::RowVectorXd gain;  ///< of each lamp's intensity, then 1 for the ambient light
};

/// Calls use(point) for the points of a panel as lamps, or for a lamp without direction itself.
template <typename Use>
void each_panel_point(const geometry::Lamp& lamp, const Use& use) {
  if (!lamp.direction) {
    use(lamp);
    return;
  }
  const geometry::PanelAxes axes = geometry::panel_axes(*lamp.direction);
  geometry::Lamp point = lamp;
  for (int i = 0; i < kPanelSide; ++i)
    for (int j = 0; j < kPanelSide; ++j) {
      const double u = (i + 0.5) / kPanelSide - 0.5, v = (j + 0.5) / kPanelSide - 0.5;
      point.position_m =
          lamp.position_m + u * lamp.size_m.x() * axes.u + v * lamp.size_m.y() * axes.v;
      use(point);
    }
}

/// Irradiance of a lamp like irradiance_of(), with occlusion of the panel by the room.
double seen_irradiance(const RoomSurfaces& room, const geometry::Lamp& lamp,
                       const Vector3d& position_m, const Vector3d& normal) {
  const Vector3d start = position_m + 0.01 * normal;
  double sum = 0;
  int count = 0;
  each_panel_point(lamp, [&](const geometry::Lamp& point) {
    ++count;
    const double light = geometry::irradiance(point, position_m, normal);
    if (light > 0 && room.open(start, point.position_m)) sum += light;
  });
  return sum / count;
}

/// The plane of a surface point: its index, or -1.
int plane_of(const RoomSurfaces& room, const SurfacePoint& point) {
  const geometry::Pose base_from_world = geometry::inverse(room.world_from_base());
  const Vector3d p = base_from_world * point.position_m;
  const Vector3d normal = base_from_world.rotation * point.normal;
  const double gate_m = std::max(kOnPlane_m, kOnPlaneSigmas * point.sigma_m);
  for (std::size_t i = 0; i < room.planes().size(); ++i) {
    const Vector3d& inverse = room.planes()[i].inverse_per_m;
    const double off_m = (inverse.dot(p) - 1) / inverse.norm();
    if (std::abs(off_m) < gate_m && -normal.dot(inverse.normalized()) > kSameNormal)
      return static_cast<int>(i);
  }
  return -1;
}

std::optional<Vector3d> color_at(const model::Panorama& p, int x, int y) {
  const int factor = p.color.width() / p.distance_m.width();
  Vector3d sum = Vector3d::Zero();
  for (int j = 0; j < factor; ++j)
    for (int i = 0; i < factor; ++i) {
      const Rgb8 c = p.color.at(factor * x + i, factor * y + j);
      if (std::max({c.r, c.g, c.b}) > kBrightest || std::min({c.r, c.g, c.b}) < kDarkest) return {};
      const auto& linear = linear_of_srgb_bytes();
      sum += Vector3d(linear[c.r], linear[c.g], linear[c.b]);
    }
  return sum / (factor * factor);
}

std::vector<LitPlace> lit_places(const RoomSurfaces& room, std::span<const FoundLamp> lamps,
                                 int most) {
  const model::Panorama& p = room.panorama();
  const Size size = p.size();
  // Evenly over the sphere, some of them on planes.
  const double step_rad = std::sqrt(4 * kPi / (2.0 * most));
  std::vector<LitPlace> places;
  const auto lamp_count = static_cast<Eigen::Index>(lamps.size());
  for (double elevation = -kPi / 2 + step_rad; elevation < kPi / 2; elevation += step_rad) {
    const double across = std::cos(elevation);
    const int columns = std::max(1, static_cast<int>(2 * kPi * across / step_rad));
    const int y =
        std::clamp(static_cast<int>((kPi / 2 - elevation) / kPi * size.height), 0, size.height - 1);
    for (int k = 0; k < columns; ++k) {
      const int x = static_cast<int>((k + 0.5) / columns * size.width);
      const auto point = p.views.at(x, y) > 0 ? room.at(x, y) : std::nullopt;
      const int plane = point ? plane_of(room, *point) : -1;
      const auto color = plane >= 0 ? color_at(p, x, y) : std::nullopt;
      if (!color) continue;
      LitPlace place{plane, *color, Eigen::RowVectorXd::Ones(lamp_count + 1)};
      const Vector3d normal =
          -(room.world_from_base().rotation *
            room.planes()[static_cast<std::size_t>(plane)].inverse_per_m.normalized());
      for (Eigen::Index l = 0; l < lamp_count; ++l)
        place.gain[l] =
            seen_irradiance(room, lamps[static_cast<std::size_t>(l)], point->position_m, normal);
      places.push_back(std::move(place));
    }
  }
  return places;
}

/// Leaves out planes with few places, and numbers the others anew. Returns their count.
int keep_large_planes(std::vector<LitPlace>& places) {
  std::vector<int> count(256), number(256, -1);
  for (const LitPlace& p : places) ++count[static_cast<std::size_t>(p.plane)];
  int planes = 0;
  for (std::size_t i = 0; i < count.size(); ++i)
    if (count[i] >= kLeastOfPlane) number[i] = planes++;
  std::erase_if(places, [&](LitPlace& p) {
    p.plane = number[static_cast<std::size_t>(p.plane)];
    return p.plane < 0;
  });
  return planes;
}

/// Minimises x^T a x / 2 - b^T x over x >= 0, by coordinates.
VectorXd not_negative(const MatrixXd& a, const VectorXd& b, VectorXd x) {
  for (int round = 0; round < 300; ++round)
    for (Eigen::Index j = 0; j < x.size(); ++j)
      if (a(j, j) > 0) x[j] = std::max(0.0, x[j] + (b[j] - a.row(j).dot(x)) / a(j, j));
  return x;
}

/// One channel of the light, and the planes' albedos.
struct Fit {
  VectorXd light;   ///< intensities, then ambient
  VectorXd albedo;  ///< of the planes
  std::vector<double> weight;
  double spread = 0.1;  ///< of measured over fitted, share
};

double fitted(const Fit& fit, const LitPlace& p) { return p.gain.dot(fit.light); }

void solve_albedos(const std::vector<LitPlace>& places, const std::vector<double>& measured,
                   Fit& fit) {
  // The weighted median of the ratios: half of a plane may be another colour.
  std::vector<std::vector<double>> ratios(static_cast<std::size_t>(fit.albedo.size()));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double light = fitted(fit, places[i]);
    if (light > 0) ratios[static_cast<std::size_t>(places[i].plane)].push_back(measured[i] / light);
  }
  for (std::size_t k = 0; k < ratios.size(); ++k)
    if (!ratios[k].empty())
      fit.albedo[static_cast<Eigen::Index>(k)] = upper_median(std::move(ratios[k]));
}

void weigh(const std::vector<LitPlace>& places, const std::vector<double>& measured, Fit& fit) {
  std::vector<double> off(places.size()), size(places.size());
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double expected = fit.albedo[places[i].plane] * fitted(fit, places[i]);
    off[i] = expected > 0 ? measured[i] / expected - 1 : 1;
    size[i] = std::abs(off[i]);
  }
  fit.spread = std::max(0.01, 1.4826 * upper_median(std::move(size)));
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double u = off[i] / (kTukey * fit.spread);
    fit.weight[i] = std::abs(u) < 1 ? std::pow(1 - u * u, 2) : 0;
  }
}

/// Normal equations of the light for relative residuals, the albedos eliminated: a plane's own
/// scale is no evidence.
void light_equations(const std::vector<LitPlace>& places, const std::vector<double>& measured,
                     const Fit& fit, MatrixXd& a, VectorXd& b) {
  const Eigen::Index n = fit.light.size(), planes = fit.albedo.size();
  a.setZero(n, n), b.setZero(n);
  MatrixXd cross = MatrixXd::Zero(n, planes);
  VectorXd own = VectorXd::Zero(planes), off = VectorXd::Zero(planes);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const LitPlace& p = places[i];
    const double light = fitted(fit, p), albedo = fit.albedo[p.plane];
    if (!(light > 0) || !(albedo > 0)) continue;
    // measured / albedo = light, relative to the light of the round before.
    const double w = fit.weight[i];
    const VectorXd row = p.gain.transpose() / light;
    const double target = measured[i] / (albedo * light);
    a += w * row * row.transpose(), b += w * target * row;
    // The albedo's own change d: light (1 + d).
    cross.col(p.plane) += w * row, own[p.plane] += w, off[p.plane] += w * (target - 1);
  }
  for (Eigen::Index k = 0; k < planes; ++k)
    if (own[k] > 0) {
      a -= cross.col(k) * cross.col(k).transpose() / own[k];
      // b - A x at x = light has the albedos' residual taken out; in terms of x:
      b -= cross.col(k) * (off[k] + cross.col(k).dot(fit.light)) / own[k];
    }
}

/// Fixes the scale, which the data do not determine, by the sum of the intensities.
void hold_scale(const Fit& fit, MatrixXd& a, VectorXd& b) {
  const double sum = fit.light.head(fit.light.size() - 1).sum();
  const double strength = std::max(1e-9, a.diagonal().maxCoeff());
  VectorXd ones = VectorXd::Ones(fit.light.size());
  ones[ones.size() - 1] = 0;
  a += strength * ones * ones.transpose();
  b += strength * sum * ones;
}

Fit fit_channel(const std::vector<LitPlace>& places, const std::vector<double>& measured,
                int planes, Eigen::Index lamps) {
  Fit fit;
  fit.light = VectorXd::Constant(lamps + 1, 1.0);
  fit.light[lamps] = 0.2;
  fit.albedo = VectorXd::Constant(planes, 0.5);
  fit.weight.assign(places.size(), 1);
  MatrixXd a;
  VectorXd b;
  for (int round = 0; round < kRoundsOfFit; ++round) {
    solve_albedos(places, measured, fit);
    weigh(places, measured, fit);
    light_equations(places, measured, fit, a, b);
    hold_scale(fit, a, b);
    fit.light = not_negative(a, b, fit.light);
  }
  solve_albedos(places, measured, fit);
  return fit;
}

std::vector<double> channel_of(const std::vector<LitPlace>& places, const Vector3d& mix) {
  std::vector<double> values;
  for (const LitPlace& p : places) values.push_back(std::max(1e-6, mix.dot(p.linear)));
  return values;
}

}  // namespace

double irradiance_of(const geometry::Lamp& lamp, const Vector3d& position_m,
                     const Vector3d& normal) {
  double sum = 0;
  int count = 0;
  each_panel_point(lamp, [&](const geometry::Lamp& point) {
    sum += geometry::irradiance(point, position_m, normal), ++count;
  });
  return sum / count;
}

estimation::Estimate<RoomLight> measure_light(const RoomSurfaces& room,
                                              std::span<const FoundLamp> lamps,
                                              const ShadingOptions& options) {
  using Answer = estimation::Estimate<RoomLight>;
  if (lamps.empty()) return Answer::degenerate("no lamp");
  std::vector<LitPlace> places = lit_places(room, lamps, options.most_samples);
  const int planes = keep_large_planes(places);
  if (static_cast<int>(places.size()) < kLeastSamples)
    return Answer::degenerate("too few places on planes show how they are lit");
  const auto n = static_cast<Eigen::Index>(lamps.size());
  const Vector3d luminance(kRec709Red, kRec709Green, kRec709Blue);
  const auto brightness = channel_of(places, luminance);
  const Fit all = fit_channel(places, brightness, planes, n);
  const double sum = all.light.head(n).sum();
  if (!(sum > 0)) return Answer::degenerate("no lamp lights the planes");

  MatrixXd a;
  VectorXd b;
  light_equations(places, brightness, all, a, b);
  hold_scale(all, a, b);
  Answer answer;
  const estimation::DenseSpectrum spectrum = estimation::dense_spectrum_of(a);
  const double relative = all.spread / sum;
  if (!(spectrum.values[0] > std::pow(relative / kMostSigma, 2)))
    return Answer::degenerate("the lamps light the planes alike, or hardly at all");
  answer.covariance = relative * relative * spectrum.axes *
                      spectrum.values.cwiseInverse().asDiagonal() * spectrum.axes.transpose();
  RoomLight& light = answer.value;
  light.samples = static_cast<int>(places.size()), light.planes = planes;
  light.residual = all.spread;
  // The planes' mean albedo sets the scale that pictures do not tell.
  const double scale = all.albedo.mean() / (options.mean_albedo * options.exposure);
  light.intensity.assign(lamps.size(), Eigen::Vector3f::Zero());
  for (int c = 0; c < 3; ++c) {
    const Fit one = fit_channel(places, channel_of(places, Vector3d::Unit(c)), planes, n);
    const double white = sum / std::max(1e-9, one.light.head(n).sum());
    for (Eigen::Index l = 0; l < n; ++l)
      light.intensity[static_cast<std::size_t>(l)][c] =
          static_cast<float>(scale * white * one.light[l]);
    light.ambient[c] = static_cast<float>(scale * white * one.light[n]);
  }
  light.largest_share.assign(lamps.size(), 0);
  for (const LitPlace& p : places)
    for (Eigen::Index l = 0; l < n; ++l) {
      double& share = light.largest_share[static_cast<std::size_t>(l)];
      share = std::max(share, all.light[l] * p.gain[l] / std::max(1e-9, fitted(all, p)));
    }
  answer.verdict = estimation::Verdict::ok();
  return answer;
}

}  // namespace mixrig::lights
