// SPDX-License-Identifier: Apache-2.0
#include "host/pose/tracker/first_pose.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include <Eigen/Dense>

namespace mixrig::tracking {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;
using std::numbers::pi;

constexpr double kStep_rad = 0.11;  ///< grid step of rotations
constexpr double kStep_m = 0.36;    ///< grid step of positions
constexpr double kPixel_rad = 0.1;  ///< approximate pixel of the coarse picture and room
constexpr std::size_t kRays = 256;  ///< rays of the picture that are compared
constexpr float kLeastCorrelation = 0.3F;
constexpr std::size_t kSecondTurns = 200, kTurnsOfPlace = 30;
constexpr std::size_t kFirstRays = 64;  ///< rays compared with all rotations
/// If a second pose explains this share of what the best one explains, the best one is ambiguous
/// and refused.
constexpr double kAsGood = 0.8;
constexpr int kCoarsePatches = 100;
constexpr std::size_t kCoarse = 160, kFine = 24;  ///< poses that are aligned

/// A view of the room from a position: grey values on the six faces of a cube, -1 unknown.
class Around {
 public:
  static constexpr int kSide = 24;
  void clear() { grey_.fill(-1), range_.fill(1e9F); }
  void put(const Vector3f& ray, float grey) {
    const float range = ray.norm();
    const std::size_t at = index(ray);
    if (range < range_[at]) range_[at] = range, grey_[at] = grey;
  }
  float at(const Vector3f& ray) const { return grey_[index(ray)]; }
  /// Fills empty pixels from their neighbours.
  void fill() {
    const auto before = grey_;
    for (std::size_t face = 0; face < 6; ++face)
      for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x) {
          const std::size_t k =
              (face * kSide + static_cast<std::size_t>(y)) * kSide + static_cast<std::size_t>(x);
          if (before[k] >= 0) continue;
          float sum = 0;
          int count = 0;
          for (int j = std::max(0, y - 1); j <= std::min(kSide - 1, y + 1); ++j)
            for (int i = std::max(0, x - 1); i <= std::min(kSide - 1, x + 1); ++i) {
              const float v = before[(face * kSide + static_cast<std::size_t>(j)) * kSide +
                                     static_cast<std::size_t>(i)];
              if (v >= 0) sum += v, ++count;
            }
          if (count >= 3) grey_[k] = sum / static_cast<float>(count);
        }
  }

 private:
  static std::size_t index(const Vector3f& r) {
    const float ax = std::abs(r.x()), ay = std::abs(r.y()), az = std::abs(r.z());
    int face = 0;
    float major = ax, u = r.y(), v = r.z();
    if (ay > ax && ay >= az)
      face = 2, major = ay, u = r.x(), v = r.z();
    else if (az > ax)
      face = 4, major = az, u = r.x(), v = r.y();
    const float sign = face == 0 ? r.x() : face == 2 ? r.y() : r.z();
    if (sign < 0) ++face;
    const float half = 0.5F * kSide / major;
    const int x = std::clamp(static_cast<int>(u * half + 0.5F * kSide), 0, kSide - 1);
    const int y = std::clamp(static_cast<int>(v * half + 0.5F * kSide), 0, kSide - 1);
    return (static_cast<std::size_t>(face) * kSide + static_cast<std::size_t>(y)) * kSide +
           static_cast<std::size_t>(x);
  }
  std::array<float, 6 * kSide * kSide> grey_{}, range_{};
};

using Surface = FirstPose::Surface;

/// Returns points on the room's surface, about two for each pixel of Around, each with the mean
/// colour around it.
std::vector<Surface> surfaces_of(const model::Panorama& room) {
  std::vector<Surface> all;
  const int width = room.color.width(), height = room.color.height();
  const int step = std::max(1, height / 96);
  for (int y = 0; y + step <= height; y += step)
    for (int x = 0; x + step <= width; x += step) {
      const int dx = (x + step / 2) * room.size().width / width;
      const int dy = (y + step / 2) * room.size().height / height;
      const float distance_m = room.distance_m.row(dy)[dx];
      if (distance_m <= 0) continue;
      float sum = 0;
      int count = 0;
      for (int j = y; j < y + step; ++j)
        for (int i = x; i < x + step; ++i) {
          const Rgb8& c = room.color.row(j)[i];
          if (c.r == 0 && c.g == 0 && c.b == 0) continue;
          sum += 0.299F * static_cast<float>(c.r) + 0.587F * static_cast<float>(c.g) +
                 0.114F * static_cast<float>(c.b);
          ++count;
        }
      if (2 * count < step * step) continue;
      all.push_back({distance_m * model::direction_of(room.size(), dx, dy).cast<float>(),
                     sum / static_cast<float>(count)});
    }
  return all;
}

