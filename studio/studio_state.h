// SPDX-License-Identifier: Apache-2.0
// State of a studio between frames. Private to this module.
#pragma once

#include "studio/people/cast.h"
#include "studio/rig_of_seed.h"
#include "studio/sensors/color_camera.h"
#include "studio/sensors/fisheye.h"
#include "studio/sensors/picture.h"
#include "studio/sensors/shutter.h"
#include "studio/sensors/tof_camera.h"
#include "studio/sensors/zoom_lens.h"
#include "studio/stage/layout.h"

namespace mixrig::studio {

/// Pose of a ToF camera while a frame is rendered.
struct TofPlace {
  Eigen::Vector3d eye_m;
  geometry::Pose tof_from_world;
  Image<std::uint8_t> sees_room;  ///< room surfaces of the view that it sees, without people
};

/// True if the point projects into the ToF picture and nothing of `scene` occludes it.
bool visible_to_tof(const TofPlace& at, const Optics& optics, const Vec3& point,
                    const TraceScene& scene);

/// StudioOptions::second_tof.
struct SecondTofCamera {
  SecondTofCamera(const TofSensor& sensor, unsigned seed, bool raw, const TraceDevice& device);
  TofCamera camera;
  std::array<TraceScene, 4> taps;
  TofPlace place;
};

/// Sets what `info` says of the fisheye; its frames must be set.
void describe_fisheye(const StudioOptions& options, const Rig& rig, StudioInfo& info);

struct Studio::State {
  State(const StudioOptions& o, const TraceDevice& device);

  /// Room and light of a time, where the day changes them.
  void set_time(double time_s);
  /// Time of the people at a time of the take: in a sweep the head has turned between views.
  double people_time_s(double time_s) const;
  /// Builds the person of a frame: at mid-exposure and at the times of the four ToF taps.
  void place_person(int number, double time_s);
  /// The person at a time, whether present in the frame or not.
  void fill_person(Occluder& scene, double time_s);
  /// Light of the fisheye from where the camera and the people are at a time, added to `light`.
  void expose_fisheye(double time_s, const FisheyeSample& sample);
  /// Sets the optics of the target camera at a time; what was traced through others is dropped.
  void set_lens(double time_s);
  /// Pose of the target camera's entrance pupil, with the lens that is set.
  CameraPlace eye_at(double time_s) const;
  /// Traces and lights the parts that do not move, unless they are cached.
  void trace_static(const CameraPlace& place, double time_s, bool with_truth);
  /// Places a ToF camera and traces the room from it.
  void trace_tof(double time_s, const geometry::Pose& target_from_tof, TofCamera& of, TofPlace& at);
  void find_room_seen(const CameraRays& rays, const Optics& optics, TofPlace& at);
  /// Mirrored and bounced light of the room or the object.
  void reflect_static(SurfelMap& map, const BounceCache& bounce, bool with_object);
  void bounce_on_person(const CameraPlace& place);
  void place_people_truth(double time_s, Truth& truth);
  void trace_bounce(const CameraPlace& place);
  /// Splits the take's ambient light into what is bounced and the rest.
  void balance_ambient();
  void trace_person(const CameraPlace& place, const RayGrid& rays, const Optics& optics,
                    SceneSurfels& surfels, bool with_object);
  /// Number of a frame for its noise, which is another one at another exposure.
  int noise_number(int frame) const;
  /// The room alone as a pinhole camera sees it, linear, with the take's exposure.
  void draw_room(const Optics& optics, const geometry::Pose& world_from_camera, Image<Rgbf>& light);
  /// The plain picture: no effect of the camera but noise.
  void draw_color(Frame& frame);
  /// Linear light of the plate with what moves during its exposure.
  void expose_plate(const CameraPlace& place, double time_s);
  /// Light of room and person at one time, in the geometry of mid-exposure, for some rows.
  void draw_slice(const CameraPlace& place, double time_s, int first_row, int end_row);
  /// Adds a slice to the rows that are exposed in it, from where the camera is then.
  void add_slice(const CameraPlace& place, double frame_s, int slice);
  void draw_truth(const CameraPlace& place, Truth& truth);
  /// Whether a surface point of the view is seen; `of_room`: it is one of the room.
  bool tof_sees(const TofPlace& at, const Optics& optics, const Vec3& point, int x, int y,
                bool of_room) const;
  /// Draws the composite through the lens of StudioOptions::lens.
  void draw_through_lens(const CameraPlace& place, Image<Rgb8>& composite);

  StudioOptions options;
  Layout layout;
  Rig rig;
  StudioInfo info;
  Materials materials;
  LampSet lamps;
  Cast cast;
  Crew crew;
  TraceScene room;
  Occluder furniture, object, person;
  Occluder moment;  ///< the person at another time of the exposure
  std::array<TraceScene, 4> taps;
  ShadowCasters casters;
  Vec3 ambient;  ///< light from nowhere; the rest of info.light.ambient is bounced
  Vec3 ambient_lit, reflected_lit;  ///< it, and that of the reflector, while the lamps are on
  Light light_now;                  ///< at the time of the frame
  bool lights_on = true, is_dim = false;
  Reflector reflector;  ///< as the target camera sees it
  BounceCache room_bounce, object_bounce, person_bounce;
  ZoomLens zoom;
  double pupil_shift_m = 0;  ///< of the lens that is set
  float exposed_by = 1;      ///< light of the plates over that at rest
  RayGrid plate_rays, view_rays;
  TofCamera tof;
  std::optional<RawPictures> raw;  ///< of StudioOptions::raw
  std::unique_ptr<SecondTofCamera> tof2;
  ColorCamera camera;
  Shutter shutter;
  bool in_slices = false;  ///< the exposure takes time
  SceneSurfels plate, view;
  bool has_plate = false, has_view = false;
  std::array<geometry::Pose, 3> traced_from;  ///< of the target camera, at the times of each camera
  TofPlace tof_at;
  NormalTable normal;
  Image<Rgbf> still, slice, exposed;  ///< of the plate: without people, at one time, exposed
  Image<float> plate_z_m;
  Image<Rgbf> fisheye_light;
  double fisheye_people = 0;  ///< share of its rays
  Mesh spare;                 ///< reused memory
};

}  // namespace mixrig::studio
