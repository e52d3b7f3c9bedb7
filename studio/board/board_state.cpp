// SPDX-License-Identifier: Apache-2.0
#include "studio/board/board_state.h"

#include <cmath>

#include "studio/board/board_options.h"
#include "studio/sensors/lens.h"
#include "studio/stage/layout.h"

namespace mixrig::studio {
namespace {

/// The room without furniture within 3.2 m of the camera, which could occlude the board.
Mesh unoccluding_room(const Vec3& eye) {
  const Mesh full = build_room({});
  Mesh mesh = full;
  mesh.indices.clear(), mesh.materials.clear();
  for (std::size_t t = 0; t < full.materials.size(); ++t) {
    const Kind kind = full.materials[t].kind;
    bool stays = kind == Kind::kFloor || kind == Kind::kWall || kind == Kind::kCeiling ||
                 kind == Kind::kLamp;
    if (!stays) {
      stays = true;
      for (int k = 0; k < 3; ++k)
        stays = stays && (full.positions[full.indices[3 * t + k]] - eye).norm() > 3.2F;
    }
    if (!stays) continue;
    mesh.materials.push_back(full.materials[t]);
    mesh.indices.insert(mesh.indices.end(), full.indices.begin() + 3 * t,
                        full.indices.begin() + 3 * t + 3);
  }
  return mesh;
}

RayFunction pinhole_rays(const Optics& optics) {
  return [optics](double u, double v, Eigen::Vector3d& ray) {
    const Eigen::Vector2d ideal =
        undistort(optics, {(u - optics.cx_px) / optics.fx_px, (v - optics.cy_px) / optics.fy_px});
    ray = Eigen::Vector3d(ideal.x(), ideal.y(), 1).normalized();
    return true;
  };
}

RayFunction fisheye_rays(const FisheyeOptics& optics) {
  return
      [optics](double u, double v, Eigen::Vector3d& ray) { return fisheye_ray(optics, u, v, ray); };
}

/// Sensor with `factor` times the relative noise: it collects 1 / factor^2 times the electrons.
TofSensor noisier(TofSensor sensor, double factor) {
  const auto gain = static_cast<float>(1 / std::pow(std::max(factor, 0.01), 2));
  for (float* charge :
       {&sensor.signal_e, &sensor.background_e, &sensor.full_well_e, &sensor.least_amplitude_e})
    *charge *= gain;
  sensor.read_noise_e *= std::sqrt(gain);
  return sensor;
}

Light room_light() {
  StudioOptions options;
  options.scenario = Scenario::kStill;
  return make_layout(options).light;
}

}  // namespace

BoardStudio::State::State(const BoardOptions& o, const TraceDevice& device)
    : info(board_info_of(o)),
      light(room_light()),
      lamps(light),
      materials(o.seed, choose_wardrobe(o.seed, false), nullptr),
      pattern(o.board),
      crew(o.threads),
      room(device),
      board(device),
      target(o.size_px, pinhole_rays(info.rig.target), o.blur_px),
      fisheye(info.rig.fisheye.size_px, fisheye_rays(info.rig.fisheye), o.blur_px),
      tof(noisier(info.rig.tof, o.noise), pinhole_rays(info.rig.tof.optics), o.blur_px, 0xB070F0),
      behind_target(o.size_px),
      behind_fisheye(info.rig.fisheye.size_px) {
  const StudioOptions options;
  const Layout layout = make_layout(options);
  rest = geometry::look_at(layout.eye_m, layout.look_at_m, Eigen::Vector3d::UnitZ());
  Mesh shell = unoccluding_room(layout.eye_m.cast<float>()), sheet = build_board(o.board);
  room.set(shell);
  board.set(sheet);
  if (const auto& second = info.rig.tof2)
    tof2.emplace(noisier(*second, o.noise), pinhole_rays(second->optics), o.blur_px, 0xB071F1);
}

void BoardStudio::State::turn_to(const BoardPlace& place) {
  world_from_target = rest * rest_from_turned(info.rig.pan_tilt, place.pan_rad, place.tilt_rad);
  if (place.pan_rad == pan_rad && place.tilt_rad == tilt_rad) return;
  pan_rad = place.pan_rad, tilt_rad = place.tilt_rad;
  behind_target.forget(), behind_fisheye.forget(), tof.behind.forget();
  if (tof2) tof2->behind.forget();
}

}  // namespace mixrig::studio