/// Returns rotations whose rotation vectors lie on a cubic grid in a ball.
std::vector<Eigen::Matrix3f> turns_within(double radius_rad) {
  std::vector<Eigen::Matrix3f> turns;
  const int n = static_cast<int>(std::floor(radius_rad / kStep_rad));
  for (int z = -n; z <= n; ++z)
    for (int y = -n; y <= n; ++y)
      for (int x = -n; x <= n; ++x) {
        const Vector3d w = kStep_rad * Vector3d(x, y, z);
        const double angle = w.norm();
        if (angle > std::min(radius_rad, pi)) continue;
        turns.push_back(
            angle > 0 ? Eigen::Matrix3f(
                            Eigen::AngleAxisd(angle, w / angle).toRotationMatrix().cast<float>())
                      : Eigen::Matrix3f(Eigen::Matrix3f::Identity()));
      }
  return turns;
}

struct Ray {
  Vector3f direction;  ///< in camera axes
  float grey;
};

struct Guess {
  float correlation = -1;
  geometry::Pose room_from_camera;
};

float correlation(std::span<const Ray> rays, const Eigen::Matrix3f& room_from_camera,
                  const Around& around) {
  float n = 0, a = 0, b = 0, aa = 0, bb = 0, ab = 0;
  for (const Ray& ray : rays) {
    const float v = around.at(room_from_camera * ray.direction);
    if (v < 0) continue;
    n += 1, a += v, b += ray.grey;
    aa += v * v, bb += ray.grey * ray.grey, ab += v * ray.grey;
  }
  if (n < 0.5F * static_cast<float>(rays.size())) return -1;
  const float va = aa - a * a / n, vb = bb - b * b / n;
  return va > 0 && vb > 0 ? (ab - a * b / n) / std::sqrt(va * vb) : -1;
}

/// Returns rays of the picture's level whose pixels are about as large as the coarse room's.
std::vector<Ray> rays_of(const GreyPyramid& picture, const geometry::AnyCamera& camera) {
  const double per_rad = geometry::parameters_of(camera)[0];
  int k = 0;
  while (k + 1 < picture.levels() && (1 << (k + 1)) / per_rad <= 1.2 * kPixel_rad) ++k;
  const Image<float>& image = picture.level(k);
  std::vector<Ray> all;
  for (int y = 1; y + 1 < image.height(); ++y)
    for (int x = 1; x + 1 < image.width(); ++x) {
      const auto ray = geometry::unproject(camera, {up(x, k), up(y, k)});
      if (ray && image.row(y)[x] > 0) all.push_back({ray->cast<float>(), image.row(y)[x]});
    }
  // The rays are spread evenly over the picture, also the first few of them.
  std::vector<Ray> some;
  const std::size_t count = std::min(kRays, all.size()), few = std::min(kFirstRays, count);
  for (std::size_t first = 0; first * few < count; ++first)
    for (std::size_t i = 0; i < few && some.size() < count; ++i)
      some.push_back(all[(i * count / few + first) % count * all.size() / count]);
  return some;
}

/// Returns positions of a cubic grid in a ball that lie in the room's free space.
std::vector<Vector3d> places_within(const SearchField& field, const PatchMap& map) {
  std::vector<Vector3d> places;
  const int n = static_cast<int>(std::floor(field.radius_m / kStep_m));
  for (int z = -n; z <= n; ++z)
    for (int y = -n; y <= n; ++y)
      for (int x = -n; x <= n; ++x) {
        const Vector3d off = kStep_m * Vector3d(x, y, z);
        if (off.norm() > field.radius_m) continue;
        const Vector3d place = field.room_from_camera.translation_m + off;
        if (!map.hidden(Vector3f::Zero(), place.cast<float>())) places.push_back(place);
      }
  return places;
}

void keep_best(std::size_t count, std::vector<Guess>& all) {
  const std::size_t kept = std::min(all.size(), count);
  std::partial_sort(all.begin(), all.begin() + static_cast<std::ptrdiff_t>(kept), all.end(),
                    [](const Guess& a, const Guess& b) { return a.correlation > b.correlation; });
  all.resize(kept);
}

/// Returns the best rotations at one position: all rotations are compared by few rays, the best of
/// them by all rays.
std::vector<Guess> turns_of(std::span<const Ray> rays, std::span<const Eigen::Matrix3f> turns,
                            const Around& around) {
  std::vector<Guess> best;
  const std::span<const Ray> few = rays.first(std::min(kFirstRays, rays.size()));
  for (const Eigen::Matrix3f& turn : turns) {
    const float c = correlation(few, turn, around);
    if (c > kLeastCorrelation)
      best.push_back({c, {Eigen::Quaterniond(turn.cast<double>()), Vector3d::Zero()}});
  }
  keep_best(kSecondTurns, best);
  for (Guess& guess : best)
    guess.correlation =
        correlation(rays, guess.room_from_camera.rotation.toRotationMatrix().cast<float>(), around);
  keep_best(kTurnsOfPlace, best);
  return best;
}

