// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/panorama/view_alignment.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>

#include "hal/base/angles.h"
#include "hal/base/order_statistics.h"
#include "host/math/estimation/decompositions.h"
#include "host/math/estimation/verdict.h"
#include "host/room/scan/panorama/view_detail.h"

namespace mixrig::model {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kMostMedianTurn_rad = 0.5 * kDeg;  ///< of a unit whose depth camera is right
constexpr int kPointsOfView = 3000;                 ///< at most, on a grid
constexpr std::size_t kSamplesOfView = 6000;        ///< at most: points that other views see
constexpr int kBlock_px = 16;                       ///< side of blocks that are held out whole
constexpr int kNormal_px = 4;                       ///< reach of a surface's normal
constexpr double kOther_m = 0.15;                   ///< a point farther off is another surface
constexpr double kColorNoise = 2;                   ///< bytes of sRGB
constexpr double kColorShift_px = 0.4;              ///< of a level: what resampling may shift
constexpr double kDepthFloor_m = 1e-3;
constexpr double kCauchy = 2;                   ///< sigmas at which a residual weighs half
constexpr double kUnitSigma_rad = 0.02 * kDeg;  ///< of the prior on turns
constexpr int kFinest = 2;                      ///< pixels of the plate a pixel of the last level
constexpr int kStepsOfLevel = 4;
constexpr double kLeastGain = 0.05;  ///< least share by which a turn lowers the held-out error

/// Unit ray of a pixel; zero where the lens has none.
struct UnitRay {
  float x = 0, y = 0, z = 0;
  Vector3d at(float distance_m) const { return distance_m * Vector3d(x, y, z); }
};

/// A point that one view measured and another one may see.
struct AlignSample {
  std::size_t from = 0, to = 0;
  bool held_out = false;
  Vector3d point_m;  ///< in base axes by the angles of `from`
  double sigma_m = 0;
  std::optional<Vector2d> plate_px;  ///< in the plate of `from`
};

/// A view at its turn.
struct Posed {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  geometry::Pose tof_from_base, target_from_base;
};

/// `jacobian`: change of the value by a turn of `from`, and minus that by a turn of `to`.
struct Difference {
  double value = 0, sigma = 1;
  Vector3d jacobian = Vector3d::Zero();

  double squared() const { return value * value / (sigma * sigma); }
  double weight() const { return 1 / (sigma * sigma * (1 + squared() / (kCauchy * kCauchy))); }
  double cost() const { return std::log1p(squared() / (kCauchy * kCauchy)); }
};

/// Normal equations of pairs of views: only the difference of two turns is seen.
struct PairSum {
  Eigen::Matrix3d squares = Eigen::Matrix3d::Zero();
  Vector3d gradient = Vector3d::Zero();
  void add(const Difference& d) {
    squares += d.weight() * d.jacobian * d.jacobian.transpose();
    gradient += d.weight() * d.value * d.jacobian;
  }
};

struct HeldOut {
  double cost = 0;
  std::vector<float> distances_m;
};

class Aligner {
 public:
  Aligner(std::span<const ScanView> views, const geometry::CameraModel& tof,
          const geometry::CameraModel& target, Crew& crew)
      : views_(views),
        tof_(tof),
        target_(target),
        crew_(crew),
        turns_(views.size(), Vector3d::Zero()) {
    make_rays();
    pose_views();
    find_samples();
  }

  void estimate() {
    constexpr double kReach_rad = 0.0175, kReach_px = 1.5;  // a turn that the first level catches
    int factor = kFinest;
    while (target_.pinhole.fx_px * kReach_rad > kReach_px * factor) factor *= 2;
    for (; factor >= kFinest; factor /= 2) {
      set_level(factor);
      for (int step = 0; step < kStepsOfLevel; ++step) improve();
    }
  }

