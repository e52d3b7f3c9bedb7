// SPDX-License-Identifier: Apache-2.0
// Sets objects where the viewfinder was clicked, as a sink.
#pragma once

#include <memory>
#include <string>

#include "host/operator/desk/scene_desk.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/run_controls.h"

namespace mixrig::session {

/// Obeys the controls' place_at with the view of the next frame; the scene file is written, and the
/// run follows it. Errors of a placement are logged and told by place_said, and are none of the
/// sink. `session` and `controls` outlive it.
class PlaceSink final : public output::CompositeSink {
 public:
  PlaceSink(const Session& session, std::shared_ptr<SceneFollower> follower,
            output::RunControls& controls);

  std::string_view name() const override { return "place"; }
  /// Only frames that an object is to be placed with.
  render::OutputMask wanted(int number) const override;
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override { return {}; }

 private:
  Result<void> place(const output::Composite& composite, int px);

  output::RunControls& controls_;
  SceneDesk desk_;
};

}  // namespace mixrig::session
