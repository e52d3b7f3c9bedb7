// SPDX-License-Identifier: Apache-2.0
#include "host/pose/source/smooth_poses.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include <Eigen/Dense>

namespace mixrig::pose {
namespace {

constexpr int kMost = static_cast<int>(kMostSmoothed);
using Column = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMost, 1>;
using Square = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, kMost>;
using Terms = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMost, 3>;
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 3, 3>;
using SmallColumn = Eigen::Matrix<double, Eigen::Dynamic, 1, 0, 3, 1>;

/// Spectral densities of the jerk of a rotation, rad^2/s^5.
constexpr std::array<double, 4> kJerks{1e-3, 1e-1, 1e1, 1e3};
/// Ratio of the densities of positions, m^2/s^5, to those of rotations.
constexpr double kOfPlaces = 0.25;

/// Returns the covariance, between two times, of white noise that is integrated three times from 0.
double integrated(double a_s, double b_s) {
  const double t = std::min(a_s, b_s), d = std::abs(a_s - b_s);
  return t * t * t * (t * t / 20 + d * t / 8 + d * d / 12);
}

struct Estimate {
  double value = 0, variance = 0;
  double log_likelihood = 0;  ///< restricted likelihood: of the part that no parabola explains
};

/// One coordinate at all times. Values that depend only on the times are shared by all strengths of
/// the jerk.
class Spline {
 public:
  Spline(std::span<const MeasuredPose> around, double time_s) {
    const auto n = static_cast<Eigen::Index>(around.size());
    const Eigen::Index terms = std::min<Eigen::Index>(3, n);
    const double begin_s = std::min(around.front().time_s, time_s), at_s = time_s - begin_s;
    terms_.resize(n, terms), prior_.resize(n, n), to_time_.resize(n);
    for (Eigen::Index i = 0; i < n; ++i) {
      const double own_s = around[static_cast<std::size_t>(i)].time_s;
      for (Eigen::Index k = 0; k < terms; ++k)
        terms_(i, k) = std::pow(own_s - time_s, static_cast<double>(k));
      to_time_(i) = integrated(own_s - begin_s, at_s);
      for (Eigen::Index j = 0; j <= i; ++j)
        prior_(i, j) = prior_(j, i) =
            integrated(own_s - begin_s, around[static_cast<std::size_t>(j)].time_s - begin_s);
    }
    at_time_ = integrated(at_s, at_s);
  }

  Estimate at(const Column& values, const Column& variances, double jerk) const {
    Square together = jerk * prior_;
    together.diagonal() += variances;
    const Eigen::LLT<Square> inverse(together);
    const Terms terms = inverse.solve(terms_);
    const Small normal = terms_.transpose() * terms;
    const Eigen::LLT<Small> inverse_normal(normal);
    const SmallColumn parabola = inverse_normal.solve(terms.transpose() * values);
    const Column rest = values - terms_ * parabola;
    const Column weighted = inverse.solve(rest);
    const Column gain = inverse.solve(jerk * to_time_);
    SmallColumn left = -terms_.transpose() * gain;
    left(0) += 1;
    Estimate e;
    e.value = parabola(0) + jerk * to_time_.dot(weighted);
    e.variance = std::max(
        0.0, jerk * (at_time_ - to_time_.dot(gain)) + left.dot(inverse_normal.solve(left)));
    e.log_likelihood = -0.5 * rest.dot(weighted) -
                       inverse.matrixLLT().diagonal().array().log().sum() -
                       inverse_normal.matrixLLT().diagonal().array().log().sum();
    return e;
  }

 private:
  Terms terms_;     ///< powers of the time from `time_s`
  Square prior_;    ///< prior covariance for a jerk of 1
  Column to_time_;  ///< prior covariance between the poses and `time_s`
  double at_time_;  ///< prior variance at `time_s`
};

/// Returns the mean over the strengths of the jerk, weighted by their likelihoods.
Estimate mean_of(const Spline& spline, const Column& values, const Column& variances,
                 double of_rotations) {
  std::array<Estimate, kJerks.size()> all;
  double best = -std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < all.size(); ++k) {
    all[k] = spline.at(values, variances, of_rotations * kJerks[k]);
    best = std::max(best, all[k].log_likelihood);
  }
  double sum = 0;
  Estimate mean;
  for (const Estimate& e : all) {
    const double share = std::exp(e.log_likelihood - best);
    sum += share, mean.value += share * e.value, mean.variance += share * e.variance;
  }
  mean.value /= sum, mean.variance /= sum;
  return mean;
}

Eigen::Vector3d rotation_vector(const Eigen::Quaterniond& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

}  // namespace

MeasuredPose smooth_at(std::span<const MeasuredPose> around, double time_s) {
  assert(!around.empty() && around.size() <= kMostSmoothed);
  const auto& nearest =
      *std::min_element(around.begin(), around.end(), [&](const auto& a, const auto& b) {
        return std::abs(a.time_s - time_s) < std::abs(b.time_s - time_s);
      });
  const Spline spline(around, time_s);
  const auto n = static_cast<Eigen::Index>(around.size());
  Eigen::Matrix<double, 6, Eigen::Dynamic, 0, 6, kMost> values(6, n), variances(6, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    const MeasuredPose& m = around[static_cast<std::size_t>(i)];
    values.col(i).head<3>() =
        rotation_vector(m.room_from_body.rotation * nearest.room_from_body.rotation.conjugate());
    values.col(i).tail<3>() = m.room_from_body.translation_m - nearest.room_from_body.translation_m;
    constexpr double kLeast = 1e-14;
    variances.col(i) = m.covariance.diagonal().cwiseMax(kLeast);
  }
  MeasuredPose out{time_s, nearest.room_from_body, nearest.covariance};
  Eigen::Matrix<double, 6, 1> step;
  for (int c = 0; c < 6; ++c) {
    const Estimate e = mean_of(spline, values.row(c).transpose(), variances.row(c).transpose(),
                               c < 3 ? 1 : kOfPlaces);
    step(c) = e.value;
    out.covariance(c, c) = std::max(out.covariance(c, c), e.variance);
  }
  const double angle = step.head<3>().norm();
  if (angle > 0)
    out.room_from_body.rotation =
        (Eigen::Quaterniond(Eigen::AngleAxisd(angle, step.head<3>() / angle)) *
         out.room_from_body.rotation)
            .normalized();
  out.room_from_body.translation_m += step.tail<3>();
  return out;
}

}  // namespace mixrig::pose
