// SPDX-License-Identifier: Apache-2.0
// A scene: what to composite into a take. Parsed once from scene.toml into plain structs.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "hal/base/result.h"
#include "host/math/geometry/lamp.h"
#include "host/math/geometry/pose.h"
#include "host/scene/quality.h"

namespace mixrig::scene {

/// Triangles of one material. Vertex arrays are of equal length; normals have length 1.
struct Mesh {
  std::vector<Eigen::Vector3f> positions_m;
  std::vector<Eigen::Vector3f> normals;
  std::vector<Eigen::Vector2f> uv;      ///< empty where there is no texture; v grows downwards
  std::vector<std::uint32_t> indices;   ///< three per triangle, counter-clockwise seen from outside
  Eigen::Vector3f base_color{1, 1, 1};  ///< linear, multiplies the texture
  int texture = -1;                     ///< index into Model::textures, -1 for none
  bool double_sided = false;
  /// Reflection of light (glTF's metallic-roughness). `specular` is a share of a dielectric's 4 %;
  /// 0 is matte.
  float metallic = 0, roughness = 1, specular = 0;
  Eigen::Vector3f emission{0, 0, 0};  ///< linear, 0..1, multiplies emission_map
  /// Indices into Model::textures, -1 for none. The gloss map's bytes over 255 multiply roughness
  /// (green) and metallic (blue).
  int gloss_map = -1, normal_map = -1, emission_map = -1;
  float normal_scale = 1;
};

/// A glTF file with node transforms applied, in object axes: z up. glTF's (x, y, z), y up,
/// becomes (x, -z, y).
struct Model {
  std::vector<Mesh> meshes;
  std::vector<Image<Rgb8>> textures;  ///< sRGB, or numbers (gloss and normal maps)
};

/// Reads .gltf or .glb (decided by content): meshes, node transforms, and from materials base
/// colour, metallic-roughness, normal and emissive maps, and the factors of KHR_materials_specular
/// and _emissive_strength; emission brighter than white is clamped to white.
/// Errors: kNotFound, kFormat (missing buffer or picture, index out of range, no triangles), kIo
/// (no memory).
Result<Model> load_gltf(const std::filesystem::path& path);

/// Bounding box of all vertices, in the model's axes. Precondition of bounds(): the model has a
/// vertex.
struct Bounds {
  Eigen::Vector3f min_m, max_m;
};
Bounds bounds(const Model& model);

/// Physics of an object that falls, rolls and is pushed.
struct ObjectPhysics {
  double mass_kg = 1, bounce = 0.6, friction = 0.5, drag = 0.1;
  /// Its shape is a ball, not the convex hulls of its parts.
  bool is_ball = false;
  Eigen::Vector3d velocity_m_s{0, 0, 0};  ///< initial velocity, world
  bool operator==(const ObjectPhysics&) const = default;
};

struct Object {
  std::string name;
  std::filesystem::path model_path;
  Model model;
  geometry::Pose world_from_object;
  double scale = 1.0;
  bool casts_shadow = true;
  bool hidden = false;                   ///< neither visible nor touchable; always false for a set
  std::optional<ObjectPhysics> physics;  ///< absent: it stands still; always absent for a set
};

using geometry::Lamp;

/// Light of the set. Each lamp has a name.
struct Light : geometry::Light {
  bool follow = false;  ///< follow lamps that are switched or dimmed during a run
  /// Find lamps in the scanned room when a session begins; then `lamps` is empty.
  bool find_lamps = false;
};

enum class PoseSource {
  kTake,
  kFloor,
  kIdentity,
  kFixed,
  kRecorded,
  kPanTilt,
  kMocap,
  kTracker,
  kFreeD,
  kOpenTrack
};
/// Returns the word of scene.toml, such as "pan_tilt".
const char* name(PoseSource source);

/// Behaviour of virtual objects in a frame without a pose: drawn with the last pose, or hidden.
enum class WhenLost { kFreeze, kHide };

/// A motion capture that streams while the scene runs.
struct MocapSettings {
  std::string server;                   ///< "HOST[:PORT][,GROUP[:PORT]]"
  std::filesystem::path constellation;  ///< file of the camera's body; empty: Motive's own bodies
  int body = 0;                         ///< number of the body; 0: the only one
  /// The stream's world has y up, else z; the scene's has z up.
  bool y_up = true;
  double delay_s = 0;  ///< from the exposure of a frame to its earliest arrival
  bool operator==(const MocapSettings&) const = default;
};

/// A camera tracker that sends FreeD or OpenTrackIO while the scene runs.
struct TrackerStream {
  std::string address;                ///< "[HOST:]PORT[,NUMBER][@SENDER]"
  geometry::Pose world_from_tracker;  ///< both worlds have z up
  double delay_s = 0;                 ///< from the exposure of a sample to its earliest arrival
  double rate_hz = 0;                 ///< FreeD: rate of the sender
  /// OpenTrackIO: stamps of a clock that is mapped by arrival, of this machine's system clock, or
  /// of PTP (TAI) by which the system clock is set.
  enum class Stamps : std::uint8_t { kArrival, kSystem, kPtp } stamps = Stamps::kArrival;
  /// Standard deviations as the tracker's maker states them; absent: the poses have no covariance.
  std::optional<double> sigma_m, sigma_rad;
  bool operator==(const TrackerStream&) const = default;
};

/// How a tracker extrapolates from earlier pictures to the time of a plate.
enum class Predict { kVelocity, kHead, kBoth };

/// Settings of the camera's pose. Each value belongs to the PoseSource named beside it.
struct CameraPoses {
  std::filesystem::path trajectory;      ///< kRecorded: a file; empty: the take's own poses
  double time_offset_s = 0;              ///< kRecorded: time of the take = time of the file + this
  geometry::Pose world_from_target;      ///< kFixed
  geometry::Pose world_from_base;        ///< kPanTilt: base of the pan-tilt unit
  MocapSettings mocap;                   ///< kMocap
  TrackerStream stream;                  ///< kFreeD, kOpenTrack
  Predict predict = Predict::kVelocity;  ///< kTracker
  double smooth_s = 0;                   ///< kTracker: latency for which poses are smoothed
  double max_age_s = 0.1;                ///< an older pose is lost
  WhenLost when_lost = WhenLost::kFreeze;
  bool operator==(const CameraPoses&) const = default;
};

/// A box in world axes; real points outside it are cropped (Cortes Reina
/// 2015, section 3.1 "Cropping"). Without a background only the volume keys, and its bottom is the
/// floor.
struct CaptureVolume {
  Eigen::Vector3d min_m, max_m;
  double floor_tolerance_m = 0.01;  ///< points less than this above the bottom are floor
  bool operator==(const CaptureVolume&) const = default;
};

struct Background {
  std::optional<std::pair<int, int>> learn;    ///< first and last frame number, 1-based, inclusive
  std::optional<std::filesystem::path> model;  ///< folder written by `mixrig scan`
  /// Pose of the scanned room; absent: that of the head of pose = "pan_tilt".
  std::optional<geometry::Pose> world_from_base;
  bool open_walls = false;  ///< its walls do not hide virtual objects
  bool operator==(const Background&) const = default;
};

/// Set shown in place of the real background. Without model and picture it is empty.
struct VirtualSet {
  std::optional<Object> model;
  std::filesystem::path picture_path;
  Image<Rgb8> picture;  ///< behind the model, as large as the view; empty: transparent there
};

struct KeySettings {
  double threshold_m = 0.05;  ///< smallest threshold, the depth step that is keyed
  /// The threshold is at least this many standard deviations of the depth noise.
  double noise_factor = 4.0;
  bool steady = true;  ///< blend in the last frame's matte where the plate did not change
};

/// Outputs of events between people and objects.
struct EventSettings {
  std::string udp;      ///< "HOST:PORT" that receives each event as JSON; empty: none
  std::string osc;      ///< "HOST:PORT" that receives each event as an OSC message; empty: none
  bool people = false;  ///< also send the places of people in each frame
  bool operator==(const EventSettings&) const = default;
};

/// A program that receives the pose and lens of each picture.
struct PoseOut {
  enum class Protocol : std::uint8_t { kFreeD, kOpenTrackJson, kOpenTrackCbor };
  Protocol protocol = Protocol::kFreeD;
  std::string udp;              ///< "HOST:PORT"
  int camera = 1;               ///< FreeD: 0 to 255; OpenTrackIO's source: 1 to 200
  double sensor_width_mm = 36;  ///< for the focal length and sensor that OpenTrackIO states
  /// What synchronizes the host's clock, as stated in OpenTrackIO.
  enum class ClockSource : std::uint8_t { kNotTold, kPtp, kNtp };
  ClockSource clock = ClockSource::kNotTold;
  bool operator==(const PoseOut&) const = default;
};

/// Pictures for another program, while the scene runs.
struct StreamOut {
  enum class Picture : std::uint8_t {
    kFill,     ///< the composite
    kKey,      ///< coverage: of all that is shown if the set leaves parts empty, else of people
    kDepth,    ///< mixed depth, 16 bits of millimetres, 0 unknown
    kFillKey,  ///< composite and key side by side
    kAlpha,    ///< composite with the key as alpha
    kDepth2d,  ///< composite and nearness side by side, for 3DTV
    kStereo    ///< left and right view side by side
  };
  enum class Codec : std::uint8_t { kAuto, kFfv1, kH264, kProres, kRaw };
  std::string uri;  ///< srt://, rtp://HOST:PORT, shm://PATH, v4l2://PATH, or .mkv, .mov, .mp4
  Picture picture = Picture::kFill;
  Codec codec = Codec::kAuto;
  double eye_m = 0.065;  ///< stereo: distance between the two views
  double screen_m = 3;   ///< stereo: distance that appears at the screen
  /// Stereo: largest disparity, percent of the width, in front of and behind the screen.
  double most_disparity_pct = 3;
  double near_m = 1, far_m = 6;  ///< 2d+depth: nearness 255 and 0, linear in 1 / z
  bool operator==(const StreamOut&) const = default;
};

/// Depth of field.
struct FocusSettings {
  double distance_m = 0;  ///< distance in focus; 0: given by `pixel`
  /// Pixel of the view: the surface seen there is in focus.
  std::optional<std::pair<int, int>> pixel;
  double f_number = 2.8;        ///< focal length over diameter of the aperture
  double sensor_width_mm = 36;  ///< width of the view on the sensor
  double most_blur_pct = 4;     ///< largest blur diameter, percent of the width
};

/// Effects of the camera that are applied to virtual objects.
struct LookSettings {
  bool grain = false;
  bool blur = false;
  bool chroma = false;
  bool sharpening = false;
  bool motion = false;
  bool follow = true;      ///< measure the effects again during a run
  double exposure_ms = 0;  ///< of the plates, for motion; 0: the source's, if known
  bool operator==(const LookSettings&) const = default;
};

struct Scene {
  std::filesystem::path path;
  std::filesystem::path calibration;  ///< calibration.toml that replaces the source's own, or empty
  PoseSource pose_source = PoseSource::kTake;
  CameraPoses camera;
  std::optional<CaptureVolume> capture_volume;
  Background background;
  std::optional<VirtualSet> set;
  std::vector<Object> objects;
  Light light;
  KeySettings key;
  bool follow_people = false;           ///< in a run
  std::optional<EventSettings> events;  ///< in a run; people are followed for them
  std::vector<PoseOut> pose_outs;       ///< in a run
  std::vector<StreamOut> stream_outs;   ///< in a run
  std::optional<FocusSettings> focus;
  Quality quality;
  LookSettings look;
};

/// Reads scene.toml and the models it names; relative paths start at the file's folder.
/// Errors: kNotFound, kFormat; the line holds file:line, the key, and for an unknown key the
/// nearest known one.
Result<Scene> load_scene(const std::filesystem::path& path);

}  // namespace mixrig::scene
