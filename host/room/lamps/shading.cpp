// SPDX-License-Identifier: Apache-2.0
#include "host/room/lamps/shading.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Geometry>

#include "hal/base/order_statistics.h"
#include "host/math/estimation/decompositions.h"
#include "host/room/lamps/lit_places.h"

namespace mixrig::lights {
namespace {

using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr int kLeastSamples = 60;
constexpr int kRoundsOfFit = 30;
constexpr double kTukey = 4.7;
constexpr double kMostSigma = 0.3;  ///< of the sum of the intensities

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

/// Sum over the parts of the sphere of g g^T, where g is the gradient of a part: errors that a part
/// shares, such as a patch of another colour, count once and not by its places (Liang and Zeger
/// 1986).
MatrixXd shared_gradients(const std::vector<LitPlace>& places, const std::vector<double>& measured,
                          const Fit& fit) {
  const Eigen::Index n = fit.light.size(), planes = fit.albedo.size();
  MatrixXd cross = MatrixXd::Zero(n, planes), of_part = MatrixXd::Zero(n, kLitParts);
  VectorXd own = VectorXd::Zero(planes), off = VectorXd::Zero(planes);
  const auto each = [&](const auto& use) {
    for (std::size_t i = 0; i < places.size(); ++i) {
      const LitPlace& p = places[i];
      const double light = fitted(fit, p), albedo = fit.albedo[p.plane];
      if (light > 0 && albedo > 0)
        use(p, fit.weight[i], VectorXd(p.gain.transpose() / light),
            measured[i] / (albedo * light) - 1);
    }
  };
  each([&](const LitPlace& p, double w, const VectorXd& row, double e) {
    cross.col(p.plane) += w * row, own[p.plane] += w, off[p.plane] += w * e;
  });
  each([&](const LitPlace& p, double w, const VectorXd& row, double e) {
    const double left = e - off[p.plane] / own[p.plane];
    of_part.col(p.part) += w * left * (row - cross.col(p.plane) / own[p.plane]);
  });
  return of_part * of_part.transpose();
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
  const MatrixXd inverse =
      spectrum.axes * spectrum.values.cwiseInverse().asDiagonal() * spectrum.axes.transpose();
  answer.covariance = relative * relative * inverse +
                      inverse * shared_gradients(places, brightness, all) * inverse / (sum * sum);
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
