// SPDX-License-Identifier: Apache-2.0
// The virtual studio: a ray-traced room, person and rig, with ground truth for every frame.
#pragma once

#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/math/geometry/pose.h"
#include "studio/day.h"
#include "studio/mocap.h"
#include "studio/pan_tilt_unit.h"
#include "studio/realism.h"

namespace mixrig::studio {

/// Actions of the person and the camera. In rounds the person enters, walks round the object two
/// and a half times, turns and walks back (Schiller et al. 2010, figure 11). The camera stands
/// still except in pan, sweep, handheld, pendulum and carried; in starts it is elsewhere in every
/// frame: within 1 m of where a sweep stands, turned by up to 60 degrees from where it looks ahead.
/// In shot it turns to one side and back while the room is empty, and once more near the end.
enum class Scenario {
  kStill,
  kWalk,
  kTalk,
  kPan,
  kSweep,
  kHandheld,
  kPendulum,
  kCarried,
  kEdges,
  kFar,
  kDark,
  kStarts,
  kRounds,
  kShot
};
/// The depth camera beside the target camera.
enum class RigPreset { kSr3000, kKinect2, kHelios2 };

std::string_view name(Scenario scenario);
std::string_view name(RigPreset rig);
/// Parses a name. Errors: kUsage; the line lists the names that exist.
Result<Scenario> parse_scenario(std::string_view text);
Result<RigPreset> parse_rig(std::string_view text);
/// A rig, and a second depth camera where there is one.
struct RigWords {
  RigPreset rig = RigPreset::kKinect2;
  std::optional<RigPreset> second_tof;
};
/// Parses RIG or RIG+SECOND. Errors: kUsage.
Result<RigWords> parse_rig_words(std::string_view text);

/// Scenario sweep: where the head stands still, view by view. The time between views is not in the
/// take; people move on in it. Without views the head stands and turns as Studio::turn_head says.
struct Sweep {
  std::vector<HeadAngles> views;
  int frames_per_view = 4;  ///< StudioOptions::frames is views times this
  bool people = false;      ///< from the second view on; otherwise nobody is in the room
  bool crossing = false;    ///< people: the first walks around the head and crosses the middle of
                            ///< every second view, 0.7 s from one of its frames to the next
  bool bracket = false;     ///< take: plates of each view also at other exposures
  HeadMotion moved{};       ///< where there are no views, at the time `moved_s`
  double moved_s = 0;
};

/// The exposure control of the target camera. It rounds to whole steps, and as a sensor that reads
/// out after its shutter does, exposes `longer_s` longer than it says.
struct ExposureControl {
  double rest_s = 8e-3, least_s = 2e-5, most_s = 3.6e-2, step_s = 1e-5, longer_s = 9e-6;

