// SPDX-License-Identifier: Apache-2.0
#include "host/room/scan/panorama/panorama.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "host/room/scan/panorama/floating_areas.h"
#include "host/room/scan/panorama/panorama_color.h"
#include "host/room/scan/panorama/panorama_finish.h"
#include "host/room/scan/panorama/view_gains.h"
#include "host/room/scan/shape/room_planes.h"

namespace mixrig::model {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr int kMostCandidates = 16;
constexpr int kMeetSteps = 5;        ///< of the fixed point
constexpr double kSettled_m = 1e-3;  ///< change of the last step
constexpr double kStart_m = 2.5;     ///< first guess of a distance
constexpr float kStepShare = 0.03F;  ///< of the distance: neighbours further apart are an edge
constexpr float kStepFloor_m = 0.03F;
constexpr double kBorder_px = 8;      ///< weight falls to 0 over this many pixels
constexpr double kEdgeWeight = 0.05;  ///< of a pixel beside a depth step
constexpr float kGate_m = 0.02F;      ///< beyond noise, that views may differ by
constexpr int kFillPasses = 16;

/// A view with what its rays need, made once.
struct PreparedView {
  const ScanView* view = nullptr;
  geometry::Pose tof_from_base;
  Vector3d eye_m, axis;
  double least_cosine = 0;  ///< between axis and a direction that the view can see
};

struct Candidate {
  float distance_m = 0, sigma_m = 0, weight = 0;
};

struct MetSample {
  double distance_m = 0, sigma_m = 0, weight = 0;
};

/// Distance, its sigma and the weight of a pixel; weight 0 where nothing is known.
MetSample sample_at(const ScanView& view, const Vector2d& px, double pixels_per_rad) {
  const Size size = view.distance_m.size();
  const int x = static_cast<int>(std::floor(px.x())), y = static_cast<int>(std::floor(px.y()));
  if (x < 0 || y < 0 || x + 1 >= size.width || y + 1 >= size.height) return {};
  const float *top = view.distance_m.row(y) + x, *bottom = view.distance_m.row(y + 1) + x;
  const auto [low, high] = std::minmax({top[0], top[1], bottom[0], bottom[1]});
  const auto fx = static_cast<float>(px.x() - x), fy = static_cast<float>(px.y() - y);
  const int near_x = x + (fx > 0.5F ? 1 : 0), near_y = y + (fy > 0.5F ? 1 : 0);
  const double border =
      std::min({px.x(), px.y(), size.width - 1 - px.x(), size.height - 1 - px.y()});
  const double inside = std::clamp(border / kBorder_px, 0.01, 1.0);
  const double sigma = view.sigma_m.row(near_y)[near_x];
  if (low <= 0 || is_depth_step(low, high)) {
    const float nearest = view.distance_m.row(near_y)[near_x];
    return {nearest, sigma, nearest > 0 ? kEdgeWeight * inside / (sigma * sigma) : 0};
  }
  const float upper = top[0] + fx * (top[1] - top[0]);
  const float lower = bottom[0] + fx * (bottom[1] - bottom[0]);
  const float value = upper + fy * (lower - upper);
  const double across = 0.5 * (top[1] - top[0] + bottom[1] - bottom[0]), down = lower - upper;
  const double slope = std::hypot(across, down) * pixels_per_rad / value;  // tan of incidence
  return {value, sigma, inside / (sigma * sigma) / std::sqrt(1 + slope * slope)};
}

/// Intersects a ray from the origin with the surface that a view measured; weight 0 where it does
/// not meet it.
MetSample meet(const PreparedView& from, const Vector3d& ray, const geometry::CameraModel& tof,
               double guess_m) {
  MetSample found;
  double along_m = guess_m;
  for (int step = 0; step < kMeetSteps; ++step) {
    const Vector3d p = from.tof_from_base * (along_m * ray);
    if (p.z() <= 0) return {};
    const auto px = tof.project(p);
    if (!px) return {};
    const MetSample sample = sample_at(*from.view, *px, tof.pinhole.fx_px);
    if (sample.weight <= 0) return {};
    const Vector3d met = from.eye_m + sample.distance_m * (along_m * ray - from.eye_m).normalized();
    const double next_m = met.dot(ray), change = std::abs(next_m - along_m);
    along_m = next_m;
    found = {along_m, sample.sigma_m, change < 0.01 * along_m ? sample.weight : 0};
    if (change < kSettled_m) break;
  }
  return found;
}

/// Candidates of one surface, neighbours in distance.
struct Group {
  double weight = 0, sum_m = 0, inverse_variance = 0;
  int views = 0;
  void add(const Candidate& c) {
    weight += c.weight, sum_m += static_cast<double>(c.weight) * c.distance_m;
    inverse_variance += 1.0 / (static_cast<double>(c.sigma_m) * c.sigma_m), ++views;
  }
};

/// The surface that most views see, the farther one of as many. `candidates` get sorted.
Group choose(std::span<Candidate> candidates) {
  std::sort(candidates.begin(), candidates.end(),
            [](const Candidate& a, const Candidate& b) { return a.distance_m < b.distance_m; });
  Group best, group;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    const Candidate& c = candidates[i];
    if (i > 0) {
      const Candidate& before = candidates[i - 1];
      const float noise = std::hypot(c.sigma_m, before.sigma_m);
      if (c.distance_m - before.distance_m > kGate_m + 4 * noise) group = {};
    }
    group.add(c);
    if (group.views >= best.views) best = group;
  }
  return best;
}

