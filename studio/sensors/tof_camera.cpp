// SPDX-License-Identifier: Apache-2.0
// The studio's ToF camera.
#include "studio/sensors/tof_camera.h"

#include <algorithm>
#include <cmath>

namespace mixrig::studio {
namespace {

constexpr int kTofBand = 8;
constexpr float kMirrored = 0.85F;  ///< share of infrared light that a mirror reflects

Rect united(const Rect& a, const Rect& b) {
  if (a.empty()) return b;
  if (b.empty()) return a;
  return {std::min(a.x0, b.x0), std::min(a.y0, b.y0), std::max(a.x1, b.x1), std::max(a.y1, b.y1)};
}

float sub_offset(int i, int side) {
  return (static_cast<float>(i) + 0.5F) / static_cast<float>(side) - 0.5F;
}

/// Position of a pixel relative to the person's silhouette.
enum class Region { kOutside, kInside, kEdge };

Region region_of(const float* person_z, Size size, int x, int y) {
  float low = kMiss, high = 0;
  for (int j = std::max(0, y - 1); j <= std::min(size.height - 1, y + 1); ++j)
    for (int i = std::max(0, x - 1); i <= std::min(size.width - 1, x + 1); ++i) {
      const float z = person_z[static_cast<std::size_t>(j) * size.width + i];
      low = std::min(low, z), high = std::max(high, z);
    }
  if (low == kMiss) return Region::kOutside;
  return high - low < 0.06F ? Region::kInside : Region::kEdge;
}

}  // namespace

TofCamera::TofCamera(const TofSensor& sensor, unsigned seed, bool raw)
    : sensor_(sensor), seed_(seed), raw_(raw), grid_(sensor.optics) {
  const std::size_t pixels = sensor.optics.size_px.area();
  room_rays_.resize(pixels * kSubRays);
  room_echo_.resize(pixels);
  for (auto& z : person_z_) z.assign(pixels, kMiss);
}

TofCamera::SubRay TofCamera::cast(const TraceScene& scene, const Materials& materials, float u,
                                  float v) const {
  Hit hit;
  const Vec3 direction = rays_.direction(u, v);
  if (!scene.intersect(rays_.position, direction, kMiss, hit)) return {kMiss, 0, 0, Vec3::Zero()};
  if (hit.material.kind == Kind::kMirror) return by_mirror(scene, materials, direction, hit);
  const Vec3 visible = materials.albedo(hit.material, hit.uv, rays_.position + hit.t * direction);
  const float length = direction.norm();
  // From a light source at the lens, light travels along the ray in both directions.
  float distance = hit.t * length;
  if (sensor_.light_x_m != 0)
    distance = 0.5F * (distance + (rays_.position + hit.t * direction - light_at_).norm());
  return {distance, materials.infrared(hit.material, visible), -hit.normal.dot(direction) / length,
          hit.normal};
}

TofCamera::SubRay TofCamera::by_mirror(const TraceScene& scene, const Materials& materials,
                                       const Vec3& direction, const Hit& mirror) const {
  const Vec3 at = rays_.position + mirror.t * direction + kShadowOffset_m * mirror.face;
  const Vec3 on = direction - 2 * direction.dot(mirror.normal) * mirror.normal;
  Hit hit;
  if (!scene.intersect(at, on, kMiss, hit)) return {kMiss, 0, 0, Vec3::Zero()};
  const float length = direction.norm();
  const float albedo =
      materials.infrared(hit.material, materials.albedo(hit.material, hit.uv, at + hit.t * on));
  return {(mirror.t + hit.t) * length, kMirrored * kMirrored * albedo,
          std::abs(hit.normal.dot(on)) / length, Vec3::Zero()};
}

Echo TofCamera::outside_echo(const TraceScene& person, const Materials& materials, int x,
                             int y) const {
  const std::size_t pixel = static_cast<std::size_t>(y) * sensor_.optics.size_px.width + x;
  const SubRay& seen = room_rays_[pixel * kSubRays + kSubRays / 2];
  const bool by_a_mirror = seen.distance_m < kMiss && seen.normal.isZero();
  if (!by_a_mirror || person.empty()) return room_echo_[pixel];
  Hit mirror;
  const Vec3 direction = rays_.direction(static_cast<float>(x), static_cast<float>(y));
  if (!room_->intersect(rays_.position, direction, kMiss, mirror)) return room_echo_[pixel];
  const SubRay ray = by_mirror(person, materials, direction, mirror);
  return ray.distance_m < seen.distance_m ? echo(ray) : room_echo_[pixel];
}

Echo TofCamera::echo(const SubRay& ray) const {
  return ray.distance_m < kMiss ? echo_of(sensor_, ray.distance_m, ray.albedo, ray.cosine) : Echo{};
}

void TofCamera::trace_room(const TraceScene& room, const Materials& materials,
                           const geometry::Pose& world_from_tof, Crew& crew) {
  world_from_tof_ = world_from_tof;
  room_ = &room;
  rays_ = camera_rays(grid_, world_from_tof);
  light_at_ = (world_from_tof * Eigen::Vector3d(sensor_.light_x_m, 0, 0)).cast<float>();
  const Size size = sensor_.optics.size_px;
  crew.rows(size.height, kTofBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const std::size_t pixel = static_cast<std::size_t>(y) * size.width + x;
        Echo sum;
        for (int i = 0; i < kSubRays; ++i) {
          const SubRay ray =
              cast(room, materials, static_cast<float>(x) + sub_offset(i % kSide, kSide),
                   static_cast<float>(y) + sub_offset(i / kSide, kSide));
          room_rays_[pixel * kSubRays + i] = ray;
          sum += echo(ray);
        }
        room_echo_[pixel] = sum * (1.0F / kSubRays);
      }
  });
  if (sensor_.multipath)
    multipath_.build({&room, nullptr, &materials, &sensor_, world_from_tof}, rays_, size, crew);
}

