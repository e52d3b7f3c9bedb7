// SPDX-License-Identifier: Apache-2.0
// Builds the tables of a take: rays, plate map, key limit, background normals.
#include "host/render/tables/prepare.h"

#include <cmath>
#include <limits>
#include <utility>

#include "host/render/tables/hidden_objects.h"
#include "host/render/tables/light_surface.h"
#include "host/render/tables/room_edges.h"
#include "host/render/tables/wrapped_areas.h"

namespace mixrig::render {
namespace {

constexpr float kInfinity = std::numeric_limits<float>::infinity();
/// Where no depth was learned (mirror, glass, black things), w below this part of the limit of what
/// lies around is a reflection.
constexpr float kBehindHole = 0.93F;

Image<glm::vec2> plate_map(const geometry::CameraModel& target, const geometry::Pinhole& view) {
  Image<glm::vec2> map(view.size_px);
  for (int y = 0; y < map.height(); ++y) plate_row(target, view, y, map.row(y));
  return map;
}

Image<float> plate_gain(const CompositorSetup& setup, const Image<glm::vec2>& plate_px) {
  Image<float> gain(plate_px.size());
  for (int y = 0; y < gain.height(); ++y)
    for (int x = 0; x < gain.width(); ++x) {
      const glm::vec2 at = plate_px.row(y)[x];
      gain.row(y)[x] = static_cast<float>(setup.vignetting.factor(
          geometry::Vignetting::radius2(setup.target.pinhole, {at.x, at.y})));
    }
  return gain;
}

/// Largest value within a square of `radius`, by rows, then columns; for inverse depth the nearest
/// surface.
Image<float> largest_within(const Image<float>& image, int radius) {
  Image<float> rows(image.size()), out(image.size());
  const int w = image.width(), h = image.height();
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      float best = 0;
      for (int i = std::max(0, x - radius); i <= std::min(w - 1, x + radius); ++i)
        best = std::max(best, image.row(y)[i]);
      rows.row(y)[x] = best;
    }
  for (int y = 0; y < h; ++y)
    for (int j = std::max(0, y - radius); j <= std::min(h - 1, y + radius); ++j)
      for (int x = 0; x < w; ++x)
        out.row(y)[x] =
            std::max(j == std::max(0, y - radius) ? 0.0F : out.row(y)[x], rows.row(j)[x]);
  return out;
}

/// Sets the limits of holes, where no depth was learned, by the nearest limits to the left and
/// right, above and below: the largest of the four, negated, and kBehindHole of the second largest,
/// or of a single one.
void fill_holes(KeyLimit& limit) {
  const Size size = limit.w.size();
  Image<glm::vec2> largest(size);  // and the second largest
  const auto carry = [&](int x, int y, float& last) {
    const float own = limit.w.row(y)[x];
    if (own < kNoLimitW) last = own;
    glm::vec2& two = largest.row(y)[x];
    two = {std::max(two.x, last), std::max(two.y, std::min(two.x, last))};
  };
  for (int y = 0; y < size.height; ++y) {
    float last = 0;
    for (int x = 0; x < size.width; ++x) carry(x, y, last);
    last = 0;
    for (int x = size.width - 1; x >= 0; --x) carry(x, y, last);
  }
  for (int x = 0; x < size.width; ++x) {
    float last = 0;
    for (int y = 0; y < size.height; ++y) carry(x, y, last);
    last = 0;
    for (int y = size.height - 1; y >= 0; --y) carry(x, y, last);
  }
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      float& value = limit.w.row(y)[x];
      const glm::vec2 around = largest.row(y)[x];
      if (value < kNoLimitW || !(around.x > 0)) continue;
      value = -around.x;
      limit.behind_w.row(y)[x] = kBehindHole * (around.y > 0 ? around.y : around.x);
    }
}

}  // namespace

Image<glm::vec2> tof_rays(const geometry::CameraModel& tof) {
  Image<glm::vec2> rays(tof.size_px());
  for (int y = 0; y < rays.height(); ++y)
    for (int x = 0; x < rays.width(); ++x) {
      const auto ray = tof.unproject({x, y});
      rays.row(y)[x] =
          ray ? glm::vec2(ray->x(), ray->y()) : glm::vec2(std::numeric_limits<float>::quiet_NaN());
    }
  return rays;
}

float bends_part(const geometry::CameraModel& tof) {
  return std::min(kSteepest, kSteepestSlope / static_cast<float>(tof.pinhole.fx_px));
}

float stray_px_m2(const geometry::CameraModel& tof) {
  return kStrayAreaM2 * static_cast<float>(tof.pinhole.fx_px * tof.pinhole.fy_px);
}

void set_view(const CompositorSetup& setup, Tables& tables) {
  tables.warp.camera_from_tof = glm::mat4(to_glm(setup.target_from_tof.matrix()));
  tables.warp.view.focal_px = glm::vec2(setup.view.fx_px, setup.view.fy_px);
  tables.warp.view.center_px = glm::vec2(setup.view.cx_px, setup.view.cy_px);
  tables.tof_footprint_px = tof_footprint_px(setup);
}

