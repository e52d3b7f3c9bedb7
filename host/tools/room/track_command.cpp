// SPDX-License-Identifier: Apache-2.0
// mixrig track: the pose of every frame of a motion capture, recorded or live; of every picture of
// a take in a scanned room or a learned map.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <memory>

#include <nlohmann/json.hpp>

#include "hal/base/angles.h"
#include "hal/base/output_folder.h"
#include "hal/base/partial_path.h"
#include "host/capture/calibration_file/calibration.h"
#include "host/pose/mocap/live.h"
#include "host/pose/mocap/marker_file.h"
#include "host/pose/mocap/track.h"
#include "host/pose/tracker/room_track.h"
#include "host/scene/scene.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"
#include "host/tools/options.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

struct TrackArguments {
  std::string mocap, constellation, calibration, up = "y", version = "3.0";
  std::string model, map, take, scene, camera = "fisheye", tum;
  std::string drawings;
  double start_m = 1.2, start_deg = 70;
  double smooth_s = 0;
  bool anew = false;
  int threads = 0;
  int body = 0;
  std::optional<double> duration_s;
  std::size_t frames = 0;
};

struct Frames {
  std::vector<stream::NatNetFrame> frames;
  std::optional<stream::NatNetCounts> live;
};

Result<std::vector<std::byte>> read_bytes(const std::string& path) {
  std::error_code code;
  if (!std::filesystem::is_regular_file(path, code))
    return Error{ErrorCode::kNotFound, path + ": there is no such recording: check the path"};
  std::ifstream file(path, std::ios::binary);
  const std::vector<char> text{std::istreambuf_iterator<char>(file), {}};
  if (!file.eof() && !file) return Error{ErrorCode::kIo, path + ": reading failed"};
  const auto bytes = std::as_bytes(std::span(text));
  return std::vector<std::byte>(bytes.begin(), bytes.end());
}

Result<stream::NatNetVersion> parse_version(const std::string& text) {
  stream::NatNetVersion version;
  char rest = 0;
  if (std::sscanf(text.c_str(), "%2d.%2d%c", &version.major, &version.minor, &rest) != 2 ||
      !version.at_least(3, 0))
    return Error{ErrorCode::kUsage, "--natnet " + text + ": expected a version such as 3.0 or 4.1"};
  return version;
}

Result<Frames> receive(const TrackArguments& arguments, stream::NatNetVersion version) {
  MIXRIG_ASSIGN(const auto address, stream::parse_natnet_address(arguments.mocap));
  const SystemClock clock;
  MIXRIG_ASSIGN(auto receiver, stream::NatNetReceiver::open(address, version, clock));
  const StopOnSignal signals;
  MIXRIG_ASSIGN(auto frames,
                mocap::receive_frames(receiver, {arguments.duration_s, arguments.frames},
                                      StopOnSignal::flag(), clock));
  return Frames{std::move(frames), receiver.counts()};
}

Result<Frames> read_frames(const TrackArguments& arguments) {
  const std::filesystem::path path = arguments.mocap;
  if (path.extension() == ".csv") {
    MIXRIG_ASSIGN(auto frames, mocap::read_mocap_csv(path));
    return Frames{std::move(frames), {}};
  }
  MIXRIG_ASSIGN(const stream::NatNetVersion version, parse_version(arguments.version));
  if (arguments.mocap == "natnet" || arguments.mocap.starts_with("natnet:") ||
      arguments.mocap.starts_with("natnet,"))
    return receive(arguments, version);
  MIXRIG_ASSIGN(const std::vector<std::byte> bytes, read_bytes(arguments.mocap));
  auto frames = stream::parse_capture(bytes, version);
  if (!frames) return Error{frames.error().code, arguments.mocap + ": " + frames.error().context};
  return Frames{*std::move(frames), {}};
}

Result<mocap::TrackOptions> track_options(const TrackArguments& arguments) {
  mocap::TrackOptions options;
  options.up = arguments.up == "z" ? mocap::Up::kZ : mocap::Up::kY;
  options.body_id = arguments.body;
  if (arguments.calibration.empty()) return options;
  MIXRIG_ASSIGN(const calibration_file::Calibration known,
                calibration_file::read_calibration(arguments.calibration));
  const auto* body = known.pose("body");
  if (body == nullptr)
    return Error{ErrorCode::kData, arguments.calibration +
                                       ": holds no pose of the body: make one by "
                                       "mixrig calibrate external"};
  options.body_from_camera = geometry::inverse(body->target_from);
  return options;
}

Result<std::optional<mocap::Constellation>> constellation_of(const TrackArguments& arguments) {
  if (arguments.constellation.empty()) return std::optional<mocap::Constellation>();
  MIXRIG_ASSIGN(auto body, mocap::read_constellation(arguments.constellation));
  return std::optional(std::move(body));
}