Echo TofCamera::mixed_echo(const TraceScene& person, const Materials& materials, int x,
                           int y) const {
  const std::size_t pixel = static_cast<std::size_t>(y) * sensor_.optics.size_px.width + x;
  Echo sum;
  for (int i = 0; i < kSubRays; ++i) {
    const SubRay& room = room_rays_[pixel * kSubRays + i];
    const SubRay ray = cast(person, materials, static_cast<float>(x) + sub_offset(i % kSide, kSide),
                            static_cast<float>(y) + sub_offset(i / kSide, kSide));
    sum += echo(ray.distance_m < room.distance_m ? ray : room);
  }
  return sum * (1.0F / kSubRays);
}

Echo TofCamera::tap_echo(const TraceScene& person, const Materials& materials,
                         const float* person_z, int x, int y) const {
  const std::size_t pixel = static_cast<std::size_t>(y) * sensor_.optics.size_px.width + x;
  switch (region_of(person_z, sensor_.optics.size_px, x, y)) {
    case Region::kOutside:
      return outside_echo(person, materials, x, y);
    case Region::kEdge:
      return mixed_echo(person, materials, x, y);
    case Region::kInside:
      break;
  }
  const SubRay ray = cast(person, materials, static_cast<float>(x), static_cast<float>(y));
  const SubRay& room = room_rays_[pixel * kSubRays + kSubRays / 2];
  return ray.distance_m < room.distance_m ? echo(ray) : room_echo_[pixel];
}

void TofCamera::find_people(const Shot& shot, const Rect& rect, Crew& crew) {
  const Size size = sensor_.optics.size_px;
  crew.rows(size.height, kTofBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (std::size_t k = 0; k < 4; ++k) {
        float* row = &person_z_[k][static_cast<std::size_t>(y) * size.width];
        std::fill_n(row, size.width, kMiss);
        if (y < rect.y0 || y >= rect.y1) continue;
        Hit hit;
        for (int x = rect.x0; x < rect.x1; ++x)
          if (shot.person[k].intersect(
                  rays_.position, rays_.direction(static_cast<float>(x), static_cast<float>(y)),
                  kMiss, hit))
            row[x] = hit.t;
      }
  });
}

Echo TofCamera::bounced(const TraceScene& person, const Materials& materials, int x, int y) const {
  const std::size_t pixel = static_cast<std::size_t>(y) * sensor_.optics.size_px.width + x;
  const auto u = static_cast<float>(x), v = static_cast<float>(y);
  SubRay seen = room_rays_[pixel * kSubRays + kSubRays / 2];
  if (person_z_[2][pixel] < kMiss) {
    const SubRay before = cast(person, materials, u, v);
    if (before.distance_m < seen.distance_m) seen = before;
  }
  if (seen.distance_m >= kMiss || seen.normal.isZero()) return {};
  const Vec3 position = rays_.position + seen.distance_m * rays_.direction(u, v).normalized();
  return seen_from(sensor_, multipath_.at(u, v, position, seen.normal), seen.distance_m,
                   seen.albedo);
}

