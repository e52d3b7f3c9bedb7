// SPDX-License-Identifier: Apache-2.0
#include "host/tools/run_extras.h"

#include <algorithm>
#include <string>

#ifdef MIXRIG_EXTRA_BROADCAST
#include "extras/broadcast/poses/broadcast_extra.h"
#include "extras/broadcast/poses/scene_poses.h"
#endif
#ifdef MIXRIG_EXTRA_PEOPLE
#include "extras/people/watch/people_extra.h"
#endif

namespace mixrig::tools {
namespace {

#ifdef MIXRIG_EXTRA_BROADCAST
constexpr bool kHasBroadcast = true;
#else
constexpr bool kHasBroadcast = false;
#endif
#ifdef MIXRIG_EXTRA_PEOPLE
constexpr bool kHasPeople = true;
#else
constexpr bool kHasPeople = false;
#endif

Error without(const scene::Scene& scene, const std::string& key, const std::string& extra) {
  return {ErrorCode::kUnsupported, scene.path.string() + ": " + key +
                                       ": this mixrig was built without it: build it with " +
                                       extra + " in MIXRIG_EXTRAS, or remove " + key};
}

}  // namespace

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
  if (!kHasBroadcast && !scene.pose_outs.empty()) return without(scene, "pose_out", "broadcast");
  if (kHasPeople) return {};
  if (scene.follow_people) return without(scene, "people", "people");
  if (scene.events) return without(scene, "events", "people");
  const bool moves = std::any_of(scene.objects.begin(), scene.objects.end(),
                                 [](const scene::Object& o) { return o.physics.has_value(); });
  return moves ? Result<void>(without(scene, "object.physics", "people")) : Result<void>();
}

}  // namespace mixrig::tools
