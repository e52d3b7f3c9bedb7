// SPDX-License-Identifier: Apache-2.0
#include "host/run/session/frame_cost.h"

#include "hal/base/quantile_sketch.h"
#include "host/room/background/frame_lens.h"

namespace mixrig::session {

Result<double> frame_cost_ms(const Session& session, const capture::Capture& capture, int warm_up,
                             int frames, double step_m, const Clock& clock) {
  MIXRIG_ASSIGN(const auto compositor, make_compositor(session.setup, session.backend));
  render::FrameOutput output;
  measure::QuantileSketch times_ms;
  geometry::Pose pose = session.world_from_target(capture);
  for (int i = 0; i < warm_up + frames; ++i) {
    pose.translation_m.x() += i % 2 == 0 ? step_m : -step_m;
    const HostTime begin = clock.now();
    MIXRIG_TRY(compositor->compose(
        {capture.plate, capture.depth_m, pose, frame_lens(capture), {}, capture.depth2.depth_m},
        output));
    if (i >= warm_up) times_ms.add(milliseconds(clock.now() - begin));
  }
  return times_ms.quantile(0.5);
}

}  // namespace mixrig::session
