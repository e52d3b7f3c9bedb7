// SPDX-License-Identifier: Apache-2.0
// The fisheye's pictures at their own times.
#include <array>
#include <cmath>

#include "studio/studio_state.h"

namespace mixrig::studio {
namespace {

constexpr double kFisheyeRate_hz = 10, kFisheyeExposure_s = 8e-3;
constexpr double kFisheyeLag_s = 0.0137;  ///< of picture 1 behind frame 1
constexpr std::uint64_t kFisheyeNoise = 0xF15E;
/// Four moments of an exposure, each through another part of the pixel.
constexpr int kSamples = 4;
constexpr std::array<std::array<double, 2>, kSamples> kInPixel{
    {{-0.125, -0.375}, {0.375, -0.125}, {-0.375, 0.125}, {0.125, 0.375}}};

double fisheye_time_s(const StudioInfo& info, int number) {
  return (number - 1) / info.fisheye_rate_hz + kFisheyeLag_s;
}
int nearest_frame(double time_s) {
  return static_cast<int>(std::lround(time_s * kFrameRate_hz)) + 1;
}

}  // namespace

void describe_fisheye(const StudioOptions& options, const Rig& rig, StudioInfo& info) {
  info.fisheye = {scaled(rig.fisheye, options.fisheye_px), rig.target_from_fisheye};
  if (!options.fisheye) return;
  info.fisheye_rate_hz =
      options.scenario == Scenario::kSweep || options.scenario == Scenario::kStarts
          ? kFrameRate_hz
          : kFisheyeRate_hz;
  while (nearest_frame(fisheye_time_s(info, info.fisheye_pictures + 1)) <= info.frames)
    ++info.fisheye_pictures;
}

void Studio::State::expose_fisheye(double time_s, const FisheyeSample& sample) {
  spare.clear();
  if (time_s * kFrameRate_hz >= info.empty_frames) cast.build(people_time_s(time_s), spare);
  person.set(spare);
  const CameraPlace place = camera_at(layout, options, time_s);
  add_fisheye_light(info.fisheye.optics, sample,
                    place.world_from_target * info.fisheye.target_from_fisheye, room, casters,
                    materials, lamps, light_now, crew, fisheye_light, fisheye_people);
}

int Studio::fisheye_frame(int number) const {
  return nearest_frame(fisheye_time_s(state_->info, number));
}

void Studio::render_fisheye(int number, FisheyePicture& out) {
  State& s = *state_;
  out.number = number;
  out.time_s = fisheye_time_s(s.info, number);
  out.frame = fisheye_frame(number);
  s.options.sweep.moved_s = out.time_s;
  s.set_time(out.time_s);
  out.world_from_fisheye = camera_at(s.layout, s.options, out.time_s).world_from_target *
                           s.info.fisheye.target_from_fisheye;
  s.fisheye_light.reset(s.info.fisheye.optics.size_px);
  s.fisheye_people = 0;
  if (s.options.realism.motion_blur)
    for (int k = 0; k < kSamples; ++k)
      s.expose_fisheye(out.time_s + ((k + 0.5) / kSamples - 0.5) * kFisheyeExposure_s,
                       {kInPixel[static_cast<std::size_t>(k)][0],
                        kInPixel[static_cast<std::size_t>(k)][1], 1.0F / kSamples});
  else
    s.expose_fisheye(out.time_s, {});
  out.people_share = s.fisheye_people;
  const std::uint64_t key = hash_key(s.options.seed, kFisheyeNoise, static_cast<unsigned>(number));
  develop_fisheye(s.info.fisheye.optics, s.fisheye_light, key, s.normal, s.crew, out.picture);
}

}  // namespace mixrig::studio
