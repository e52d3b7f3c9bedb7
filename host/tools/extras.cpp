// SPDX-License-Identifier: Apache-2.0
#include "host/tools/extras.h"

#ifdef MIXRIG_EXTRA_BROADCAST
#include "extras/broadcast/lens/freed_lens.h"
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

}  // namespace mixrig::tools