  /// Held-out errors of each view in overlaps with any other, at the current turns.
  std::vector<HeldOut> held_out() {
    std::vector<HeldOut> out(views_.size());
    for (std::size_t view = 0; view < views_.size(); ++view)
      for (const AlignSample& sample : samples_[view]) {
        if (!sample.held_out) continue;
        const auto depth = distance(sample);
        if (!depth) continue;
        double cost = depth->cost();
        if (const auto color = color_difference(sample)) cost += color->cost();
        for (const std::size_t of : {sample.from, sample.to}) {
          out[of].cost += cost;
          out[of].distances_m.push_back(static_cast<float>(std::abs(depth->value)));
        }
      }
    return out;
  }

  const std::vector<Vector3d>& turns_rad() const { return turns_; }
  void set_turns(std::vector<Vector3d> turns) {
    turns_ = std::move(turns);
    pose_views();
  }
  void set_level(int factor) {
    level_ = factor;
    details_.resize(views_.size());
    crew_.rows(static_cast<int>(views_.size()), 1, [&](int begin, int end) {
      for (int i = begin; i < end; ++i) {
        const auto view = static_cast<std::size_t>(i);
        details_[view] = detail_of(views_[view].plate.view(), factor);
      }
    });
  }

 private:
  void make_rays();
  void pose_views();
  void find_samples();
  void find_samples_of(std::size_t view);
  void improve();
  std::optional<Difference> distance(const AlignSample& sample) const;
  std::optional<Difference> color_difference(const AlignSample& sample) const;

  std::span<const ScanView> views_;
  const geometry::CameraModel& tof_;
  const geometry::CameraModel& target_;
  Crew& crew_;
  Image<UnitRay> rays_;  ///< of the ToF pixels
  std::vector<Vector3d> turns_;
  std::vector<Posed> posed_;
  std::vector<std::vector<AlignSample>> samples_;  ///< by the view that measured
  std::vector<Image<float>> details_;              ///< of the plates at level_
  int level_ = 1;
};

void Aligner::make_rays() {
  rays_.reset(tof_.size_px());
  for (int y = 0; y < rays_.height(); ++y)
    for (int x = 0; x < rays_.width(); ++x)
      if (const auto ray = tof_.unproject({x, y})) {
        const Eigen::Vector3f unit = Vector3d(ray->x(), ray->y(), 1).normalized().cast<float>();
        rays_.row(y)[x] = {unit.x(), unit.y(), unit.z()};
      }
}

void Aligner::pose_views() {
  posed_.resize(views_.size());
  for (std::size_t i = 0; i < views_.size(); ++i) {
    const Eigen::Quaterniond q = estimation::rotation_exp(turns_[i]);
    const geometry::Pose turned{q, Vector3d::Zero()};
    posed_[i] = {q.toRotationMatrix(), geometry::inverse(turned * views_[i].base_from_tof),
                 geometry::inverse(turned * views_[i].base_from_target)};
  }
}

void Aligner::find_samples() {
  samples_.resize(views_.size());
  crew_.rows(static_cast<int>(views_.size()), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) find_samples_of(static_cast<std::size_t>(i));
  });
}

/// Whether all pixels within `reach` of a place are in the picture.
bool is_inside(Size size, const Vector2d& px, int reach) {
  return px.x() >= reach && px.y() >= reach && px.x() <= size.width - 1 - reach &&
         px.y() <= size.height - 1 - reach;
}

/// Keeps at most kSamplesOfView samples, evenly spaced.
void thin_out(std::vector<AlignSample>& samples) {
  const std::size_t every = samples.size() / kSamplesOfView + 1;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < samples.size(); i += every) samples[kept++] = samples[i];
  samples.resize(kept);
}

void Aligner::find_samples_of(std::size_t from) {
  const ScanView& view = views_[from];
  const Size size = tof_.size_px();
  const int step = std::max(
      1, static_cast<int>(std::ceil(std::sqrt(static_cast<double>(size.area()) / kPointsOfView))));
  for (int y = step / 2; y < size.height; y += step)
    for (int x = step / 2; x < size.width; x += step) {
      const float distance_m = view.distance_m.row(y)[x];
      if (distance_m <= 0 || rays_.row(y)[x].z <= 0) continue;
      AlignSample sample{
          .from = from, .point_m = {}, .sigma_m = view.sigma_m.row(y)[x], .plate_px = {}};
      sample.held_out = (x / kBlock_px + 2 * (y / kBlock_px)) % 3 == 0;
      sample.point_m = view.base_from_tof * rays_.row(y)[x].at(distance_m);
      for (sample.to = 0; sample.to < views_.size(); ++sample.to) {
        if (sample.to == from) continue;
        const Vector3d p = posed_[sample.to].tof_from_base * sample.point_m;
        if (p.z() <= 0) continue;
        const auto px = tof_.project(p);
        if (!px || !is_inside(size, *px, 1)) continue;
        if (!sample.plate_px && !view.plate.empty())
          sample.plate_px = target_.project(posed_[from].target_from_base * sample.point_m);
        samples_[from].push_back(sample);
      }
    }
  thin_out(samples_[from]);
}

