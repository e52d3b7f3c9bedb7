// SPDX-License-Identifier: Apache-2.0
#include "host/capture/open/open_source.h"

#include <algorithm>
#include <filesystem>
#include <utility>

#include "hal/base/log.h"
#include "host/capture/capture/preloaded_source.h"
#include "host/capture/live/session/live_capture.h"
#include "host/capture/live/session/live_source.h"
#include "host/capture/take/take_source.h"
#include "host/scene/pose_kind.h"

namespace mixrig::session {
Result<std::unique_ptr<capture::CaptureSource>> open_source(const std::string& uri,
                                                            const SourceKinds& kinds) {
  const std::size_t colon = uri.find(':');
  const std::string scheme = uri.substr(0, colon);
  const std::string rest = colon == std::string::npos ? "" : uri.substr(colon + 1);
  if (scheme == "take" && !rest.empty()) return take::open_take_source(rest);
  std::string known = "take:DIR, ";
  for (const SourceKind& kind : kinds.sources) {
    if (kind.scheme == scheme)
      return kind.open != nullptr ? kind.open(rest)
                                  : live::extra_left_out("--source " + uri, kind.scheme);
    if (kind.open != nullptr) known += std::string(kind.uri) + ", ";
  }
  std::error_code code;
  if (std::filesystem::is_directory(uri, code)) return take::open_take_source(uri);
  return Error{ErrorCode::kUsage,
               "--source \"" + uri + "\" is not a source: use " + known + "or rig[:RIG.TOML]"};
}

std::vector<live::Recording> open_recordings(const live::RigConfig& rig, const SourceKinds& kinds,
                                             PlayOptions play) {
  std::vector<std::string_view> schemes;
  for (const SourceKind& kind : kinds.sources) schemes.push_back(kind.scheme);
  std::vector<live::Recording> recordings;
  for (const std::string& uri : live::recordings_of(rig, schemes)) {
    auto source = open_source(uri, kinds);
    if (play.preload && source) source = capture::preloaded(*std::move(source));
    if (play.frames > 0 && source) source = capture::repeated(*std::move(source), play.frames);
    recordings.push_back({uri, std::move(source)});
  }
  return recordings;
}

live::DeviceOpener device_opener(const live::RigConfig& rig, const SourceKinds& kinds, Clock& clock,
                                 PlayOptions play) {
  return live::DeviceOpener(clock, open_recordings(rig, kinds, play), kinds.devices);
}

void leave_out_cameras(live::RigConfig& rig, bool keep_fisheye) {
  std::vector<live::CameraConfig> used;
  for (live::CameraConfig& camera : rig.cameras) {
    if (used.empty() || (keep_fisheye && camera.name == live::kFisheye))
      used.push_back(std::move(camera));
    else
      log_info("session", "camera \"" + camera.name + "\" is not used");
  }
  rig.cameras = std::move(used);
}

live::RigConfig used_by(const scene::Scene& scene, live::RigConfig rig) {
  const bool head = scene::head_use(scene) != scene::HeadUse::kNone;
  leave_out_cameras(rig, scene.pose_source == scene::PoseSource::kTracker);
  if (!head && !rig.pan_tilt_uri.empty()) log_info("session", "the head is not used by the scene");
  if (!head) rig.pan_tilt_uri.clear();
  return without_idle_trigger(std::move(rig));
}

live::RigConfig without_idle_trigger(live::RigConfig rig) {
  const auto fired = [&](const live::CameraConfig& camera) { return camera.trigger_line >= 0; };
  const bool any_fired = std::any_of(rig.cameras.begin(), rig.cameras.end(), fired) ||
                         (rig.depth && fired(*rig.depth)) || (rig.depth2 && fired(*rig.depth2));
  if (any_fired) return rig;
  if (!rig.trigger_uri.empty()) log_info("session", "the trigger fires none of the used cameras");
  rig.trigger_uri.clear();
  rig.edges_uri.clear();
  return rig;
}

Result<std::unique_ptr<capture::CaptureSource>> open_rig(
    const std::filesystem::path& rig_toml, const scene::Scene& scene, const std::atomic<bool>& stop,
    Clock& clock, const SourceKinds& kinds, PlayOptions play,
    std::shared_ptr<live::CameraSettings> settings, std::shared_ptr<live::RunningRig> running,
    bool lends) {
  MIXRIG_ASSIGN(live::RigConfig rig, live::read_rig(rig_toml));
  rig = used_by(scene, std::move(rig));
  if (lends && !rig.cameras.empty()) rig.cameras.front().request.lends = true;
  if (scene::head_use(scene) == scene::HeadUse::kFollowed && rig.pan_tilt_uri.empty())
    return Error{ErrorCode::kFormat,
                 scene.path.string() + ": camera.pose: \"" + scene::name(scene.pose_source) +
                     "\", but " + rig_toml.string() + " has no head: add [pan_tilt] with its uri"};
  if (scene.pose_source == scene::PoseSource::kTracker && live::fisheye_index(rig) == 0)
    return Error{ErrorCode::kFormat, scene.path.string() + ": camera.pose: \"tracker\", but " +
                                         rig_toml.string() +
                                         " has no fisheye: add another [[camera]] with name = "
                                         "\"fisheye\""};
  MIXRIG_ASSIGN(live::Devices devices,
                live::open_devices(rig, device_opener(rig, kinds, clock, play)));
  return live::make_live_source(std::move(rig), std::move(devices), stop, clock,
                                live::WhenLost::kGoOn, std::move(settings), std::move(running));
}

}  // namespace mixrig::session
