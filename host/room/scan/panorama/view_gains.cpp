// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/panorama/view_gains.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include <Eigen/Cholesky>

#include "hal/base/order_statistics.h"
#include "hal/base/srgb.h"
#include "host/room/scan/panorama/view_eye.h"

namespace mixrig::model {
namespace {

using Eigen::Array3f;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kColumns = 320;    ///< places around the horizon
constexpr int kPatch_px = 2;     ///< to either side: what a place's colour is averaged over
constexpr int kSaturated = 250;  ///< of 255
constexpr float kDark = 0.004F;  ///< linear; noise would count
/// Largest standard deviation over mean; beyond it a hundredth of a degree would count.
constexpr float kTexture = 0.15F;
constexpr int kLeastPairs = 200;      ///< fewer do not determine a vignetting
constexpr int kHeldOut = 3;           ///< every third place is held out
constexpr int kGainRounds = 6;        ///< rounds of robust weights
constexpr double kLeastSigma = 5e-3;  ///< of a logarithm: half a step of sRGB in the dark
constexpr double kGainSigma = 0.3, kLensSigma = 0.5;  ///< priors of gains, and of a and b
constexpr double kWorthwhile = 0.95;                  ///< largest held-out error over that before
constexpr double kSigmaOfMedian = 1.4826;

/// Colour of a place in one view.
struct Sight {
  int view = 0;
  double r2 = 0;
  std::array<float, 3> log_color{};
};

/// Two views of one place.
struct Pair {
  Sight a, b;
  bool held_out = false;
};

/// Mean linear colour around a pixel; nothing where it is saturated, dark or textured.
std::optional<Array3f> even_color(const Image<Rgb8>& plate, const Vector2d& px) {
  const int x0 = static_cast<int>(std::lround(px.x())), y0 = static_cast<int>(std::lround(px.y()));
  if (x0 < kPatch_px || y0 < kPatch_px || x0 + kPatch_px >= plate.width() ||
      y0 + kPatch_px >= plate.height())
    return {};
  const auto& linear = linear_of_srgb_bytes();
  Array3f sum = Array3f::Zero(), square = Array3f::Zero();
  for (int y = y0 - kPatch_px; y <= y0 + kPatch_px; ++y)
    for (int x = x0 - kPatch_px; x <= x0 + kPatch_px; ++x) {
      const Rgb8 c = plate.row(y)[x];
      if (std::max({c.r, c.g, c.b}) >= kSaturated) return {};
      const Array3f light(linear[c.r], linear[c.g], linear[c.b]);
      sum += light, square += light * light;
    }
  constexpr float kCount = (2 * kPatch_px + 1) * (2 * kPatch_px + 1);
  const Array3f mean = sum / kCount;
  if (mean.minCoeff() < kDark) return {};
  if ((square / kCount - mean.square() > kTexture * kTexture * mean.square()).any()) return {};
  return mean;
}

class PairFinder {
 public:
  PairFinder(std::span<const ScanView> views, const geometry::CameraModel& tof,
             const geometry::CameraModel& target, const Panorama& panorama)
      : target_(target), panorama_(panorama) {
    for (const ScanView& view : views) eyes_.emplace_back(view, tof, target);
  }

  /// Pairs of neighbours among the views that see a place: as many as views, less one.
  void row(int y, int step, std::vector<Pair>& to) const {
    for (int x = step / 2; x < panorama_.size().width; x += step) {
      if (panorama_.views.row(y)[x] < 2) continue;
      const Vector3d point_m =
          panorama_.distance_m.row(y)[x] * direction_of(panorama_.size(), x, y);
      std::optional<Sight> last;
      for (std::size_t i = 0; i < eyes_.size(); ++i) {
        const auto sight = see(i, point_m);
        if (!sight) continue;
        if (last) to.push_back({*last, *sight, (x / step + y / step) % kHeldOut == 0});
        last = sight;
      }
    }
  }

 private:
  std::optional<Sight> see(std::size_t view, const Vector3d& point_m) const {
    const auto px = eyes_[view].pixel(point_m);
    if (!px || eyes_[view].visible(point_m) < 1) return {};
    const auto color = even_color(eyes_[view].plate(), *px);
    if (!color) return {};
    Sight sight{static_cast<int>(view), geometry::Vignetting::radius2(target_.pinhole, *px), {}};
    for (std::size_t c = 0; c < 3; ++c)
      sight.log_color[c] = std::log((*color)[static_cast<int>(c)]);
    return sight;
  }