void TofCamera::collect_taps(const Shot& shot, const Materials& materials, const Rect& rect,
                             Crew& crew) {
  const Size size = sensor_.optics.size_px;
  taps_.resize(size.area());
  crew.rows(size.height, kTofBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const std::size_t pixel = static_cast<std::size_t>(y) * size.width + x;
        std::array<Echo, 4>& taps = taps_[pixel];
        taps.fill(room_echo_[pixel]);
        const bool near = x >= rect.x0 && x < rect.x1 && y >= rect.y0 && y < rect.y1;
        const SubRay& seen = room_rays_[pixel * kSubRays + kSubRays / 2];
        if (near || (seen.normal.isZero() && seen.distance_m < kMiss))
          for (std::size_t k = 0; k < 4; ++k)
            taps[k] = tap_echo(shot.person[k], materials, person_z_[k].data(), x, y);
        if (!sensor_.multipath) continue;
        const Echo more = bounced(shot.person[2], materials, x, y);
        for (Echo& tap : taps) tap += more;
      }
  });
}

std::array<Echo, 4> TofCamera::mean_taps() const {
  std::array<Echo, 4> mean;
  const auto width = static_cast<std::size_t>(sensor_.optics.size_px.width);
  for (std::size_t row = 0; row < taps_.size(); row += width) {
    std::array<Echo, 4> sum;  // row by row, which keeps the rounding small
    for (std::size_t i = row; i < row + width; ++i)
      for (std::size_t k = 0; k < 4; ++k) sum[k] += taps_[i][k];
    for (std::size_t k = 0; k < 4; ++k) mean[k] += sum[k];
  }
  for (Echo& e : mean) e = e * (1 / static_cast<float>(taps_.size()));
  return mean;
}

void TofCamera::expose(const Shot& shot, const Materials& materials, Crew& crew) {
  Rect rect;
  for (const TraceScene& tap : shot.person)
    rect = united(rect, covered_by(tap.mesh(), sensor_.optics, world_from_tof_));
  find_people(shot, rect, crew);
  if (sensor_.multipath)
    multipath_.update({shot.room, &shot.at_middle->scene, &materials, &sensor_, world_from_tof_},
                      rays_, shot.at_middle->extent.whole, crew);
  collect_taps(shot, materials, rect, crew);
  if (sensor_.stray == 0) return;
  const std::array<Echo, 4> stray = mean_taps();
  crew.rows(sensor_.optics.size_px.height, kTofBand, [&](int begin, int end) {
    const auto width = static_cast<std::size_t>(sensor_.optics.size_px.width);
    for (std::size_t i = begin * width; i < end * width; ++i)
      for (std::size_t k = 0; k < 4; ++k) taps_[i][k] += stray[k] * sensor_.stray;
  });
}

void TofCamera::render_raw(const Shot& shot, const Materials& materials, Crew& crew,
                           const RawPictures& pictures, std::vector<std::uint8_t>& raw,
                           Image<float>& true_m) {
  expose(shot, materials, crew);
  pictures.expose(taps_, hash_key(seed_, static_cast<std::uint64_t>(shot.number)), shot.number,
                  shot.time_s + sensor_.delay_s, raw);
  const Size size = sensor_.optics.size_px;
  true_m.reset(size);
  crew.rows(size.height, kTofBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const Vec3 ray = rays_.direction(static_cast<float>(x), static_cast<float>(y));
        Hit hit;
        float t = shot.room->intersect(rays_.position, ray, kMiss, hit) ? hit.t : kMiss;
        const TraceScene& people = shot.at_middle->scene;
        if (people.intersect(rays_.position, ray, kMiss, hit)) t = std::min(t, hit.t);
        true_m.at(x, y) = t < kMiss ? t * ray.norm() : 0;
      }
  });
}

void TofCamera::render(const Shot& shot, const Materials& materials, Crew& crew,
                       Image<float>& distance_m, Image<float>& amplitude) {
  const Size size = sensor_.optics.size_px;
  distance_m.reset(size);
  amplitude.reset(size);
  const float counts_per_e = 65535.0F / sensor_.full_well_e;
  expose(shot, materials, crew);
  const float warm_m = warm_up_offset_m(sensor_, seed_, shot.time_s);
  crew.rows(size.height, kTofBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const std::size_t pixel = static_cast<std::size_t>(y) * size.width + x;
        const TofValue value = read_taps(
            sensor_, taps_[pixel], hash_key(seed_, static_cast<std::uint64_t>(shot.number), pixel),
            raw_, normal_, warm_m + pixel_offset_m(sensor_, seed_, pixel, normal_));
        distance_m.at(x, y) = value.distance_m;
        amplitude.at(x, y) = std::round(counts_per_e * value.amplitude_e);
      }
  });
}

}  // namespace mixrig::studio
