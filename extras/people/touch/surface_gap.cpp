// SPDX-License-Identifier: Apache-2.0
#include "extras/people/touch/surface_gap.h"

#include <algorithm>
#include <cmath>

namespace mixrig::touch {
namespace {

constexpr int kMostSamples = 40000;      ///< pixels of a window that are looked at, about
constexpr float kEvidence_m2 = 0.0008F;  ///< surface that is no single error
constexpr float kPatch_m = 0.12F;
constexpr int kMostPatches = 16;  ///< a side
constexpr int kLeastOfPatch = 6;
constexpr float kSameSurface_m = 0.03F, kSameSurfaceSigmas = 4;
constexpr double kSystematic_m = 0.01;  ///< of key, warp and calibration
constexpr double kNoiseBias = 1.0;      ///< sigmas by which the nearest of many is too near
constexpr float kOwnerCell_m = 0.05F;
constexpr int kOwnerReach = 5, kMostCells = 256;  ///< cells; a side
constexpr float kStep_m = 0.5F;                   ///< from the axis of a body to its feet

}  // namespace

/// The pixels in which the object's box is, with what is near it.
std::optional<SurfaceGaps::Window> SurfaceGaps::window(const Shape& shape,
                                                       const geometry::Pose& view_from_object,
                                                       const plan::SegmentedView& seen) const {
  const Eigen::Vector3f more = Eigen::Vector3f::Constant(kNear_m);
  const Eigen::AlignedBox3f box(shape.box_m.min() - more, shape.box_m.max() + more);
  const Size size = seen.depth_m.size;
  Eigen::AlignedBox2d px;
  bool behind = false, before = false;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d p =
        view_from_object *
        box.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)).cast<double>();
    (p.z() < 0.05 ? behind : before) = true;
    if (p.z() >= 0.05) px.extend(seen.view.project(p));
  }
  if (!before) return std::nullopt;
  if (behind) px = {Eigen::Vector2d::Zero(), Eigen::Vector2d(size.width, size.height)};
  const auto clip = [](double value, int most) {
    return static_cast<int>(std::clamp(value, 0.0, static_cast<double>(most)));
  };
  Window w{clip(px.min().x(), size.width), clip(px.min().y(), size.height),
           clip(px.max().x() + 1, size.width), clip(px.max().y() + 1, size.height), 1};
  if (w.x0 >= w.x1 || w.y0 >= w.y1) return std::nullopt;
  const double pixels = static_cast<double>(w.x1 - w.x0) * (w.y1 - w.y0);
  w.step = std::max(1, static_cast<int>(std::ceil(std::sqrt(pixels / kMostSamples))));
  return w;
}

/// Finds for each cell of a plan around the object whose surface lies over it.
void SurfaceGaps::own(const Shape& shape, const geometry::Pose& world_from_object,
                      const Moment& moment) {
  Eigen::AlignedBox2f box;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d corner =
        shape.box_m.corner(static_cast<Eigen::AlignedBox3f::CornerType>(i)).cast<double>();
    box.extend((world_from_object * corner).head<2>().cast<float>());
  }
  corner_m_ = box.min().array() - kNear_m - kOwnerCell_m;
  columns_ = std::min(kMostCells, static_cast<int>((box.sizes().x() + 0.6F) / kOwnerCell_m) + 1);
  rows_ = std::min(kMostCells, static_cast<int>((box.sizes().y() + 0.6F) / kOwnerCell_m) + 1);
  owner_.assign(static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_), -1);
  for (std::size_t i = 0; i < moment.people.size(); ++i)
    for (const plan::SurfacePoint& p : moment.people[i].surface) {
      const Eigen::Vector2f cell = (p.at_m.head<2>() - corner_m_) / kOwnerCell_m;
      if (!(cell.x() >= 0 && cell.y() >= 0 && cell.x() < static_cast<float>(columns_) &&
            cell.y() < static_cast<float>(rows_)))
        continue;
      owner_[static_cast<std::size_t>(static_cast<int>(cell.y()) * columns_ +
                                      static_cast<int>(cell.x()))] = static_cast<signed char>(i);
    }
}

/// The person whose surface is at that place of the floor or nearest to it; -1: nobody.
int SurfaceGaps::owner(const Eigen::Vector3f& at_m, const Moment& moment) const {
  const Eigen::Vector2f cell = (at_m.head<2>() - corner_m_) / kOwnerCell_m;
  const int cx = static_cast<int>(std::floor(cell.x())),
            cy = static_cast<int>(std::floor(cell.y()));
  for (int reach = 0; reach <= kOwnerReach; ++reach)
    for (int y = cy - reach; y <= cy + reach; ++y)
      for (int x = cx - reach; x <= cx + reach; ++x) {
        if (x < 0 || y < 0 || x >= columns_ || y >= rows_) continue;
        const int who = owner_[static_cast<std::size_t>(y * columns_ + x)];
        if (who >= 0) return who;
      }
  int nearest = -1;
  float least_m = kStep_m;
  for (std::size_t i = 0; i < moment.people.size(); ++i) {
    if (moment.people[i].surface.empty()) continue;
    const float away_m = (moment.people[i].on_floor_m.cast<float>() - at_m.head<2>()).norm();
    if (away_m < least_m) least_m = away_m, nearest = static_cast<int>(i);
  }
  return nearest;
}

