// SPDX-License-Identifier: Apache-2.0
// The ToF camera in the studio: sub-rays of every pixel, taps at four moments.
#pragma once

#include <array>

#include "hal/base/image.h"
#include "host/studio/surfels.h"
#include "host/studio/tof.h"

namespace mixrig::studio {

/// Renders ToF frames. Keeps the empty room's echoes while the camera stands still.
class TofCamera {
 public:
  TofCamera(const TofSensor& sensor, unsigned seed, bool raw);

  const TofSensor& sensor() const { return sensor_; }
  /// Traces the room for a camera place; once, or before every frame of a moving camera.
  void see_room(const TraceScene& room, const Materials& materials,
                const geometry::Pose& world_from_tof, Crew& crew);
  /// One frame. `person[k]` is the person at tap k.
  void render(std::span<const TraceScene, 4> person, const Materials& materials, int number,
              Crew& crew, Image<float>& distance_m, Image<float>& amplitude);

 private:
  static constexpr int kSide = 3, kSubRays = kSide * kSide;
  struct SubRay {
    float distance_m, albedo, cosine;
  };

  SubRay cast(const TraceScene& scene, const Materials& materials, float u, float v) const;
  Echo echo(const SubRay& ray) const;
  /// Echo of a pixel with the person before the room, at one tap.
  Echo mixed_echo(const TraceScene& person, const Materials& materials, int x, int y) const;
  Echo tap_echo(const TraceScene& person, const Materials& materials, const float* sight, int x,
                int y) const;

  TofSensor sensor_;
  unsigned seed_;
  bool raw_;
  NormalTable normal_;
  RayGrid grid_;
  Eye eye_;
  geometry::Pose world_from_tof_;
  std::vector<SubRay> room_rays_;
  std::vector<Echo> room_echo_;
  std::array<std::vector<float>, 4> sight_;
};

}  // namespace mixrig::studio