std::vector<PreparedView> prepare_views(std::span<const ScanView> views,
                                        const geometry::CameraModel& tof) {
  constexpr double kParallax_rad = 0.2;
  const Size size = tof.size_px();
  double widest = 0;
  for (const double x : {0.0, size.width - 1.0})
    for (const double y : {0.0, size.height - 1.0})
      if (const auto ray = tof.unproject({x, y})) widest = std::max(widest, std::atan(ray->norm()));
  std::vector<PreparedView> prepared;
  for (const ScanView& view : views)
    prepared.push_back({&view, geometry::inverse(view.base_from_tof),
                        view.base_from_tof.translation_m,
                        view.base_from_tof.rotation * Vector3d::UnitZ(),
                        std::cos(std::min(widest + kParallax_rad, std::numbers::pi))});
  return prepared;
}

class Fusion {
 public:
  Fusion(std::span<const ScanView> views, const geometry::CameraModel& tof, Panorama& out)
      : views_(prepare_views(views, tof)), tof_(tof), out_(out), directions_(out.size()) {}

  void row(int y) const {
    double guess_m = kStart_m;
    for (int x = 0; x < out_.size().width; ++x) pixel(x, y, guess_m);
  }

  /// Whether a view's frustum holds the point on the ray.
  bool is_in_field(const Vector3d& ray, double distance_m) const {
    return std::any_of(views_.begin(), views_.end(), [&](const PreparedView& from) {
      return from.axis.dot(ray) >= from.least_cosine && is_inside(from, ray, distance_m);
    });
  }

 private:
  void pixel(int x, int y, double& guess_m) const {
    const Vector3d ray = directions_(x, y);
    std::array<Candidate, kMostCandidates> candidates;
    std::size_t count = 0;
    for (const PreparedView& from : views_) {
      if (from.axis.dot(ray) < from.least_cosine) continue;
      if (out_.field.row(y)[x] == 0 && is_inside(from, ray, guess_m)) out_.field.row(y)[x] = 1;
      const MetSample met = meet(from, ray, tof_, guess_m);
      if (met.weight <= 0 || count == candidates.size()) continue;
      candidates[count++] = {static_cast<float>(met.distance_m), static_cast<float>(met.sigma_m),
                             static_cast<float>(met.weight)};
    }
    if (count == 0) return;
    const Group best = choose(std::span(candidates).first(count));
    guess_m = best.sum_m / best.weight;
    out_.distance_m.row(y)[x] = static_cast<float>(guess_m);
    out_.sigma_m.row(y)[x] = static_cast<float>(1 / std::sqrt(best.inverse_variance));
    out_.views.row(y)[x] = static_cast<std::uint8_t>(best.views);
  }

  bool is_inside(const PreparedView& from, const Vector3d& ray, double guess_m) const {
    const auto px = tof_.project(from.tof_from_base * (guess_m * ray));
    const Size size = tof_.size_px();
    return px && px->x() >= 0 && px->y() >= 0 && px->x() <= size.width - 1 &&
           px->y() <= size.height - 1;
  }

  std::vector<PreparedView> views_;
  const geometry::CameraModel& tof_;
  Panorama& out_;
  Directions directions_;
};