/// Distance of a point to the plane of the other view at the point's pixel there.
std::optional<Difference> Aligner::distance(const AlignSample& sample) const {
  const Posed& to = posed_[sample.to];
  const ScanView& other = views_[sample.to];
  const Vector3d p_base = posed_[sample.from].turn * sample.point_m;
  const Vector3d p = to.tof_from_base * p_base;
  if (p.z() <= 0) return {};
  const auto px = tof_.project(p);
  if (!px || !is_inside(tof_.size_px(), *px, kNormal_px)) return {};
  const int x = static_cast<int>(std::lround(px->x())), y = static_cast<int>(std::lround(px->y()));
  const auto point = [&](int u, int v) { return rays_.row(v)[u].at(other.distance_m.row(v)[u]); };
  const float here_m = other.distance_m.row(y)[x];
  for (const auto& [dx, dy] : {std::pair{kNormal_px, 0}, {0, kNormal_px}}) {
    const float a = other.distance_m.row(y + dy)[x + dx], b = other.distance_m.row(y - dy)[x - dx];
    if (!(a > 0 && b > 0 && here_m > 0)) return {};
    if (std::abs(a + b - 2 * here_m) > 0.03F * here_m) return {};  // an edge
  }
  const Vector3d across = point(x + kNormal_px, y) - point(x - kNormal_px, y);
  const Vector3d down = point(x, y + kNormal_px) - point(x, y - kNormal_px);
  const Vector3d normal = across.cross(down).normalized();
  if (!normal.allFinite()) return {};
  Difference d;
  d.value = normal.dot(p - point(x, y));
  if (std::abs(d.value) > kOther_m) return {};
  const double cosine = std::abs(normal.dot(p.normalized()));
  d.sigma = std::hypot(cosine * std::hypot(sample.sigma_m, other.sigma_m.row(y)[x]), kDepthFloor_m);
  d.jacobian = p_base.cross(to.tof_from_base.rotation.conjugate() * normal);
  return d;
}

std::optional<Difference> Aligner::color_difference(const AlignSample& sample) const {
  const Posed& to = posed_[sample.to];
  if (!sample.plate_px || views_[sample.to].plate.empty()) return {};
  const Vector3d p_base = posed_[sample.from].turn * sample.point_m;
  const Vector3d p = to.target_from_base * p_base;
  if (p.z() <= 0) return {};
  const auto px = target_.project(p);
  if (!px) return {};
  const auto mine = detail_at(details_[sample.from], *sample.plate_px, level_);
  const auto theirs = detail_at(details_[sample.to], *px, level_);
  if (!mine || !theirs) return {};
  Difference d;
  d.value = mine->value - theirs->value;
  d.sigma = std::hypot(kColorNoise, kColorShift_px * theirs->gradient.norm());
  const Vector2d slope(theirs->gradient.x() / level_ * target_.pinhole.fx_px / p.z(),
                       theirs->gradient.y() / level_ * target_.pinhole.fy_px / p.z());
  const Vector3d by_point(slope.x(), slope.y(), -(slope.x() * p.x() + slope.y() * p.y()) / p.z());
  d.jacobian = -p_base.cross(to.target_from_base.rotation.conjugate() * by_point);
  return d;
}

