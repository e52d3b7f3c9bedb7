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
  std::vector<std::uint32_t> indices;   ///< three a triangle, counter-clockwise seen from outside
  Eigen::Vector3f base_color{1, 1, 1};  ///< linear, multiplies the texture
  int texture = -1;                     ///< index into Model::textures, -1 for none
  bool double_sided = false;
  /// How it mirrors light (glTF's metallic-roughness); specular is the share of a dielectric's
  /// 4 %: 0 is matte.
  float metallic = 0, roughness = 1, specular = 0;
  Eigen::Vector3f emission{0, 0, 0};  ///< linear, 0..1, multiplies its map
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

/// Reads .gltf or .glb (which one, by content): meshes, node transforms, and of materials base
/// colour, metallic-roughness, normal and emissive maps, KHR_materials_specular's and
/// _emissive_strength's factors; a light of its own that is brighter than white is white.
/// Errors: kNotFound, kFormat (missing buffer or picture, index out of range, no triangles).
Result<Model> load_gltf(const std::filesystem::path& path);

/// The box around all vertices, in the model's axes. Precondition: the model has a vertex.
struct Bounds {
  Eigen::Vector3f min_m, max_m;
};
Bounds bounds(const Model& model);

/// Of an object that falls, rolls and is pushed.
struct ObjectPhysics {
  double mass_kg = 1, bounce = 0.6, friction = 0.5, drag = 0.1;
  bool is_ball = false;                   ///< instead of the convex hulls of its parts
  Eigen::Vector3d velocity_m_s{0, 0, 0};  ///< at first, world
  bool operator==(const ObjectPhysics&) const = default;
};

struct Object {
  std::string name;
  std::filesystem::path model_path;
  Model model;
  geometry::Pose world_from_object;
  double scale = 1.0;
  bool casts_shadow = true;
  bool hidden = false;                   ///< neither seen nor touched; never of a set
  std::optional<ObjectPhysics> physics;  ///< none: it stands still; never of a set
};

using geometry::Lamp;