void SurfaceGaps::collect(const Shape& shape, const geometry::Pose& world_from_object,
                          const Moment& moment, const Window& w) {
  const ImageView<const float>& depth = moment.seen.depth_m;
  const geometry::Pose object_from_view =
      geometry::inverse(world_from_object) * moment.seen.world_from_view;
  const Eigen::Matrix3f turn = object_from_view.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f eye = object_from_view.translation_m.cast<float>();
  const Eigen::Matrix3f world_turn = world_from_object.rotation.toRotationMatrix().cast<float>();
  const Eigen::Vector3f world_at = world_from_object.translation_m.cast<float>();
  const geometry::Pinhole& view = moment.seen.view;
  const auto fx = static_cast<float>(view.fx_px), fy = static_cast<float>(view.fy_px);
  const auto cx = static_cast<float>(view.cx_px), cy = static_cast<float>(view.cy_px);
  const float area_at_1_m = static_cast<float>(w.step * w.step) / (fx * fy);
  const auto [width, height] = depth.size;
  for (int y = w.y0 + w.step / 2; y < w.y1; y += w.step) {
    const float* const z = depth.row(y);
    for (int x = w.x0 + w.step / 2; x < w.x1; x += w.step) {
      if (!(z[x] > 0)) continue;
      const Eigen::Vector3f ray((static_cast<float>(x) - cx) / fx,
                                (static_cast<float>(y) - cy) / fy, 1);
      const Eigen::Vector3f p = eye + turn * (z[x] * ray);
      if (shape.box_m.squaredExteriorDistance(p) >= kNear_m * kNear_m) continue;
      const float same_m = std::max(
          kSameSurface_m, kSameSurfaceSigmas * static_cast<float>(moment.noise.sigma_m(z[x])));
      const auto is_same = [&](int bx, int by) {
        return bx >= 0 && by >= 0 && bx < width && by < height &&
               std::abs(depth.at(bx, by) - z[x]) < same_m;
      };
      if (is_same(x - 1, y) + is_same(x + 1, y) + is_same(x, y - 1) + is_same(x, y + 1) < 3)
        continue;
      Eigen::Vector3f normal = Eigen::Vector3f::UnitZ();
      const float d = shape.distance_m(p, normal);
      if (!(d < kNear_m)) continue;
      const Eigen::Vector3f at = world_at + world_turn * p;
      const int who = owner(at, moment);
      if (who < 0) continue;
      const Eigen::Vector3f cell = (p - shape.box_m.min()).array() + kNear_m;
      const Eigen::Vector3i patch = (cell / patch_m_)
                                        .cast<int>()
                                        .cwiseMax(0)
                                        .cwiseMin(patch_cells_ - Eigen::Vector3i::Ones());
      samples_.push_back(
          {at, area_at_1_m * z[x] * z[x], d, std::abs(normal.dot(turn * ray)) / ray.norm(),
           (patch.z() * patch_cells_.y() + patch.y()) * patch_cells_.x() + patch.x(), who});
    }
  }
}

/// Sorts the samples by their distance to the object, in bins.
void SurfaceGaps::order() {
  const auto bin = [](const Sample& s) {
    return static_cast<std::size_t>(
        std::clamp(static_cast<int>((s.distance_m - kDeepest_m) / kBin_m), 0, kBins - 1));
  };
  first_.fill(0);
  for (const Sample& s : samples_) ++first_[bin(s) + 1];
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  ordered_.resize(samples_.size());
  for (const Sample& s : samples_) ordered_[static_cast<std::size_t>(first_[bin(s)]++)] = s;
}

/// Finds for each person the first patch, from the deepest sample on, that holds enough surface,
/// and corrects for noise, which makes the nearest of many values too near.
void SurfaceGaps::find_patches(double depth_sigma_m) {
  const int of_one = patch_cells_.prod();
  patches_.assign(static_cast<std::size_t>(of_one) * gaps_.size(), {});
  for (const Sample& s : ordered_) {
    std::optional<Gap>& gap = gaps_[static_cast<std::size_t>(s.who)];
    if (gap) continue;
    Patch& patch = patches_[static_cast<std::size_t>(s.who * of_one + s.patch)];
    patch.area_m2 += s.area_m2, patch.facing += s.area_m2 * s.facing;
    patch.sum_m += s.area_m2 * s.at_m;
    if (++patch.points < kLeastOfPatch || patch.area_m2 < kEvidence_m2) continue;
    const double noise_m = depth_sigma_m * patch.facing / patch.area_m2;
    gap = Gap{s.distance_m + kNoiseBias * noise_m, std::hypot(kSystematic_m, noise_m),
              (patch.sum_m / patch.area_m2).cast<double>(), Evidence::kSurface};
  }
}

std::span<const std::optional<Gap>> SurfaceGaps::measure(const Shape& shape,
                                                         const geometry::Pose& world_from_object,
                                                         const Moment& moment) {
  gaps_.assign(moment.people.size(), std::nullopt);
  if (moment.people.empty()) return gaps_;
  const geometry::Pose view_from_object =
      geometry::inverse(moment.seen.world_from_view) * world_from_object;
  const auto looked_at = window(shape, view_from_object, moment.seen);
  if (!looked_at) return gaps_;
  const Eigen::Vector3f around = shape.box_m.sizes().array() + 2 * kNear_m;
  patch_m_ = std::max(kPatch_m, around.maxCoeff() / kMostPatches);
  patch_cells_ = (around / patch_m_).array().ceil().cast<int>().max(1);
  samples_.clear();
  own(shape, world_from_object, moment);
  collect(shape, world_from_object, moment, *looked_at);
  const Eigen::Vector3d middle = view_from_object * shape.box_m.center().cast<double>();
  const double depth_sigma_m = moment.noise.sigma_m(std::max(0.0, middle.z()));
  order();
  find_patches(depth_sigma_m);
  return gaps_;
}

}  // namespace mixrig::touch
