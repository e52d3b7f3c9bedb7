// SPDX-License-Identifier: Apache-2.0
// Interface between the operator's page and a run: the run's state, and the changes that the page
// asks for.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include <Eigen/Core>

#include "hal/base/image.h"
#include "hal/base/result.h"

namespace mixrig::page {

struct ObjectState {
  std::string name;
  Eigen::Vector3d position_m{0, 0, 0};  ///< world
  double turn_rad = 0;                  ///< about the world's z axis
  double scale = 1;
  bool hidden = false;
  bool moves = false;                   ///< by physics: it cannot be dragged
  std::optional<Eigen::Vector2d> at{};  ///< its origin in the picture, 0..1 of width and height
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
  std::optional<double> value;  ///< absent where the camera does not report it
  double minimum = 0, maximum = 0, step = 0;
};
struct CameraState {
  std::string name;
  std::vector<CameraValue> values;
};

struct RecordingState {
  bool on = false;
  std::string name, notes;  ///< name and notes of the running recording, or of the last one
  std::uint64_t frames = 0, lost = 0;
  double seconds = 0;
  std::string folder;  ///< folder of the last recording that was finished
  std::string error;   ///< error of the last recording, one line
  bool possible = true;
};

enum class Verdict : std::uint8_t { kGo, kNoGo, kUnknown };
/// Learning of the whole room anew during the run.
struct ScanState {
  bool possible = false;
  int done = 0, total = 0;  ///< steps done and in all; total 0: no scan runs
  std::string why_not;      ///< one line, where it is not possible
};

/// Sweep of the head over the room during the run.
struct SweepState {
  enum class Phase : std::uint8_t { kIdle, kSweeping, kModelling };
  bool possible = false;
  std::string why_not;  ///< one line, where it is not possible
  Phase phase = Phase::kIdle;
  std::string name;         ///< name of the room that is being made, or was made last
  int done = 0, total = 0;  ///< views
  double left_s = 0;        ///< time until the last view; 0: unknown
  std::string folder;       ///< folder of the room that was written last
  std::string error;        ///< why the last sweep wrote no room, one line
};

/// Depth of field of the composite.
struct FocusState {
  bool on = false;
  std::optional<Eigen::Vector2d> at{};  ///< 0..1 of the picture: the surface seen there is sharp
  std::optional<double> distance_m{};   ///< distance that is sharp
  double f_number = 0;
};

/// What undo and redo would do, such as "move crate"; empty: nothing.
struct EditsState {
  std::string undo, redo;
};

/// A stored snapshot of objects, light, focus and look.
struct PresetState {
  std::string name;
  std::vector<std::string> differences;  ///< to what the scene is now, a line each
};

/// A recording of composites.
struct TakeState {
  std::string name, notes;
  bool circled = false;  ///< the operator's mark of a good take
  std::uint64_t frames = 0, lost = 0;
  double seconds = 0, megabytes = 0;
  std::string state;  ///< "whole", "cut off", or why it ended early
};

struct CalibrationState {
  std::string file, why;          ///< calibration in use, and why it was chosen
  std::optional<double> age_s{};  ///< since the file was written
  Verdict verdict = Verdict::kUnknown;
  std::string reason;  ///< reason of the verdict, one sentence
};

/// State of a run; counts and values are those of the last frame.
struct State {
  std::string scene, source, backend;
  bool live = false;          ///< true: devices; false: a recording is played
  int width = 0, height = 0;  ///< size of the picture
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
  std::optional<double> disk_free_gb{};  ///< free space for recordings
  /// How long a recording could be, by the size of the last one; absent before the first.
  std::optional<double> record_minutes{};
  CalibrationState calibration;
  std::vector<StreamState> streams;
  std::vector<CameraState> cameras;  ///< cameras with settings
  std::vector<ObjectState> objects;
  std::vector<LampState> lamps;
  EditsState edits;
  std::vector<PresetState> presets;
  std::vector<TakeState> takes;  ///< the newest last
  std::vector<std::string> log;  ///< the last lines, the newest last
};

/// Changes an object; absent values stay.
struct SetObject {
  std::string name;
  std::optional<Eigen::Vector3d> position_m{};
  /// Place in the picture, 0..1: the object's origin moves to the point seen there, on its own
  /// level.
  std::optional<Eigen::Vector2d> at{};
  /// Place in the picture, 0..1: the object is set on the room's surface seen there, along its
  /// normal, about which `turn_rad` then turns.
  std::optional<Eigen::Vector2d> onto{};
  std::optional<double> turn_rad{}, scale{};
  std::optional<bool> hidden{};
  std::optional<std::string> rename{};
  bool preview = false;  ///< shows the change without writing it into the scene
};
struct AddObject {
  std::string name;
  std::filesystem::path glb;  ///< a file that may be moved away
};
/// Adds a copy of an object beside it.
struct CopyObject {
  std::string name;
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
/// Adds a lamp at `position_m`, or by a place in the picture: 5 cm before the room's surface seen
/// there, where the ray of sight is at `height_m`, or `above_floor_m` above the floor seen there.
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
/// Sets values by their keys in rig.toml, in their units.
struct SetCamera {
  std::string name;
  std::vector<std::pair<std::string, double>> values;
  bool preview = false;  ///< sets the values without writing them into rig.toml
};
/// Writes previews into the scene.
struct SaveScene {};
/// Shows what is written in place of previews.
struct DiscardPreviews {};
/// Takes the last edit of a file back, or makes it again.
struct Undo {
  bool again = false;
};
/// Stores what is shown as a preset; an old one of the name is replaced if `replace`.
struct StorePreset {
  std::string name;
  bool replace = false;
};
struct RecallPreset {
  std::string name;
};
struct RemovePreset {
  std::string name;
};
/// Changes what is noted about a recording; absent values stay.
struct SetTake {
  std::string name;
  std::optional<bool> circled{};
  std::optional<std::string> notes{};
};
struct StartRecording {
  std::string name, notes;
};
struct StopRecording {};
/// Takes changes of the room into the background.
struct LearnBackground {};
/// Learns the whole room anew while it is empty (`on`), or ends that without a result.
struct ScanRoom {
  bool on = true;
};
/// Sweeps the head over the room; its model becomes the background at the next start.
struct StartSweep {
  std::string name;                     ///< a folder's; empty: "room 1", "room 2", ...
  Eigen::Vector2d field_deg{270, 180};  ///< pan x tilt
  int view_frames = 4;
};
/// Ends the sweep without a result.
struct CancelSweep {};
/// Changes the depth of field; absent values stay. At most one of `at` and `distance_m`.
struct SetFocus {
  std::optional<bool> on{};
  std::optional<Eigen::Vector2d> at{};  ///< 0..1 of the picture: what is seen there is sharp
  std::optional<double> distance_m{}, f_number{};
};

using Command = std::variant<SetObject, AddObject, CopyObject, RemoveObject, SetLamp, AddLamp,
                             RemoveLamp, SetCamera, SaveScene, DiscardPreviews, Undo, StorePreset,
                             RecallPreset, RemovePreset, SetTake, StartRecording, StopRecording,
                             LearnBackground, ScanRoom, StartSweep, CancelSweep, SetFocus>;

/// A run, as the page sees it. Thread-safe.
class Operator {
 public:
  virtual ~Operator() = default;
  /// Current state; takes about a millisecond at most.
  virtual State state() const = 0;
  /// Makes a change. May write files and take a second; one call at a time. Errors, one line each:
  /// kNotFound for an unknown object or lamp; kUsage, kFormat for values out of range;
  /// kUnsupported, kData where this run cannot do it now; kIo.
  virtual Result<void> apply(const Command& command) = 0;
  /// Picture `frame`, from 1, of a whole recording. Reads files and may take a second; one call at
  /// a time, also beside apply(). Errors: kNotFound for an unknown recording or frame; kFormat,
  /// kData of its files.
  virtual Result<Image<Rgb8>> take_picture(const std::string& take, int frame) = 0;
};

}  // namespace mixrig::page
