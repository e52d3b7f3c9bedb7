// SPDX-License-Identifier: Apache-2.0
// The studio's ToF camera: sub-rays of every pixel, four taps at four times.
#pragma once

#include <array>

#include "hal/base/image.h"
#include "studio/sensors/multipath.h"
#include "studio/sensors/picture.h"
#include "studio/sensors/raw_pictures.h"
#include "studio/sensors/tof.h"

namespace mixrig::studio {

/// Renders ToF frames. Reuses the empty room's echoes while the camera does not move.
class TofCamera {
 public:
  TofCamera(const TofSensor& sensor, unsigned seed, bool raw);

  const TofSensor& sensor() const { return sensor_; }
  /// Traces the room from a camera pose: once, or before every frame if the camera moves.
  void trace_room(const TraceScene& room, const Materials& materials,
                  const geometry::Pose& world_from_tof, Crew& crew);
  /// Content of a frame.
  struct Shot {
    std::span<const TraceScene, 4> person;  ///< at each tap
    const Occluder* at_middle = nullptr;    ///< the person, for the bounced light
    const TraceScene* room = nullptr;
    int number = 0;
    double time_s = 0;
  };
  void render(const Shot& shot, const Materials& materials, Crew& crew, Image<float>& distance_m,
              Image<float>& amplitude);
  /// Renders the frame as raw pictures, for a sensor of raw_sensor(). `true_m`: as
  /// Frame::tof_true_m.
  void render_raw(const Shot& shot, const Materials& materials, Crew& crew,
                  const RawPictures& pictures, std::vector<std::uint8_t>& raw,
                  Image<float>& true_m);

 private:
  static constexpr int kSide = 3, kSubRays = kSide * kSide;
  struct SubRay {
    float distance_m, albedo, cosine;
    Vec3 normal = Vec3::Zero();  ///< of the surface; zero by way of a mirror
  };

  SubRay cast(const TraceScene& scene, const Materials& materials, float u, float v) const;
  /// Surface that a ray meets after a mirror, at the length of the whole way, as if it lay behind
  /// the mirror.
  SubRay by_mirror(const TraceScene& scene, const Materials& materials, const Vec3& direction,
                   const Hit& mirror) const;
  /// Outside the person's silhouette, where a mirror can still show the person.
  Echo outside_echo(const TraceScene& person, const Materials& materials, int x, int y) const;
  Echo echo(const SubRay& ray) const;
  /// Mean echo of a pixel's sub-rays on person and room, at one tap.
  Echo mixed_echo(const TraceScene& person, const Materials& materials, int x, int y) const;
  Echo tap_echo(const TraceScene& person, const Materials& materials, const float* person_z, int x,
                int y) const;
  void find_people(const Shot& shot, const Rect& rect, Crew& crew);
  /// Bounced light on what a pixel shows at the first tap after the middle.
  Echo bounced(const TraceScene& person, const Materials& materials, int x, int y) const;
  void collect_taps(const Shot& shot, const Materials& materials, const Rect& rect, Crew& crew);
  /// Mean of all pixels, of each tap.
  std::array<Echo, 4> mean_taps() const;
  /// Light of all pixels at each tap, with bounced and stray light.
  void expose(const Shot& shot, const Materials& materials, Crew& crew);

  TofSensor sensor_;
  unsigned seed_;
  bool raw_;
  NormalTable normal_;
  RayGrid grid_;
  CameraRays rays_;
  Vec3 light_at_ = Vec3::Zero();  ///< the light source, world
  geometry::Pose world_from_tof_;
  const TraceScene* room_ = nullptr;
  std::vector<SubRay> room_rays_;
  std::vector<Echo> room_echo_;
  Multipath multipath_;
  std::vector<std::array<Echo, 4>> taps_;
  std::array<std::vector<float>, 4> person_z_;  ///< of the person at each tap, kMiss outside
};

}  // namespace mixrig::studio