  /// Light of an exposure within the limits, relative to that at rest.
  double factor(double exposure_s) const {
    return (least_s + step_s * std::round((exposure_s - least_s) / step_s) + longer_s) /
           (rest_s + longer_s);
  }
};

/// A lens through which the truth's composite is seen; plates are those of a pinhole.
struct ThinLens {
  double aperture_m = 0;  ///< diameter, 0..0.2; 0: a pinhole
  double focus_m = 3;     ///< z that is sharp, 0.1..100
};

/// Rate of the frames of a take.
inline constexpr double kFrameRate_hz = 25;

/// Focus pull: from a time of the take on the target camera's lens is sharp at another distance
/// (realism `defocus`); the view keeps its focal length.
struct Refocus {
  double from_s = 0, focus_m = 1;
};

struct StudioOptions {
  Scenario scenario = Scenario::kWalk;
  RigPreset rig = RigPreset::kKinect2;
  /// A second depth camera on the other side of the target camera. It exposes in the half of the
  /// frame's time in which the first does not.
  std::optional<RigPreset> second_tof;
  unsigned seed = 1;
  int frames = 60;           ///< length of the take, 2..100000
  Size size_px{1280, 1024};  ///< target camera, 32..4096 a side
  int threads = 0;           ///< 0: one per core
  double tolerance = 0;      ///< of lenses and mounting by seed, 0..2: 0 as the preset says
  bool raw_depth = false;    ///< leave the ToF camera's systematic error in
  bool raw = false;          ///< kinect2: frames have the sensor's raw pictures in place of depth
  bool fisheye = false;      ///< the take has the fisheye's pictures
  Size fisheye_px{1280, 1024};  ///< of them, 64..4096 a side; the same field
  double zoom = 1;  ///< the target camera's lens zooms in to this focal length, 1..8 times that at
                    ///< rest; 1: it stands still. Not in scenario sweep
  bool clear_floor = false;    ///< no chair at the desk: no furniture in StudioInfo::capture_volume
  bool cache = true;           ///< reuse static parts in the next frame; the pictures are the same
  int people = 1;              ///< 1..3
  bool props = false;          ///< the first person carries a stick, a black bag, a chrome ball
  bool glossy_object = false;  ///< varnished crate, polished statue
  bool window = false;  ///< a pane of dark glass, without depth, in place of the middle picture
  Sweep sweep;          ///< of scenario sweep
  std::optional<Eigen::Vector3d> eye_m, look_at_m;  ///< of the camera at rest, in place of the
                                                    ///< scenario's; world
  std::optional<Eigen::Vector2d> object_m;          ///< of the object on the floor, in place of the
                                                    ///< scenario's; world x y
  double pan_rad = 0.21;  ///< 0 to 2. Scenario pan: to either side, at up to 30 degrees a second;
                          ///< scenario shot: to one side
  ThinLens lens;          ///< only in the plain look
  std::optional<Refocus> refocus;  ///< of the judged look's lens
  Realism realism;                 ///< all off: the plain look
  Day day;
};

/// A pinhole camera with OpenCV's distortion model, and a thin prism. Pixel (0,0) is the centre of
/// the top-left pixel.
struct Optics {
  Size size_px;
  double fx_px = 0, fy_px = 0, cx_px = 0, cy_px = 0;
  std::array<double, 5> distortion{};  ///< k1 k2 p1 p2 k3
  std::array<double, 2> prism{};       ///< thin prism: times r^4 in x and y; not in OpenCV's five
};

/// Counts of a lens's encoders.
struct LensCounts {
  double zoom = 0, focus = 0;
};
struct LensSample {
  double time_s = 0;  ///< on the clock of Frame::time_s
  LensCounts at;
};
/// The lens at what its encoders say; the pupil's shift as ZoomLens::pupil_shift_m.
struct LensTruth {
  LensCounts at;
  Optics optics;
  double pupil_shift_m = 0;
};

/// Standard deviation of a depth value on a surface of albedo 0.5 that faces the camera:
/// floor + linear z + quadratic z^2.
struct DepthNoise {
  double floor_m = 0, linear = 0, quadratic_per_m = 0;
};

struct TofInfo {
  Optics optics;
  geometry::Pose target_from_tof;
  double depth_unit_m = 0.001;  ///< step of the sensor's output
  DepthNoise noise;
  double delay_s = 0;  ///< mid-exposure after that of the target camera
};

/// A fisheye lens: radius_px = f_px (angle + k1 angle^3 + k2 angle^5), where angle is that to the
/// optical axis.
struct FisheyeOptics {
  Size size_px;
  double f_px = 0, cx_px = 0, cy_px = 0, k1 = 0, k2 = 0;
  double field_rad = 0;  ///< full field of view of the image circle
};

struct FisheyeInfo {
  FisheyeOptics optics;
  geometry::Pose target_from_fisheye;
};

/// A lamp panel: irradiance is the mean over the panel of intensity cos cos / d^2.
struct Panel {
  std::string name;
  Eigen::Vector3d position_m;  ///< of the centre, world
  Eigen::Vector3d direction;   ///< unit, world
  Eigen::Vector2d size_m;
  Eigen::Vector3f intensity;  ///< linear RGB
};

struct Light {
  Eigen::Vector3f ambient;
  double exposure = 1;
  std::vector<Panel> lamps;
  bool by_direction = false;  ///< `ambient` is the mean of what differs from side to side
};

/// Triangles with one texture in object axes, z up; counter-clockwise seen from outside.
struct ObjectMesh {
  std::vector<Eigen::Vector3f> positions_m, normals;
  std::vector<Eigen::Vector2f> uv;  ///< v grows downwards
  std::vector<std::uint32_t> indices;
  Image<Rgb8> texture;  ///< sRGB
  bool glossy = false;  ///< a dielectric of this roughness (glTF's)
  float roughness = 1;
};

struct VirtualObject {
  std::string name;
  std::vector<ObjectMesh> meshes;
  geometry::Pose world_from_object;
};

/// Corners of a box in world axes, z up.
struct Volume {
  Eigen::Vector3d min_m, max_m;
};

/// Description that a Kinect v2 sends: the answers to the requests for its phase offsets and for
/// its infrared camera's parameters.
struct RawTables {
  std::vector<std::uint8_t> phase_offsets, infrared;
};

/// Properties of the whole take.
struct StudioInfo {
  std::string name;  ///< "walk 7, kinect2"
  double rate_hz = kFrameRate_hz;
  int frames = 0;
  int empty_frames = 0;  ///< frames 1..empty_frames show no person
  Optics target;
  Optics view;  ///< truth is given in this view: the target camera without distortion
  TofInfo tof;
  std::optional<TofInfo> tof2;   ///< of StudioOptions::second_tof
  std::optional<RawTables> raw;  ///< of StudioOptions::raw
  FisheyeInfo fisheye;
  int fisheye_pictures = 0;  ///< of render_fisheye(); 0 without StudioOptions::fisheye
  double fisheye_rate_hz = 0;
  Light light;
  VirtualObject object;
  Volume capture_volume;  ///< around the person's places, with its bottom on the floor
  bool camera_moves = false;
  geometry::Pose world_from_rest;       ///< of the target camera; pan: at angles zero
  std::optional<PanTiltUnit> pan_tilt;  ///< of scenarios pan and sweep
  std::optional<MocapSystem> mocap;     ///< where the camera moves, but not in scenario sweep
  Eigen::Vector3d room_m;               ///< inner dimensions; a corner is the world's origin
};

/// The measurements of all sensors at one time.
struct Frame {
  int number = 0;     ///< 1-based
  double time_s = 0;  ///< mid-exposure
  Image<Rgb8> color;
  Image<float> tof_distance_m;  ///< along the ray, multiple of the depth unit; 0 = unknown
  Image<float> tof_amplitude;   ///< counts, 65535 = full well of a tap
  Image<float> tof2_distance_m, tof2_amplitude;  ///< of StudioOptions::second_tof, as these
  /// StudioOptions::raw, in place of these two: ten sub-packets as a Kinect v2 sends them, and the
  /// true distance along the ray to what the pixel's centre shows at mid-exposure; 0 = nothing.
  std::vector<std::uint8_t> raw;
  Image<float> tof_true_m;
  geometry::Pose world_from_target;
  std::optional<HeadAngles> head;  ///< pan and sweep: encoders at mid-exposure, in whole steps
};

/// A picture of the fisheye at its own time: 10 Hz, in a sweep and in starts one for each frame;
/// never at the mid-exposure of a frame.
struct FisheyePicture {
  int number = 0;                     ///< 1-based
  int frame = 0;                      ///< the frame whose mid-exposure is nearest
  double time_s = 0;                  ///< mid-exposure, on the clock of Frame::time_s
  geometry::Pose world_from_fisheye;  ///< at mid-exposure
  double people_share = 0;            ///< of the image circle, covered by people
  Image<Rgb8> picture;                ///< sRGB; black outside the image circle
};

/// Position of one person, and how much of it the view shows.
struct PersonTruth {
  Eigen::Vector2d on_floor_m;  ///< vertically below the middle of the hip joints, world x y
  double top_m = 0;            ///< the highest point of the body over the floor
  double visible_m2 = 0;       ///< what is seen, each pixel as large as at its own depth
};

/// Ground truth of a frame, in the ideal view.
struct Truth {
  static constexpr std::uint8_t kBackground = 0, kPerson = 1, kVirtual = 2;  ///< visible layer
  static constexpr std::uint8_t kTofSees = 4;     ///< real surface is visible to the ToF camera
  static constexpr std::uint8_t kSilhouette = 8;  ///< inside the object's silhouette
  static constexpr std::uint8_t kTof2Sees = 16;   ///< as kTofSees, of the second ToF camera
  Image<float> depth_m;                           ///< z of the real scene at the pixel centre
  Image<float> background_depth_m;                ///< the same without people
  Image<std::uint8_t> matte;                      ///< coverage by people, 255 = all
  Image<float> light;          ///< luminance of the light with the object / without it, at most 1
  Image<Rgb8> composite;       ///< noise-free picture with the object in it, sRGB
  Image<std::uint8_t> labels;  ///< layer | kTofSees | kSilhouette | kTof2Sees
  std::optional<Optics> view;  ///< of this frame, where the lens zooms; else StudioInfo::view
  double pupil_shift_m = 0;    ///< of the eye along the axis of world_from_target
  std::vector<PersonTruth> people;  ///< who is in the room, in the order of the cast
};

/// StudioOptions::zoom: what the encoders of the lens say 50 times a second, with noise, from
/// before the first frame to after the last.
std::vector<LensSample> record_lens(const StudioOptions& options, const StudioInfo& info);
/// The true lens on a grid of counts that holds all settings of the take. `info` as it is before a
/// frame is rendered.
std::vector<LensTruth> true_lens_table(const StudioOptions& options, const StudioInfo& info);

/// Renders frames in any order. The bytes of a frame depend on the options only, not on the number
/// of threads, the order or the cache. Memory is reused. Not thread-safe; starts its own threads.
class Studio {
 public:
  /// Errors: kUsage for options out of range, kUnsupported if Embree does not start.
  static Result<Studio> create(const StudioOptions& options);
  Studio(Studio&&) noexcept;
  Studio& operator=(Studio&&) noexcept;
  ~Studio();