/// One step of Gauss-Newton.
void Aligner::improve() {
  const std::size_t n = views_.size();
  std::vector<PairSum> sums(n * n);
  crew_.rows(static_cast<int>(n), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i)
      for (const AlignSample& sample : samples_[static_cast<std::size_t>(i)]) {
        if (sample.held_out) continue;
        const auto depth = distance(sample);
        if (!depth) continue;
        PairSum& sum = sums[sample.from * n + sample.to];
        sum.add(*depth);
        if (const auto color = color_difference(sample)) sum.add(*color);
      }
  });
  const auto unknowns = static_cast<Eigen::Index>(3 * n);
  Eigen::MatrixXd squares = Eigen::MatrixXd::Zero(unknowns, unknowns);
  Eigen::VectorXd gradient = Eigen::VectorXd::Zero(unknowns);
  for (std::size_t i = 0; i < n; ++i) {
    const auto a = static_cast<Eigen::Index>(3 * i);
    const double prior = 1 / (kUnitSigma_rad * kUnitSigma_rad + turns_[i].squaredNorm());
    squares.block<3, 3>(a, a) += prior * Eigen::Matrix3d::Identity();
    gradient.segment<3>(a) += prior * turns_[i];
    for (std::size_t j = 0; j < n; ++j) {
      const PairSum& sum = sums[i * n + j];
      const auto b = static_cast<Eigen::Index>(3 * j);
      squares.block<3, 3>(a, a) += sum.squares, squares.block<3, 3>(b, b) += sum.squares;
      squares.block<3, 3>(a, b) -= sum.squares, squares.block<3, 3>(b, a) -= sum.squares;
      gradient.segment<3>(a) += sum.gradient, gradient.segment<3>(b) -= sum.gradient;
    }
  }
  const Eigen::VectorXd step = estimation::SymmetricSolver(squares).solve_column(gradient);
  for (std::size_t i = 0; i < n; ++i)
    turns_[i] -= step.segment<3>(static_cast<Eigen::Index>(3 * i));
  pose_views();
}

double median_of(std::vector<float> values) { return upper_median_in_place(std::span(values)); }

}  // namespace

Alignment align(std::span<const ScanView> views, const geometry::CameraModel& tof,
                const geometry::CameraModel& target, double least_turn_rad, Crew& crew) {
  Aligner aligner(views, tof, target, crew);
  aligner.estimate();
  std::vector<Vector3d> turns = aligner.turns_rad();
  aligner.set_level(kFinest);
  const std::vector<HeldOut> after = aligner.held_out();
  aligner.set_turns(std::vector<Vector3d>(views.size(), Vector3d::Zero()));
  const std::vector<HeldOut> before = aligner.held_out();
  Alignment result;
  std::vector<double> sizes_rad;
  for (const Vector3d& by : turns) sizes_rad.push_back(by.norm());
  result.median_turn_rad = upper_median_in_place(std::span(sizes_rad));
  result.refused = result.median_turn_rad > kMostMedianTurn_rad;
  std::vector<float> all_m;
  for (std::size_t i = 0; i < views.size(); ++i) {
    ViewAgreement& view = result.views.emplace_back();
    view.samples = static_cast<int>(before[i].distances_m.size());
    view.median_m = median_of(before[i].distances_m);
    view.aligned_m = median_of(after[i].distances_m);
    all_m.insert(all_m.end(), before[i].distances_m.begin(), before[i].distances_m.end());
    const auto mean = [](const HeldOut& h) {
      return h.distances_m.empty() ? 0.0 : h.cost / static_cast<double>(h.distances_m.size());
    };
    if (!result.refused && turns[i].norm() > least_turn_rad &&
        mean(after[i]) < (1 - kLeastGain) * mean(before[i]))
      view.turn_rad = turns[i];
  }
  result.samples = static_cast<int>(all_m.size() / 2);  // each was counted for two views
  result.median_m = median_of(all_m);
  if (!all_m.empty()) result.p95_m = order_statistic(std::span(all_m), all_m.size() * 95 / 100);
  return result;
}

void turn(const Vector3d& turn_rad, ScanView& view) {
  const geometry::Pose turned{estimation::rotation_exp(turn_rad), Vector3d::Zero()};
  view.base_from_tof = turned * view.base_from_tof;
  view.base_from_target = turned * view.base_from_target;
}

}  // namespace mixrig::model