/// Light of the set. Each lamp has a name.
struct Light : geometry::Light {
  bool follow = false;      ///< lamps that are switched or dimmed while it runs
  bool find_lamps = false;  ///< in the scanned room, when a session begins; then `lamps` is empty
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
/// The word of scene.toml: "pan_tilt".
const char* name(PoseSource source);

/// What virtual objects do in a frame without a pose.
enum class WhenLost { kFreeze, kHide };

/// A motion capture that streams while the scene runs.
struct MocapSettings {
  std::string server;                   ///< "HOST[:PORT][,GROUP[:PORT]]"
  std::filesystem::path constellation;  ///< of the camera's body; empty: Motive's own bodies
  int body = 0;                         ///< number of the body; 0: the only one
  bool y_up = true;                     ///< the stream's world; the scene's has z up
  double delay_s = 0;                   ///< from the exposure of a frame to its earliest arrival
  bool operator==(const MocapSettings&) const = default;
};

/// A camera tracker that sends FreeD or OpenTrackIO while the scene runs.
struct TrackerStream {
  std::string address;                ///< "[HOST:]PORT[,NUMBER]", of this machine or of a group
  geometry::Pose world_from_tracker;  ///< both with z up
  double delay_s = 0;                 ///< from the exposure of a sample to its earliest arrival
  double rate_hz = 0;                 ///< FreeD: of the sender
  bool system_stamps = false;         ///< OpenTrackIO: stamps are of this machine's system clock
  /// Standard deviations that the tracker's maker states; none: the poses have no covariance.
  std::optional<double> sigma_m, sigma_rad;
  bool operator==(const TrackerStream&) const = default;
};

/// How a tracker reaches the time of a plate from the pictures before it.
enum class Predict { kVelocity, kHead, kBoth };

/// Where the camera's pose comes from. Each value belongs to one PoseSource.
struct CameraPoses {
  std::filesystem::path trajectory;      ///< kRecorded: a file; empty: the take's own poses
  double time_offset_s = 0;              ///< kRecorded: time of the take = time of the file + this
  geometry::Pose world_from_target;      ///< kFixed
  geometry::Pose world_from_base;        ///< kPanTilt: the foot of the head
  MocapSettings mocap;                   ///< kMocap
  TrackerStream stream;                  ///< kFreeD, kOpenTrack
  Predict predict = Predict::kVelocity;  ///< kTracker
  double smooth_s = 0;                   ///< kTracker: latency for which poses are smoothed
  double max_age_s = 0.1;                ///< an older pose is lost
  WhenLost when_lost = WhenLost::kFreeze;
  bool operator==(const CameraPoses&) const = default;
};

/// A box in world axes; real points outside it are cropped (Cortes Reina
/// 2015, section 3.1 "Cropping"). Without a background it alone keys, and its bottom is the floor.
struct CaptureVolume {
  Eigen::Vector3d min_m, max_m;
  double floor_tolerance_m = 0.01;  ///< what is lower over the bottom is the floor
  bool operator==(const CaptureVolume&) const = default;
};

struct Background {
  std::optional<std::pair<int, int>> learn;    ///< first and last frame number, 1-based, inclusive
  std::optional<std::filesystem::path> model;  ///< folder written by `mixrig scan`
  /// Of a scanned room; absent: where the head of pose = "pan_tilt" stands.
  std::optional<geometry::Pose> world_from_base;
  bool open_walls = false;  ///< it does not hide virtual objects
  bool operator==(const Background&) const = default;
};

/// What is shown instead of the real background. Without model and picture: nothing.
struct VirtualSet {
  std::optional<Object> model;
  std::filesystem::path picture_path;
  Image<Rgb8> picture;  ///< behind the model, as large as the view; empty: transparent there
};

struct KeySettings {
  double threshold_m = 0.05;  ///< least depth step that is keyed
  double noise_factor = 4.0;  ///< threshold in standard deviations of the depth noise
  bool motion = true;         ///< people's depth is moved to the time of the plate
  bool steady = true;         ///< the frame before joins where the plate stayed alike
};

/// What happens between people and objects is told.
struct EventSettings {
  std::string udp;      ///< "HOST:PORT" that gets each event as JSON; empty: none
  std::string osc;      ///< "HOST:PORT" that gets each event as an OSC message; empty: none
  bool people = false;  ///< both get the places of people in each frame too
  bool operator==(const EventSettings&) const = default;
};

/// A program that gets the pose and lens of each picture.
struct PoseOut {
  enum class Protocol : std::uint8_t { kFreeD, kOpenTrackJson, kOpenTrackCbor };
  Protocol protocol = Protocol::kFreeD;
  std::string udp;              ///< "HOST:PORT"
  int camera = 1;               ///< FreeD: 0 to 255; OpenTrackIO's source: 1 to 200
  double sensor_width_mm = 36;  ///< that focal length and sensor of OpenTrackIO are told for
  /// What sets the host's clock, as OpenTrackIO is told.
  enum class ClockSource : std::uint8_t { kNotTold, kPtp, kNtp };
  ClockSource clock = ClockSource::kNotTold;
  bool operator==(const PoseOut&) const = default;
};

/// Pictures for another program, while the scene runs.
struct StreamOut {
  enum class Picture : std::uint8_t {
    kFill,     ///< the composite
    kKey,      ///< what covers: of a set that is partly transparent its share, else people
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
  double eye_m = 0.065;           ///< stereo: between the two views
  double screen_m = 3;            ///< stereo: distance that is seen on the screen
  double most_disparity_pct = 3;  ///< stereo: of the width, before and behind the screen
  double near_m = 1, far_m = 6;   ///< 2d+depth: nearness 255 and 0, linear in 1 / z
  bool operator==(const StreamOut&) const = default;
};

/// Depth of field.
struct FocusSettings {
  double distance_m = 0;                     ///< of what is sharp; 0: by `pixel`
  std::optional<std::pair<int, int>> pixel;  ///< of the view: what is seen there is sharp
  double f_number = 2.8;                     ///< focal length over diameter of the aperture
  double sensor_width_mm = 36;               ///< that the view's width is
  double most_blur_pct = 4;                  ///< diameter, of the width
};

/// What virtual objects take on of what the camera does to real things.
struct LookSettings {
  bool grain = false;
  bool blur = false;
  bool chroma = false;
  bool sharpening = false;
  bool motion = false;
  bool follow = true;      ///< measured again while a run goes on
  double exposure_ms = 0;  ///< of the plates, for motion; 0: that of the source, where it is known
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