/// Keeps the first `count` poses that do not repeat an earlier one.
void keep_different(std::size_t count, std::vector<PatchFit>& best_first) {
  constexpr double kSame_m = 0.05, kSame_rad = 0.03;
  std::vector<PatchFit> kept;
  for (const PatchFit& fit : best_first) {
    const geometry::Pose pose = geometry::inverse(fit.camera_from_room);
    const bool same = std::any_of(kept.begin(), kept.end(), [&](const PatchFit& other) {
      const geometry::Pose there = geometry::inverse(other.camera_from_room);
      return (there.translation_m - pose.translation_m).norm() < kSame_m &&
             there.rotation.angularDistance(pose.rotation) < kSame_rad;
    });
    if (!same) kept.push_back(fit);
    if (kept.size() == count) break;
  }
  best_first = std::move(kept);
}

}  // namespace

FirstPose::FirstPose(const model::Panorama& room, const PatchMap& map,
                     const geometry::AnyCamera& camera, const AlignOptions& options, Crew& crew)
    : map_(map), camera_(camera), options_(options), crew_(crew), surfaces_(surfaces_of(room)) {}

void FirstPose::guess(const GreyPyramid& picture, const SearchField& field,
                      std::vector<PatchFit>& best_first) const {
  const std::vector<Ray> rays = rays_of(picture, camera_);
  const std::vector<Vector3d> places = places_within(field, map_);
  std::vector<Eigen::Matrix3f> turns = turns_within(field.radius_rad);
  const Eigen::Matrix3f middle = field.room_from_camera.rotation.toRotationMatrix().cast<float>();
  for (Eigen::Matrix3f& turn : turns) turn = turn * middle;
  std::vector<std::vector<Guess>> best(places.size());
  crew_.rows(static_cast<int>(places.size()), 1, [&](int begin, int end) {
    for (int i = begin; i < end; ++i) {
      const auto at = static_cast<std::size_t>(i);
      Around around;
      around.clear();
      for (const Surface& s : surfaces_) around.put(s.place_m - places[at].cast<float>(), s.grey);
      around.fill();
      best[at] = turns_of(rays, turns, around);
      for (Guess& guess : best[at]) guess.room_from_camera.translation_m = places[at];
    }
  });
  std::vector<Guess> all;
  for (const auto& of_place : best) all.insert(all.end(), of_place.begin(), of_place.end());
  keep_best(kCoarse, all);
  best_first.resize(all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    best_first[i].camera_from_room = geometry::inverse(all[i].room_from_camera);
}

double share_of(const PatchFit& fit) {
  return fit.visible > 0 ? static_cast<double>(fit.inliers) / fit.visible : 0;
}

bool explains(const PatchFit& fit) {
  return fit.inliers >= std::max(12.0, 0.2 * fit.visible + 5) && fit.sigma_m() < 0.03 &&
         fit.sigma_rad() < 0.01;
}

void FirstPose::align_all(const GreyPyramid& picture, int coarsest, int finest, int patches,
                          std::vector<PatchFit>& best_first) const {
  AlignOptions options = options_;
  options.patches = patches;
  constexpr int kGrain = 4;
  crew_.rows(static_cast<int>(best_first.size()), kGrain, [&](int begin, int end) {
    PatchAlign align(map_, camera_, options);
    for (int i = begin; i < end; ++i) {
      PatchFit& fit = best_first[static_cast<std::size_t>(i)];
      fit = align.align(picture, fit.camera_from_room, coarsest, finest);
    }
  });
  std::sort(best_first.begin(), best_first.end(), [](const PatchFit& a, const PatchFit& b) {
    return a.inliers * b.visible > b.inliers * a.visible;
  });
}

std::optional<PatchFit> FirstPose::find(const GreyPyramid& picture,
                                        const SearchField& field) const {
  std::vector<PatchFit> fits;
  guess(picture, field, fits);
  const int level = PatchAlign(map_, camera_, options_).coarsest();
  const int middle = std::max(options_.finest, level - 1);
  align_all(picture, level + 1, middle, kCoarsePatches, fits);
  keep_different(kFine, fits);
  align_all(picture, middle, options_.finest, options_.patches, fits);
  keep_different(2, fits);
  if (fits.empty() || !explains(fits[0])) return std::nullopt;
  if (fits.size() > 1 && explains(fits[1]) && share_of(fits[1]) > kAsGood * share_of(fits[0]))
    return std::nullopt;
  return fits[0];
}

}  // namespace mixrig::tracking
