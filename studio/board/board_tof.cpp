// SPDX-License-Identifier: Apache-2.0
// Renders the board and the room behind it for the depth camera.
#include <algorithm>
#include <cmath>

#include "studio/board/board_state.h"

namespace mixrig::studio {
namespace {

/// The distance in whole units of the sensor, metres; 0 where it is unknown.
float in_units(const TofSensor& sensor, float distance_m) {
  const double unit_m = sensor.unit_m;
  return distance_m > 0 ? static_cast<float>(unit_m * std::round(distance_m / unit_m)) : 0;
}

constexpr float kPaperInfrared = 0.75F, kInkInfrared = 0.10F;

}  // namespace

Echo BoardStudio::State::background_echo(const TofSensor& sensor, const Eigen::Vector3f& ray,
                                         const geometry::Pose& world_from_tof) const {
  const Vec3 eye = world_from_tof.translation_m.cast<float>();
  const Vec3 direction = (world_from_tof.rotation * ray.cast<double>()).cast<float>();
  Hit hit;
  if (!room.intersect(eye, direction, 1e9F, hit)) return {};
  const Vec3 visible = materials.albedo(hit.material, hit.uv, eye + hit.t * direction);
  return echo_of(sensor, hit.t, materials.infrared(hit.material, visible),
                 -hit.normal.dot(direction));
}

Echo BoardStudio::State::board_echo(BoardTof& of, const BoardPixel& p, std::size_t index, int x,
                                    int y, const geometry::Pose& world_from_tof) {
  Echo echo;
  if (p.board < 1)
    echo += of.behind.at(index, [&] {
      return background_echo(of.sensor, of.camera.ray(x, y), world_from_tof);
    }) * (1 - p.board);
  if (p.board > 0)
    echo += echo_of(of.sensor, p.distance_m,
                    kInkInfrared * (p.board - p.paper) + kPaperInfrared * p.paper, p.cosine);
  return echo;
}

void BoardStudio::State::draw_tof(BoardTof& of, Poses poses, int number, Image<float>& distance_m,
                                  Image<float>& amplitude) {
  const TofSensor& sensor = of.sensor;
  const geometry::Pose tof_from_target = geometry::inverse(sensor.target_from_tof);
  const geometry::Pose world_from_tof = world_from_target * sensor.target_from_tof;
  const Size size = of.camera.size_px();
  distance_m.reset(size), amplitude.reset(size);
  for (std::size_t t = 0; t < poses.size(); ++t) {
    of.camera.trace(board, pattern, tof_from_target * poses[t], steps_of(poses), crew, pixels);
    of.taps[t].resize(size.area());
    crew.rows(size.height, kBoardBand, [&](int begin, int end) {
      for (int y = begin; y < end; ++y)
        for (int x = 0; x < size.width; ++x) {
          const std::size_t index = static_cast<std::size_t>(y) * size.width + x;
          of.taps[t][index] = board_echo(of, pixels[index], index, x, y, world_from_tof);
        }
    });
  }
  const auto tap = [&](std::size_t t, std::size_t index) {
    return of.taps[poses.size() == 1 ? 0 : t][index];
  };
  const float counts_per_e = 65535.0F / sensor.full_well_e;
  crew.rows(size.height, kBoardBand, [&](int begin, int end) {
    for (int y = begin; y < end; ++y)
      for (int x = 0; x < size.width; ++x) {
        const std::size_t index = static_cast<std::size_t>(y) * size.width + x;
        const TofValue value = read_taps(
            sensor, {tap(0, index), tap(1, index), tap(2, index), tap(3, index)},
            hash_key(info.options.seed, static_cast<std::uint64_t>(number) + of.salt, index), true,
            normal);
        distance_m.at(x, y) = in_units(sensor, value.distance_m);
        amplitude.at(x, y) = std::round(counts_per_e * value.amplitude_e);
      }
  });
}

}  // namespace mixrig::studio