  const geometry::CameraModel& target_;
  const Panorama& panorama_;
  std::vector<ViewEye> eyes_;
};

std::vector<Pair> find_pairs(const PairFinder& finder, Size size, Crew& crew) {
  const int step = std::max(1, size.width / kColumns), rows = size.height / step;
  std::vector<std::vector<Pair>> of_row(static_cast<std::size_t>(rows));
  crew.rows(rows, 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i)
      finder.row(i * step + step / 2, step, of_row[static_cast<std::size_t>(i)]);
  });
  std::vector<Pair> pairs;
  for (const auto& row : of_row) pairs.insert(pairs.end(), row.begin(), row.end());
  return pairs;
}

/// Logarithms: three for each view, then a and b of the lens.
class GainFit {
 public:
  explicit GainFit(int views) : views_(views), logs_(Eigen::VectorXd::Zero(3 * views + 2)) {}

  double residual(const Pair& pair, int channel) const {
    const auto of = [&](const Sight& s) {
      return s.log_color[static_cast<std::size_t>(channel)] + logs_[3 * s.view + channel] +
             s.r2 * (logs_[lens()] + s.r2 * logs_[lens() + 1]);
    };
    return of(pair.a) - of(pair.b);
  }

  /// Robust standard deviation of the residuals of one of the two sets.
  double sigma(std::span<const Pair> pairs, bool held_out) const {
    std::vector<double> sizes;
    for (const Pair& pair : pairs)
      if (pair.held_out == held_out)
        for (int c = 0; c < 3; ++c) sizes.push_back(std::abs(residual(pair, c)));
    return sizes.empty() ? 0 : kSigmaOfMedian * upper_median_in_place(std::span(sizes));
  }

  /// One step of iterated least squares with weights of Cauchy.
  void step(std::span<const Pair> pairs) {
    const double sigma_2 = std::pow(std::max(sigma(pairs, false), kLeastSigma), 2);
    const auto n = logs_.size();
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(n, n);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
    for (int i = 0; i < n; ++i) {
      const double prior = 1 / std::pow(i < lens() ? kGainSigma : kLensSigma, 2);
      normal(i, i) = prior, right[i] = -prior * logs_[i];
    }
    for (const Pair& pair : pairs)
      if (!pair.held_out)
        for (int c = 0; c < 3; ++c) {
          const double r = residual(pair, c);
          add(pair, c, r, 1 / (sigma_2 + r * r), normal, right);
        }
    logs_ += normal.selfadjointView<Eigen::Upper>().ldlt().solve(right);
  }

  ViewGains gains() const {
    ViewGains found;
    const double mean = logs_.head(lens()).mean();
    for (int i = 0; i < views_; ++i)
      found.gains.push_back((logs_.segment<3>(3 * i).array() - mean).exp().cast<float>());
    found.vignetting = {logs_[lens()], logs_[lens() + 1]};
    return found;
  }

 private:
  int lens() const { return 3 * views_; }

  void add(const Pair& pair, int channel, double r, double weight, Eigen::MatrixXd& normal,
           Eigen::VectorXd& right) const {
    const std::array<int, 4> at{3 * pair.a.view + channel, 3 * pair.b.view + channel, lens(),
                                lens() + 1};
    const std::array<double, 4> by{1, -1, pair.a.r2 - pair.b.r2,
                                   pair.a.r2 * pair.a.r2 - pair.b.r2 * pair.b.r2};
    for (std::size_t i = 0; i < at.size(); ++i) {
      right[at[i]] -= weight * by[i] * r;
      for (std::size_t j = 0; j < at.size(); ++j)
        if (at[i] <= at[j]) normal(at[i], at[j]) += weight * by[i] * by[j];
    }
  }

  int views_;
  Eigen::VectorXd logs_;
};

}  // namespace

ViewGains find_gains(std::span<const ScanView> views, const geometry::CameraModel& tof,
                     const geometry::CameraModel& target, const Panorama& panorama, Crew& crew) {
  const std::vector<Pair> pairs =
      find_pairs(PairFinder(views, tof, target, panorama), panorama.size(), crew);
  ViewGains none;
  none.samples = static_cast<int>(
      std::count_if(pairs.begin(), pairs.end(), [](const Pair& p) { return p.held_out; }));
  if (static_cast<int>(pairs.size()) < kLeastPairs || none.samples == 0) return none;
  GainFit fit(static_cast<int>(views.size()));
  const double before = fit.sigma(pairs, true);
  for (int i = 0; i < kGainRounds; ++i) fit.step(pairs);
  const double after = fit.sigma(pairs, true);
  none.before_pct = none.after_pct = 100 * before;
  if (after >= kWorthwhile * before) return none;
  ViewGains found = fit.gains();
  found.samples = none.samples, found.before_pct = 100 * before, found.after_pct = 100 * after;
  return found;
}

}  // namespace mixrig::model
