// SPDX-License-Identifier: Apache-2.0
// The pictures and the truth of a frame, from what the cameras see.
#include <algorithm>
#include <bit>
#include <cmath>
#include <span>
#include <utility>

#include "studio/sensors/warp.h"
#include "studio/srgb.h"
#include "studio/studio_state.h"

namespace mixrig::studio {
namespace {

constexpr int kDrawBand = 4;
constexpr float kFullWell_e = 12000, kReadNoise_e = 8;  ///< colour sensor at exposure 1
constexpr int kMostShift_px = 24;                       ///< of the picture during an exposure

}  // namespace

bool visible_to_tof(const TofPlace& at, const Optics& optics, const Vec3& point,
                    const TraceScene& scene) {
  const Eigen::Vector3d in_tof = at.tof_from_world * point.cast<double>();
  if (in_tof.z() < 0.05) return false;
  if (std::abs(in_tof.x()) > 1.2 * in_tof.z() || std::abs(in_tof.y()) > 1.2 * in_tof.z())
    return false;
  const Eigen::Vector2d px = project(optics, in_tof);
  if (px.x() < 0 || px.y() < 0 || px.x() > optics.size_px.width - 1 ||
      px.y() > optics.size_px.height - 1)
    return false;
  const Vec3 eye = at.eye_m.cast<float>();
  const Vec3 towards = eye - point;
  return !scene.blocked(point + 3e-3F * towards.normalized(), eye);
}

bool Studio::State::tof_sees(const TofPlace& at, const Optics& optics, const Vec3& point, int x,
                             int y, bool of_room) const {
  const bool past_room =
      of_room ? at.sees_room.at(x, y) != 0 : visible_to_tof(at, optics, point, room);
  return past_room && (person.scene.empty() || visible_to_tof(at, optics, point, person.scene));
}

int Studio::State::noise_number(int frame) const {
  return frame ^ std::bit_cast<int>(exposed_by) ^ std::bit_cast<int>(1.0F);
}

void Studio::State::draw_color(Frame& frame) {
  frame.color.reset(options.size_px);
  const float exposure = exposed_by * static_cast<float>(info.light.exposure);
  const int number = noise_number(frame.number);
  crew.rows(options.size_px.height, kDrawBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < options.size_px.width; ++x) {
        const Vec3 light =
            exposure * compose_pixel(plate, x, y, lamps, ambient, casters, false).real;
        const std::uint64_t pixel =
            static_cast<std::uint64_t>(y) * 65536 + static_cast<unsigned>(x);
        const std::uint64_t bits =
            hash_key(hash_key(options.seed, 0xC0102), static_cast<std::uint64_t>(number), pixel);
        Vec3 noisy;
        for (int c = 0; c < 3; ++c) {
          const float charge = kFullWell_e * light[c];
          noisy[c] = (charge +
                      std::sqrt(charge + kReadNoise_e * kReadNoise_e) * normal(bits >> (12 * c))) /
                     kFullWell_e;
        }
        frame.color.at(x, y) = srgb_from_linear(noisy);
      }
  });
}

void Studio::State::expose_plate(const CameraPlace& place, double time_s) {
  const Size size = options.size_px;
  const Rect nothing;
  plate_z_m.reset(size), still.reset(size), exposed.reset(size);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x)
      plate_z_m.at(x, y) = std::min(plate.room.centre_z(x, y), plate.person.centre_z(x, y));
  // In slices the person is drawn later; its shadow stays that of mid-exposure.
  if (in_slices)
    plate.person.build(person.scene, materials, camera_rays(plate_rays, place.world_from_target),
                       nothing, crew);
  const auto exposure = static_cast<float>(info.light.exposure);
  crew.rows(size.height, kDrawBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const Vec3 c = exposure * compose_pixel(plate, x, y, lamps, ambient, casters, false).real;
        still.at(x, y) = {c[0], c[1], c[2]};
      }
  });
  if (!in_slices) return std::swap(still, exposed);
  for (int i = 0; i < shutter.slices(); ++i) {
    const Shutter::Rows rows = shutter.rows(i);
    const int margin = info.camera_moves ? kMostShift_px : 0;
    draw_slice(place, time_s + shutter.time_s(i), std::max(0, rows.first - margin),
               std::min(size.height, rows.end + margin));
    add_slice(place, time_s, i);
  }
}