/// Forgets what was filled where no view looks: the field was found before distances were known.
void trim_field(const Fusion& fusion, Panorama& p, int begin, int end) {
  for (int y = begin; y < end; ++y)
    for (int x = 0; x < p.size().width; ++x) {
      if (p.views.row(y)[x] > 0 || p.distance_m.row(y)[x] <= 0) continue;
      if (fusion.is_in_field(direction_of(p.size(), x, y), p.distance_m.row(y)[x])) continue;
      p.distance_m.row(y)[x] = p.sigma_m.row(y)[x] = 0;
      p.field.row(y)[x] = 0;
    }
}

/// Share of the field's solid angle that `counts(x, y)`.
template <typename Counts>
double share_of_field(const Panorama& panorama, const Counts& counts) {
  double all = 0, counted = 0;
  for (int y = 0; y < panorama.size().height; ++y) {
    const double solid = std::sin(std::numbers::pi * (y + 0.5) / panorama.size().height);
    for (int x = 0; x < panorama.size().width; ++x) {
      if (panorama.field.row(y)[x] == 0) continue;
      all += solid;
      if (counts(x, y)) counted += solid;
    }
  }
  return all > 0 ? counted / all : 0;
}

/// Factor that makes colour as fine as the target camera in the middle of its picture, limited by
/// memory.
int color_factor(const geometry::CameraModel& target, int height) {
  constexpr int kMostFactor = 3;
  const double panorama_px_per_rad = height / std::numbers::pi;
  return std::clamp(static_cast<int>(std::lround(target.pinhole.fx_px / panorama_px_per_rad)), 1,
                    kMostFactor);
}

}  // namespace

bool is_depth_step(float low_m, float high_m) {
  return high_m - low_m > kStepFloor_m + kStepShare * low_m;
}

Vector3d direction_of(Size panorama, int x, int y) {
  const double azimuth = std::numbers::pi * (1 - 2 * (x + 0.5) / panorama.width);
  const double elevation = std::numbers::pi * (0.5 - (y + 0.5) / panorama.height);
  return {-std::sin(azimuth) * std::cos(elevation), std::cos(azimuth) * std::cos(elevation),
          std::sin(elevation)};
}

Directions::Directions(Size panorama) {
  for (int x = 0; x < panorama.width; ++x) {
    const double azimuth = std::numbers::pi * (1 - 2 * (x + 0.5) / panorama.width);
    columns_.emplace_back(-std::sin(azimuth), std::cos(azimuth));
  }
  for (int y = 0; y < panorama.height; ++y) {
    const double elevation = std::numbers::pi * (0.5 - (y + 0.5) / panorama.height);
    rows_.emplace_back(std::cos(elevation), std::sin(elevation));
  }
}

Panorama make_panorama(std::span<const ScanView> views, const geometry::CameraModel& tof,
                       const geometry::CameraModel& target, const PanoramaOptions& options,
                       Crew& crew) {
  const int height = options.height_px;
  const Size size{2 * height, height};
  Panorama panorama;
  panorama.distance_m.reset(size), panorama.sigma_m.reset(size);
  panorama.views.reset(size), panorama.field.reset(size);
  const Fusion fusion(views, tof, panorama);
  crew.rows(height, 4, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) fusion.row(y);
  });
  Panorama before = panorama;
  if (options.smooth)
    crew.rows(height, 4, [&](int begin, int end) { smooth_rows(before, panorama, begin, end); });
  if (options.straighten) {
    panorama.planes = find_planes(panorama);
    straighten(panorama.planes, panorama, crew);
  }
  before = panorama;
  for (int pass = 0; pass < kFillPasses && fill_border(panorama, before); ++pass) before = panorama;
  crew.rows(height, 4, [&](int begin, int end) { trim_field(fusion, panorama, begin, end); });
  if (options.straighten) forget_wrapped(panorama), fill_flat_holes(panorama);
  panorama.known_share =
      share_of_field(panorama, [&](int x, int y) { return panorama.distance_m.row(y)[x] > 0; });
  panorama.measured_share =
      share_of_field(panorama, [&](int x, int y) { return panorama.views.row(y)[x] > 0; });
  if (options.equalise) panorama.gains = find_gains(views, tof, target, panorama, crew);
  paint(views, tof, target, color_factor(target, height), panorama, crew);
  return panorama;
}

}  // namespace mixrig::model