  const StudioInfo& info() const;
  /// Renders frame `number` (1..frames), and its truth unless `truth` is null.
  void render(int number, Frame& frame, Truth* truth = nullptr);

  /// Renders picture `number` (1..info().fisheye_pictures), in any order with the frames.
  void render_fisheye(int number, FisheyePicture& out);
  /// The frame that it belongs to, without rendering it: FisheyePicture::frame.
  int fisheye_frame(int number) const;

  /// Scenario sweep without views: the head at mid-exposure of the frames that are rendered from
  /// now on. It turns at its rate while each is exposed.
  void turn_head(const HeadMotion& motion);

  /// Sets the light of the plates relative to that at rest (ExposureControl::factor); 1 at first.
  void set_exposure(double factor);

  /// True linear light of the room without people, 1 = white at the exposure at rest, in all
  /// directions as room_distances(). Of the room as it is at the last frame that was rendered.
  void room_light(const geometry::Pose& world_from_eye, Image<Rgbf>& light);

  /// True distances to the room without people, metres, in all directions of an eye whose axes are
  /// x right, y ahead, z up. Column x is at azimuth pi - 2 pi (x + 0.5) / width, counter-clockwise
  /// from ahead, row y at elevation pi/2 - pi (y + 0.5) / height. 0: nothing is hit.
  void room_distances(const geometry::Pose& world_from_eye, Image<float>& distance_m) const;

 private:
  struct State;
  explicit Studio(std::unique_ptr<State> state);
  std::unique_ptr<State> state_;
};

}  // namespace mixrig::studio