void Studio::State::draw_slice(const CameraPlace& place, double time_s, int first_row,
                               int end_row) {
  slice = still;
  if (person.scene.empty()) return;
  fill_person(moment, time_s);
  Rect rect = covered_by(moment.scene.mesh(), info.target, place.world_from_target);
  rect.y0 = std::max(rect.y0, first_row), rect.y1 = std::min(rect.y1, end_row);
  const std::vector<std::uint8_t> thin =
      touched_by_thin(moment.scene.mesh(), info.target, place.world_from_target, rect);
  plate.person.build(moment.scene, materials, camera_rays(plate_rays, place.world_from_target),
                     rect, crew, &thin);
  ShadowCasters then = casters;
  then.person = &moment;
  light_surfels(plate.person, lamps, then, false, true, crew);
  if (options.realism.bounce) bounce_surfels(plate.person, person_bounce, crew);
  if (options.props && casters.reflector != nullptr)
    mirror_surfels(plate.person, reflector, false, crew);
  const auto exposure = static_cast<float>(info.light.exposure);
  crew.rows(std::max(0, rect.y1 - rect.y0), kDrawBand, [&](int begin, int end) {
    for (int y = rect.y0 + begin; y < rect.y0 + end; ++y)
      for (int x = rect.x0; x < rect.x1; ++x) {
        const Rgbf& behind = still.at(x, y);
        const Vec3 c = exposure * with_person(plate, x, y, lamps, ambient, casters,
                                              Vec3(behind.r, behind.g, behind.b) / exposure);
        slice.at(x, y) = {c[0], c[1], c[2]};
      }
  });
}

void Studio::State::add_slice(const CameraPlace& place, double frame_s, int number) {
  const Size size = options.size_px;
  const Shutter::Rows rows = shutter.rows(number);
  geometry::Pose mid_from_then;
  if (info.camera_moves)
    mid_from_then = geometry::inverse(place.world_from_target) *
                    eye_at(frame_s + shutter.time_s(number)).world_from_target;
  crew.rows(std::max(0, rows.end - rows.first), kDrawBand, [&](int begin, int end) {
    for (int y = rows.first + begin; y < rows.first + end; ++y) {
      const float weight = shutter.weight(y, number);
      for (int x = 0; x < size.width; ++x) {
        Vec2 at(static_cast<float>(x), static_cast<float>(y));
        if (info.camera_moves)
          at = seen_from(plate_rays, info.target, mid_from_then, at, plate_z_m.at(x, y));
        const Rgbf c = sample(slice, at);
        Rgbf& sum = exposed.at(x, y);
        sum.r += weight * c.r, sum.g += weight * c.g, sum.b += weight * c.b;
      }
    }
  });
}

void Studio::State::draw_truth(const CameraPlace& place, Truth& truth) {
  const Size size = options.size_px;
  truth.depth_m.reset(size), truth.background_depth_m.reset(size), truth.matte.reset(size);
  truth.light.reset(size), truth.composite.reset(size), truth.labels.reset(size);
  const CameraRays rays = camera_rays(view_rays, place.world_from_target);
  const auto exposure = static_cast<float>(info.light.exposure);
  crew.rows(size.height, kDrawBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const Pixel p = compose_pixel(view, x, y, lamps, ambient, casters, true);
        const float behind = view.room.centre_z(x, y), before = view.person.centre_z(x, y);
        const float z = std::min(behind, before);
        const Vec3 point =
            rays.position + z * rays.direction(static_cast<float>(x), static_cast<float>(y));
        const bool of_room = !(before < behind);
        const bool seen = tof_sees(tof_at, info.tof.optics, point, x, y, of_room);
        const bool seen2 = tof2 && tof_sees(tof2->place, info.tof2->optics, point, x, y, of_room);
        truth.depth_m.at(x, y) = z < kMiss ? z : 0;
        truth.background_depth_m.at(x, y) = behind < kMiss ? behind : 0;
        truth.matte.at(x, y) = static_cast<std::uint8_t>(std::lround(255 * p.person));
        truth.light.at(x, y) = std::min(p.light, 1.0F);  // takes cannot tell more
        truth.composite.at(x, y) = srgb_from_linear(Vec3(exposure * p.mixed));
        truth.labels.at(x, y) = static_cast<std::uint8_t>(
            p.layer | (seen ? Truth::kTofSees : 0) | (seen2 ? Truth::kTof2Sees : 0) |
            (p.silhouette >= 0.5F ? Truth::kSilhouette : 0));
      }
  });
}

void Studio::State::place_people_truth(double time_s, Truth& truth) {
  const double at_s = people_time_s(time_s);
  for (const PersonMotion& motion : cast.people()) {
    const Vec3 pelvis = motion.at(at_s).pelvis;
    truth.people.push_back({{pelvis.x(), pelvis.y()}});
  }
  const Mesh& mesh = person.scene.mesh();
  for (std::size_t t = 0; t < mesh.materials.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      double& top_m = truth.people[mesh.materials[t].person].top_m;
      top_m = std::max<double>(top_m, mesh.positions[mesh.indices[3 * t + k]].z());
    }
  const Rect& rect = view.person.rect();
  for (int y = rect.y0; y < rect.y1; ++y)
    for (int x = rect.x0; x < rect.x1; ++x) {
      const float z = view.person.centre_z(x, y);
      if (!(z < view.room.centre_z(x, y))) continue;
      const std::span<const Surfel> seen = std::as_const(view.person).at(x, y);
      if (seen.empty()) continue;  // a strand that no sub-sample meets
      const auto nearest = std::min_element(
          seen.begin(), seen.end(), [](const Surfel& a, const Surfel& b) { return a.z < b.z; });
      truth.people[nearest->person].visible_m2 += z * z / (info.view.fx_px * info.view.fy_px);
    }
}

}  // namespace mixrig::studio
