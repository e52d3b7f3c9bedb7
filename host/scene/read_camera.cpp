// SPDX-License-Identifier: Apache-2.0
#include "host/scene/read_camera.h"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "hal/base/angles.h"
#include "host/capture/calibration_file/tables.h"

namespace mixrig::scene {
namespace {

using config::Table;

constexpr std::array<const char*, 10> kPoses{
    "take",     "floor",      "identity", "fixed",      "recorded",
    "pan_tilt", "mocap:HOST", "tracker",  "freed:PORT", "opentrackio:PORT"};
/// Pose sources that name an address after a colon.
struct Scheme {
  PoseSource source;
  const char *name, *missing;
};
constexpr std::array<Scheme, 3> kSchemes{
    {{PoseSource::kMocap, "mocap", "names no server: write \"mocap:\" and its name or address"},
     {PoseSource::kFreeD, "freed", "names no port: write \"freed:[HOST:]PORT[,CAMERA][@SENDER]\""},
     {PoseSource::kOpenTrack, "opentrackio",
      "names no port: write \"opentrackio:[HOST:]PORT[,SOURCE][@SENDER]\""}}};
constexpr double kMs = 1e-3;

/// A key of [camera] that belongs to one pose source, or to several.
struct OwnKey {
  const char* key;
  PoseSource of;
};
constexpr std::array<OwnKey, 20> kOwnKeys{{{"trajectory", PoseSource::kRecorded},
                                           {"time_offset_s", PoseSource::kRecorded},
                                           {"world_from_target", PoseSource::kFixed},
                                           {"world_from_base", PoseSource::kPanTilt},
                                           {"constellation", PoseSource::kMocap},
                                           {"body", PoseSource::kMocap},
                                           {"up", PoseSource::kMocap},
                                           {"delay_ms", PoseSource::kMocap},
                                           {"delay_ms", PoseSource::kFreeD},
                                           {"delay_ms", PoseSource::kOpenTrack},
                                           {"world_from_tracker", PoseSource::kFreeD},
                                           {"world_from_tracker", PoseSource::kOpenTrack},
                                           {"sigma_mm", PoseSource::kFreeD},
                                           {"sigma_mm", PoseSource::kOpenTrack},
                                           {"sigma_deg", PoseSource::kFreeD},
                                           {"sigma_deg", PoseSource::kOpenTrack},
                                           {"rate_hz", PoseSource::kFreeD},
                                           {"stamps", PoseSource::kOpenTrack},
                                           {"predict", PoseSource::kTracker},
                                           {"smooth_ms", PoseSource::kTracker}}};

Eigen::Vector3d corner(const Table& box, const char* key) {
  const auto v = box.numbers(key, 3, 3, {-1e4, 1e4});
  return {v[0], v[1], v[2]};
}

PoseSource read_source(const Table& table, CameraPoses& camera) {
  const std::string text = table.text_or("pose", "take");
  for (const Scheme& scheme : kSchemes) {
    const std::string prefix = std::string(scheme.name) + ":";
    if (!text.starts_with(prefix)) continue;
    const std::string address = text.substr(prefix.size());
    if (address.empty() || address == "HOST" || address == "PORT")
      table.fail("pose", scheme.missing);
    (scheme.source == PoseSource::kMocap ? camera.mocap.server : camera.stream.address) = address;
    return scheme.source;
  }
  return static_cast<PoseSource>(table.one_of("pose", {kPoses.begin(), kPoses.end()}, 0));
}

/// Refuses keys of another pose source, since the scene would name two.
void refuse_others(const Table& table, PoseSource source) {
  for (const OwnKey& own : kOwnKeys) {
    const auto is_used = [&](const OwnKey& other) {
      return other.of == source && std::string_view(other.key) == own.key;
    };
    if (table.has(own.key) && std::none_of(kOwnKeys.begin(), kOwnKeys.end(), is_used))
      return table.fail(own.key, std::string("belongs to pose = \"") + name(own.of) +
                                     "\", but pose is \"" + name(source) +
                                     "\": two pose sources, remove one");
  }
}

void read_stream(const Table& table, TrackerStream& stream, PoseSource source) {
  stream.world_from_tracker = calibration_file::parse_pose(table.table("world_from_tracker"));
  stream.delay_s = kMs * table.number_or("delay_ms", 0, {0, 1e4});
  stream.rate_hz = table.number_or("rate_hz", 0, {1, 1000});
  using Stamps = TrackerStream::Stamps;
  stream.stamps = static_cast<Stamps>(table.one_of("stamps", {"arrival", "system", "ptp"}, 0));
  if (table.has("sigma_mm")) stream.sigma_m = kMs * table.number("sigma_mm", {0, 1e4});
  if (table.has("sigma_deg")) stream.sigma_rad = kDeg * table.number("sigma_deg", {0, 90});
  if (stream.sigma_m.has_value() != stream.sigma_rad.has_value())
    table.fail(stream.sigma_m ? "sigma_mm" : "sigma_deg",
               "given alone: give both sigma_mm and sigma_deg, or none");
  if (stream.stamps != Stamps::kArrival && table.has("delay_ms"))
    table.fail("delay_ms",
               "given beside stamps = \"system\" or \"ptp\", which need none: remove it");
  if (source == PoseSource::kFreeD && !table.has("rate_hz"))
    table.fail("rate_hz",
               "missing: FreeD has no time stamps, give the rate at which the head sends, such as "
               "50.0 or 59.94");
}

void read_own_keys(const Table& table, const std::filesystem::path& folder, PoseSource source,
                   CameraPoses& camera) {
  // Every key is read, so that each is known.
  if (table.has("trajectory")) camera.trajectory = config::path_at(table, "trajectory", folder);
  camera.time_offset_s = table.number_or("time_offset_s", 0, {-1e12, 1e12});
  const Table fixed = table.table("world_from_target"), base = table.table("world_from_base");
  camera.world_from_target = calibration_file::parse_pose(fixed);
  camera.world_from_base = calibration_file::parse_pose(base);
  MocapSettings& mocap = camera.mocap;
  if (table.has("constellation"))
    mocap.constellation = config::path_at(table, "constellation", folder);
  mocap.body = table.integer_or("body", 0, {0, 1e9});
  mocap.y_up = table.one_of("up", {"y", "z"}, 0) == 0;
  read_stream(table, camera.stream, source);
  mocap.delay_s = camera.stream.delay_s;
  camera.predict = static_cast<Predict>(table.one_of("predict", {"velocity", "head", "both"}, 0));
  camera.smooth_s = kMs * table.number_or("smooth_ms", 0, {0, 500});
  if (!mocap.constellation.empty() && table.has("body"))
    table.fail("body", "given beside constellation: remove one of them");
  if (source == PoseSource::kFixed && !fixed.present())
    table.fail("world_from_target",
               "missing: pose = \"fixed\" needs { rotation_xyzw = [...], translation_m = [...] }");
  if (source == PoseSource::kRecorded && table.has("time_offset_s") && !table.has("trajectory"))
    table.fail("time_offset_s",
               "needs a trajectory: the take's own poses are on the take's own clock");
}

}  // namespace

void read_camera(const Table& table, const std::filesystem::path& folder, Scene& scene) {
  CameraPoses& camera = scene.camera;
  scene.pose_source = read_source(table, camera);
  refuse_others(table, scene.pose_source);
  read_own_keys(table, folder, scene.pose_source, camera);
  camera.max_age_s = kMs * table.number_or("max_age_ms", camera.max_age_s / kMs, {0, 1e6});
  camera.when_lost = static_cast<WhenLost>(table.one_of("when_lost", {"freeze", "hide"}, 0));
  const Table box = table.table("capture_volume");
  const Eigen::Vector3d min_m = corner(box, "min_m"), max_m = corner(box, "max_m");
  const double tolerance_m = box.number_or("floor_tolerance_m", 0.01, {0, 1});
  if (!box.present()) return;
  if (!(min_m.array() < max_m.array()).all())
    box.fail("min_m", "must lie below max_m on every axis: swap them");
  scene.capture_volume = CaptureVolume{min_m, max_m, tolerance_m};
}

}  // namespace mixrig::scene