nlohmann::json to_json(const stream::NatNetCounts& live) {
  return {{"frames", live.frames},
          {"lost", live.lost},
          {"late", live.late},
          {"malformed", live.malformed},
          {"foreign", live.foreign}};
}

void print(const mocap::MocapTrack& track, const std::optional<stream::NatNetCounts>& live) {
  if (live)
    std::printf("%ld frames received, %ld lost, %ld late, %ld malformed, %ld from other senders\n",
                live->frames, live->lost, live->late, live->malformed, live->foreign);
  std::printf("%zu of %d frames have a pose\n", track.poses.size(), track.frames);
  if (track.residual_rms_m > 0)
    std::printf("markers are %.3f mm RMS from the body's shape\n", 1e3 * track.residual_rms_m);
  for (const auto& [reason, count] : track.refused)
    std::printf("%d without: %s\n", count, reason.c_str());
}

/// Pose of the room in a scene; nullopt where the scene states none.
Result<std::optional<geometry::Pose>> place_of_room(const std::string& file) {
  if (file.empty()) return std::optional<geometry::Pose>();
  MIXRIG_ASSIGN(const scene::Scene scene, scene::load_scene(file));
  if (scene.background.world_from_base) return scene.background.world_from_base;
  if (scene.pose_source == scene::PoseSource::kPanTilt)
    return std::optional(scene.camera.world_from_base);
  return Error{ErrorCode::kFormat, file +
                                       ": does not say where the room stands: add "
                                       "background.world_from_base"};
}

void print(const session::RoomTrack& track, const nlohmann::json& json) {
  std::printf("%zu pictures, %.1f %% without a pose, %.0f pictures a second\n",
              track.pictures.size(), json["lost_pct"].get<double>(), json["fps"].get<double>());
  if (json.contains("rms_mm"))
    std::printf(
        "error of the target camera: %.2f mm RMS, 95 %% within %.2f mm, %.4f deg RMS; "
        "expected %.2f mm\n",
        json["rms_mm"].get<double>(), json["p95_mm"].get<double>(), json["rms_deg"].get<double>(),
        json["sigma_mm"].get<double>());
  if (!json.contains("unsmoothed")) return;
  std::printf(
      "jitter %.3f mm, %.4f deg RMS, %.2f s later than without smoothing (%.3f mm, %.4f deg)\n",
      json["jitter_mm"].get<double>(), json["jitter_deg"].get<double>(),
      json["latency_s"].get<double>(), json["unsmoothed"]["jitter_mm"].get<double>(),
      json["unsmoothed"]["jitter_deg"].get<double>());
}

Result<nlohmann::json> track_in_room(const TrackArguments& arguments) {
  session::RoomTrackOptions options;
  options.room = arguments.model, options.take = arguments.take;
  options.calibration = arguments.calibration;
  options.camera = arguments.camera == "target" ? session::TrackedCamera::kTarget
                                                : session::TrackedCamera::kFisheye;
  MIXRIG_ASSIGN(options.world_from_base, place_of_room(arguments.scene));
  options.tracker.start_radius_m = arguments.start_m;
  options.tracker.start_radius_rad = arguments.start_deg * kDeg;
  options.smooth_s = arguments.smooth_s, options.anew = arguments.anew;
  options.drawings = arguments.drawings;
  options.threads = arguments.threads;
  MIXRIG_ASSIGN(const session::RoomTrack track, session::track_room(options));
  const nlohmann::json json = session::to_json(track);
  print(track, json);
  if (track.counts.lost == track.counts.pictures)
    return Error{ErrorCode::kData, arguments.take +
                                       ": the room explains none of its pictures: is it a take of "
                                       "this room, and is the camera calibrated?"};
  if (!arguments.tum.empty()) MIXRIG_TRY(write_file(arguments.tum, session::to_tum(track)));
  return with_end(json, arguments.tum, as_trajectory(arguments.tum));
}

Result<nlohmann::json> track_by_map(const TrackArguments& arguments, const MapJobs& jobs) {
  if (jobs.track == nullptr) return live::extra_left_out("track: --map", "map");
  MapTrackArguments given{.map = arguments.map,
                          .take = arguments.take,
                          .calibration = arguments.calibration,
                          .tum = arguments.tum,
                          .world_from_room = {},
                          .threads = arguments.threads};
  MIXRIG_ASSIGN(given.world_from_room, place_of_room(arguments.scene));
  return jobs.track(given);
}