KeyLimit key_limit(const BackgroundView& background, const KeyParams& key, const NoiseParams& noise,
                   int radius_px) {
  const Size size = background.depth_m.size;
  Image<float> w(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      const float z = background.depth_m.row(y)[x];
      w.row(y)[x] = z > 0 && std::isfinite(z) ? 1 / z : 0;
    }
  KeyLimit limit{largest_within(w, radius_px), Image<float>(size)};
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      float& value = limit.w.row(y)[x];
      if (!(value > 0) || !(w.row(y)[x] > 0)) {
        value = kInfinity;
        continue;
      }
      const float z = 1 / value;
      const float spread =
          background.depth_sigma_m.empty() ? 0 : background.depth_sigma_m.row(y)[x];
      const float sigma = noise.sigma_m(z);
      const float threshold =
          std::max(key.threshold_m, key.noise_factor * std::sqrt(spread * spread + sigma * sigma));
      value = threshold < z ? 1 / (z - threshold) : kInfinity;
    }
  fill_holes(limit);
  return limit;
}

PackedNormal normal_at(ImageView<const float> depth_m, const geometry::Pinhole& view, int u, int v,
                       int radius_px) {
  const float z0 = depth_m.row(v)[u];
  if (!(z0 > 0)) return {};
  const float w0 = 1 / z0;
  const int step = std::max(1, radius_px / 2);
  double n = 0, sx = 0, sy = 0, sw = 0, sxx = 0, sxy = 0, syy = 0, sxw = 0, syw = 0;
  for (int dv = -2 * step; dv <= 2 * step; dv += step)
    for (int du = -2 * step; du <= 2 * step; du += step) {
      if (u + du < 0 || v + dv < 0 || u + du >= depth_m.size.width || v + dv >= depth_m.size.height)
        continue;
      const float z = depth_m.row(v + dv)[u + du];
      // A sample across a depth step belongs to another surface.
      if (!(z > 0) || std::abs(z - z0) > 0.1F * z0) continue;
      const double x = du / view.fx_px, y = dv / view.fy_px, w = 1 / z - w0;
      n += 1, sx += x, sy += y, sw += w, sxx += x * x, sxy += x * y, syy += y * y;
      sxw += x * w, syw += y * w;
    }
  sxx -= sx * sx / n, sxy -= sx * sy / n, syy -= sy * sy / n, sxw -= sx * sw / n,
      syw -= sy * sw / n;
  const double det = sxx * syy - sxy * sxy;
  const double size = step / view.fx_px;
  if (n < 6 || !(det > size * size * size * size)) return {};
  const double a = (sxw * syy - syw * sxy) / det, b = (syw * sxx - sxw * sxy) / det;
  const Eigen::Vector2d ray = view.unproject({u, v});
  const Eigen::Vector3d normal =
      -Eigen::Vector3d(a, b, w0 - a * ray.x() - b * ray.y()).normalized();
  const auto pack = [](double value) { return static_cast<std::int8_t>(std::lround(127 * value)); };
  return {pack(normal.x()), pack(normal.y()), pack(normal.z()), 0};
}

Image<PackedNormal> normals(ImageView<const float> depth_m, const geometry::Pinhole& view,
                            int radius_px) {
  Image<PackedNormal> out(depth_m.size);
  for (int y = 0; y < out.height(); ++y)
    for (int x = 0; x < out.width(); ++x) out.row(y)[x] = normal_at(depth_m, view, x, y, radius_px);
  return out;
}

Tables make_tables(const CompositorSetup& setup) {
  Tables t;
  t.tof_size = setup.tof.size_px();
  t.plate_size = setup.target.size_px();
  t.view_size = setup.view.size_px;
  t.lens_moves = setup.lens_moves;
  t.may_hide_objects = setup.may_hide_objects || !any_object_hides(setup);
  t.tof_ray = tof_rays(setup.tof);
  t.plate_is_view = setup.target.lens.is_ideal() && setup.view == setup.target.pinhole &&
                    setup.vignetting.is_none() && !setup.lens_moves;
  if (!t.plate_is_view) t.plate_px = plate_map(setup.target, setup.view);
  if (!setup.vignetting.is_none()) t.plate_gain = plate_gain(setup, t.plate_px);

  if (setup.tof2) t.tof2_size = setup.tof2->model.size_px();
  t.correct.depth_is_distance = setup.depth_is_distance;
  t.correct.noise = noise_params(setup.noise);
  t.correct.bends_part = bends_part(setup.tof);
  t.correct.stray_px_m2 = stray_px_m2(setup.tof);
  set_view(setup, t);

  t.has_background = !setup.background.depth_m.empty();
  if (!t.has_background) return t;
  const int radius_px = limit_radius_px(t.tof_footprint_px);
  KeyLimit limit = key_limit(setup.background, setup.key, t.correct.noise, radius_px);
  t.key_limit_w = std::move(limit.w), t.hole_behind_w = std::move(limit.behind_w);
  if (!setup.objects.empty()) {
    BackgroundView room = setup.background;
    const Image<float> room_m = without_wrapped(room.depth_m, room.depth_sigma_m);
    room.depth_m = room_m;
    t.edge_depth_m = depth_at_color_edges(room, t.tof_footprint_px);
  }
  if (setup.objects.empty() || (setup.light.lamps.empty() && !setup.light.contact)) {
    t.background_normal = normals(setup.background.depth_m, setup.view, 2 * radius_px);
    return t;
  }
  const ImageView<const float> room_m =
      t.edge_depth_m.empty() ? setup.background.depth_m : t.edge_depth_m.view();
  const std::vector<ObjectFoot> feet =
      setup.first_pose ? feet_of(setup.objects, geometry::inverse(*setup.first_pose))
                       : std::vector<ObjectFoot>();
  LightSurface surface = light_surface(room_m, setup.view, t.correct.noise, radius_px, feet);
  t.light_depth_m = std::move(surface.depth_m), t.background_normal = std::move(surface.normal);
  return t;
}

}  // namespace mixrig::render
