// SPDX-License-Identifier: Apache-2.0
#include "host/tools/extras.h"

#include <memory>
#include <string>

#ifdef MIXRIG_EXTRA_BROADCAST
#include "extras/broadcast/lens/freed_lens.h"
#include "extras/broadcast/poses/broadcast_extra.h"
#include "extras/broadcast/poses/scene_poses.h"
#endif
#ifdef MIXRIG_EXTRA_KINECT2
#include "extras/kinect2/kinect2_driver.h"
#endif
#ifdef MIXRIG_EXTRA_LIBCAMERA
#include "extras/libcamera/libcamera_driver.h"
#endif
#ifdef MIXRIG_EXTRA_OPENNI2
#include "extras/openni2/openni2_driver.h"
#endif
#ifdef MIXRIG_EXTRA_PEOPLE
#include "extras/people/watch/people_extra.h"
#endif
#ifdef MIXRIG_EXTRA_STUDIO
#include "studio/io/studio_source.h"
#endif

namespace mixrig::tools {
namespace {

[[maybe_unused]] live::DeviceKind left_out(std::string_view scheme, std::string_view extra) {
  live::DeviceKind kind;
  kind.scheme = scheme, kind.extra = extra;
  return kind;
}

}  // namespace

session::SourceKinds source_kinds() {
  return {
      .sources =
          {
#ifdef MIXRIG_EXTRA_STUDIO
              {"studio", "studio[:SCENARIO,SEED,RIG]", studio_io::open_studio_source},
#else
              {"studio", {}, nullptr},
#endif
          },
      .devices =
          {
#ifdef MIXRIG_EXTRA_LIBCAMERA
              device::libcamera_kind(),
#else
              left_out("libcamera", "libcamera"),
#endif
#ifdef MIXRIG_EXTRA_OPENNI2
              device::openni2_kind(),
#else
              left_out("openni2", "openni2"),
#endif
#ifdef MIXRIG_EXTRA_KINECT2
              device::kinect2_kind(),
#else
              left_out("kinect2", "kinect2"),
#endif
#ifdef MIXRIG_EXTRA_BROADCAST
              stream::freed_lens_kind(),
#else
              left_out("freed", "broadcast"),
#endif
          },
  };
}

MapJobs map_jobs() {
#ifdef MIXRIG_EXTRA_MAP
  return {track_in_map, join_maps, place_map};
#else
  return {};
#endif
}

std::vector<session::ExtraPoses> extra_poses() {
  std::vector<session::ExtraPoses> poses;
#ifdef MIXRIG_EXTRA_BROADCAST
  for (const session::ExtraPoses& extra : broadcast::scene_poses()) poses.push_back(extra);
#endif
  return poses;
}

session::RunExtras run_extras() {
  session::RunExtras extras;
#ifdef MIXRIG_EXTRA_BROADCAST
  extras.push_back(std::make_shared<broadcast::BroadcastExtra>());
#endif
#ifdef MIXRIG_EXTRA_PEOPLE
  extras.push_back(std::make_shared<session::PeopleExtra>());
#endif
  return extras;
}

Result<void> check_extras(const scene::Scene& scene) {
  [[maybe_unused]] const auto left_out = [&](const char* key, const char* extra) {
    return live::extra_left_out(scene.path.string() + ": " + key, extra);
  };
#ifndef MIXRIG_EXTRA_BROADCAST
  if (!scene.pose_outs.empty()) return left_out("pose_out", "broadcast");
#endif
#ifndef MIXRIG_EXTRA_PEOPLE
  if (scene.follow_people) return left_out("people", "people");
  if (scene.events) return left_out("events", "people");
  for (const scene::Object& object : scene.objects)
    if (object.physics) return left_out("object.physics", "people");
#endif
  return {};
}

}  // namespace mixrig::tools