Result<nlohmann::json> track(const TrackArguments& arguments) {
  const int sources = (arguments.mocap.empty() ? 0 : 1) + (arguments.model.empty() ? 0 : 1) +
                      (arguments.map.empty() ? 0 : 1);
  if (sources != 1)
    return Error{ErrorCode::kUsage,
                 "track: give one of --mocap, --model with --take, --map with --take"};
  MIXRIG_TRY(check_output_file(arguments.tum, kTrajectoryBegin, "OUT"));
  if (!arguments.map.empty()) {
    if (arguments.take.empty())
      return Error{ErrorCode::kUsage,
                   "track: --map needs --take: give the take whose pictures are tracked"};
    return track_by_map(arguments, map_jobs());
  }
  if (!arguments.model.empty()) {
    if (arguments.take.empty())
      return Error{ErrorCode::kUsage,
                   "track: --model needs --take: give the take whose pictures are tracked"};
    return track_in_room(arguments);
  }
  MIXRIG_ASSIGN(const auto options, track_options(arguments));
  MIXRIG_ASSIGN(const auto body, constellation_of(arguments));
  MIXRIG_ASSIGN(const Frames all, read_frames(arguments));
  const auto track = body ? mocap::track_markers(all.frames, *body, options)
                          : mocap::track_bodies(all.frames, options);
  if (!track) return Error{track.error().code, arguments.mocap + ": " + track.error().context};
  print(*track, all.live);
  if (track->poses.empty())
    return Error{ErrorCode::kData,
                 arguments.mocap + ": no frame has a pose" +
                     (track->refused.empty() ? "" : ": " + track->refused.begin()->first)};
  if (!arguments.tum.empty()) MIXRIG_TRY(write_file(arguments.tum, mocap::to_tum(*track)));
  return with_end({{"frames", track->frames},
                   {"poses", track->poses.size()},
                   {"residual_rms_m", track->residual_rms_m},
                   {"refused", track->refused},
                   {"live", all.live ? to_json(*all.live) : nlohmann::json()}},
                  arguments.tum, as_trajectory(arguments.tum));
}

}  // namespace

void add_track_command(Command app, Context& context) {
  auto arguments = std::make_shared<TrackArguments>();
  Command command = app.add_subcommand("track", "the pose of every frame, as TUM lines");
  command.add_option("--mocap", arguments->mocap,
                     "motion capture: CSV of markers or bodies, NatNet packets as sent, or live: "
                     "natnet[:HOST[:PORT]][,GROUP]");
  command.add_option("--model", arguments->model,
                     "room written by scan, in which the camera of --take is tracked");
  command.add_option("--map", arguments->map,
                     "map written by learn, in which the camera of --take is tracked that learned "
                     "it; poses are in its axes, in the room's after align --room");
  add_take_option(command, arguments->take, "--model, --map");
  command.add_option("--camera", arguments->camera, "--model: by whose pictures")
      .one_of({"fisheye", "target"})
      .show_default();
  command.add_option("--scene", arguments->scene,
                     "--model, --map of a room: scene.toml that says where the room stands; else "
                     "poses are in its own axes where its folder does not say");
  command
      .add_option("--start-m", arguments->start_m,
                  "--model: the first pose is looked for so far from the place of the scan")
      .show_default()
      .range(0.0, 5.0);
  command
      .add_option("--start-deg", arguments->start_deg,
                  "--model: and turned so far from where the scan looked; 180: any way")
      .show_default()
      .range(0.0, 180.0);
  command.add_flag(
      "--anew", arguments->anew,
      "--model: every picture is looked for as the first one is, and the report counts "
      "those that were found, and found wrong");
  command
      .add_option("--smooth", arguments->smooth_s,
                  "--model: seconds before and after each pose whose poses smooth it: the latency; "
                  "0: none")
      .show_default()
      .range(0.0, 1.0);
  command.add_option("--draw", arguments->drawings,
                     "--model: folder for the pictures with their patches, green where they count");
  command.add_option("--threads", arguments->threads, "--model, --map: 0: one per core")
      .non_negative();
  command.add_option("--constellation", arguments->constellation,
                     "TOML of the body's markers: poses are computed from markers alone");
  command.add_option("--body", arguments->body, "number of the rigid body; 0: the only one")
      .non_negative();
  command.add_option("--calibration", arguments->calibration,
                     "calibration.toml with the body: the result is poses of the target camera");
  command.add_option("--up", arguments->up, "axis of the recording that points up")
      .one_of({"y", "z"})
      .show_default();
  command.add_option("--natnet", arguments->version, "version of packets that do not state theirs")
      .show_default();
  command
      .add_option("--duration", arguments->duration_s,
                  "seconds of a live stream; if not given, until Ctrl-C or 5 s without data")
      .positive();
  command.add_option("--frames", arguments->frames, "number of frames of a live stream");
  command.add_option("OUT", arguments->tum,
                     "trajectory in TUM format, z up; --model, --map of a room: of the target "
                     "camera at its pictures; --map: of the camera that learned it, in its axes");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return track(*arguments); }; });
}

}  // namespace mixrig::tools
