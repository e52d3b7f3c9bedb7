// SPDX-License-Identifier: Apache-2.0
// What the operator's page needs of a run: its state, and the changes that it is asked for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "hal/base/result.h"

namespace mixrig::page {

struct ObjectState {
  std::string name;
  Eigen::Vector3d position_m{0, 0, 0};  ///< world
  double turn_rad = 0;                  ///< about the world's z axis
  double scale = 1;
  bool hidden = false;
  bool moves = false;                   ///< by physics: it cannot be dragged
  std::optional<Eigen::Vector2d> at{};  ///< of its origin in the picture, 0..1 of width and height
};

struct LampState {
  std::string name;
  Eigen::Vector3d position_m{0, 0, 0};  ///< world
  Eigen::Vector3f intensity{1, 1, 1};   ///< linear RGB, as scene.toml
  bool on = true;
  std::optional<Eigen::Vector2d> at{};
};

/// A device or a stream of the source.
struct StreamState {
  std::string name, uri;
  bool ok = true;
  std::uint64_t frames = 0, lost = 0;
  std::string what_to_do;  ///< empty where it is well
};

/// A setting of a camera, by the name and in the unit of its key in rig.toml: "exposure_ms",
/// "gain", "focus", "white_balance_k", "zoom".
struct CameraValue {
  std::string name;
  std::optional<double> value;  ///< absent where the camera does not tell it
  double minimum = 0, maximum = 0, step = 0;
};
struct CameraState {
  std::string name;
  std::vector<CameraValue> values;
};

struct RecordingState {
  bool on = false;
  std::string name, notes;  ///< of the running or the last one
  std::uint64_t frames = 0, lost = 0;
  double seconds = 0;
  std::string folder;  ///< of the last one that was finished
  std::string error;   ///< of the last one, one line
  bool possible = true;
};

enum class Verdict : std::uint8_t { kGo, kNoGo, kUnknown };
/// Of a scan of the room while the run goes on.
struct ScanState {
  bool possible = false;
  int done = 0, total = 0;  ///< looks at the room; total 0: none is at work
  std::string why_not;      ///< one line, where it is not possible
};

/// Of a sweep of the head over the room while the run goes on.
struct SweepState {
  enum class Phase : std::uint8_t { kIdle, kSweeping, kModelling };
  bool possible = false;
  std::string why_not;  ///< one line, where it is not possible
  Phase phase = Phase::kIdle;
  std::string name;         ///< of the room that is made, or was made last
  int done = 0, total = 0;  ///< views
  double left_s = 0;        ///< until the last view, where it is known
  std::string folder;       ///< of the room that was written last
  std::string error;        ///< why the last one has none, one line
};

/// Depth of field of the composite.
struct FocusState {
  bool on = false;
  std::optional<Eigen::Vector2d> at{};  ///< 0..1 of the picture: what is seen there is sharp
  std::optional<double> distance_m{};   ///< or this distance
  double f_number = 0;
};

struct CalibrationState {
  std::string file, why;          ///< which one is used, and why
  std::optional<double> age_s{};  ///< since the file was written
  Verdict verdict = Verdict::kUnknown;
  std::string reason;  ///< of the verdict, one sentence
};

/// Counts and values are those of the last frame.
struct State {
  std::string scene, source, backend;
  bool live = false;          ///< devices; else a recording that is played
  int width = 0, height = 0;  ///< of the picture
  std::uint64_t frames = 0;   ///< composited so far
  int frame = 0;              ///< number of the last capture
  double fps = 0;             ///< over the last second
  double frame_ms = 0;        ///< to composite the last frame
  double delay_ms = 0;        ///< mid-exposure to finished composite
  double since_frame_s = 0;   ///< since the last frame was finished
  std::string pose;           ///< "ok", or why it is lost
  bool objects_shown = true;
  RecordingState recording;
  bool background_possible = false;  ///< changes of the room can be taken into the background
  std::string background;            ///< what is known about them, one line
  ScanState scan;
  SweepState sweep;
  FocusState focus;
  std::optional<double> disk_free_gb{};  ///< where recordings go
  CalibrationState calibration;
  std::vector<StreamState> streams;
  std::vector<CameraState> cameras;  ///< those with something to set
  std::vector<ObjectState> objects;
  std::vector<LampState> lamps;
  std::vector<std::string> log;  ///< the last lines, the newest last
};

/// Changes of an object; what is absent stays.
struct SetObject {
  std::string name;
  std::optional<Eigen::Vector3d> position_m{};
  /// In the picture, 0..1: its origin goes to the point under it on the level that it stands on.
  std::optional<Eigen::Vector2d> at{};
  /// The same, but it is set on the room's surface that is seen there, along its normal; `turn_rad`
  /// is about it then.
  std::optional<Eigen::Vector2d> onto{};
  std::optional<double> turn_rad{}, scale{};
  std::optional<bool> hidden{};
  bool preview = false;  ///< shown, but not written into the scene
};
struct AddObject {
  std::string name;
  std::filesystem::path glb;  ///< a file that may be moved away
};
struct RemoveObject {
  std::string name;
};
struct SetLamp {
  std::string name;
  std::optional<Eigen::Vector3f> intensity{};
  std::optional<bool> on{};
  bool preview = false;
};
/// A lamp at `position_m`, or by its place in the picture: where the room's surface is seen there,
/// or at a height along the sight, or above the floor under the place.
struct AddLamp {
  std::string name;
  std::optional<Eigen::Vector3d> position_m{};
  std::optional<Eigen::Vector2d> at{};
  std::optional<double> height_m{}, above_floor_m{};  ///< with `at`, at most one of them
  Eigen::Vector3f intensity{1, 1, 1};
};
struct RemoveLamp {
  std::string name;
};
/// Values by the keys of rig.toml, in their units.
struct SetCamera {
  std::string name;
  std::vector<std::pair<std::string, double>> values;
  bool preview = false;  ///< set, but not written into rig.toml
};
/// Previews are written into the scene.
struct SaveScene {};
struct StartRecording {
  std::string name, notes;
};
struct StopRecording {};
/// What changed in the room becomes background.
struct LearnBackground {};
/// The whole room is learned anew while it is empty; or that is ended without a result.
struct ScanRoom {
  bool on = true;
};
/// The head turns over the room, whose model becomes the background of the next start.
struct StartSweep {
  std::string name;                     ///< a folder's; empty: "room 1", "room 2", ...
  Eigen::Vector2d field_deg{270, 180};  ///< pan x tilt
  int view_frames = 4;
};
/// Ends it without a result.
struct CancelSweep {};
/// Depth of field; what is absent stays. At most one of `at` and `distance_m`.
struct SetFocus {
  std::optional<bool> on{};
  std::optional<Eigen::Vector2d> at{};  ///< 0..1 of the picture: what is seen there is sharp
  std::optional<double> distance_m{}, f_number{};
};

using Command = std::variant<SetObject, AddObject, RemoveObject, SetLamp, AddLamp, RemoveLamp,
                             SetCamera, SaveScene, StartRecording, StopRecording, LearnBackground,
                             ScanRoom, StartSweep, CancelSweep, SetFocus>;

/// A run. Any threads.
class Operator {
 public:
  virtual ~Operator() = default;
  /// Takes about a millisecond at most.
  virtual State state() const = 0;
  /// May write files and take a second; one call at a time. Errors, one line each: kNotFound for an
  /// object or lamp that is not there; kUsage, kFormat for values that cannot be; kUnsupported,
  /// kData where this run cannot do it now; kIo.
  virtual Result<void> apply(const Command& command) = 0;
};

}  // namespace mixrig::page
