// SPDX-License-Identifier: Apache-2.0
// Sets objects where the viewfinder was clicked, as a sink.
#pragma once

#include <memory>
#include <string>

#include "host/operator/desk/scene_desk.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/run_orders.h"

namespace mixrig::session {

/// Obeys output::PlaceObject with the view of the next frame; the scene file is written, and the
/// run follows it. Errors of a placement are logged and told by RunState::placed, and are none of
/// the sink. `session` and `orders` outlive it.
class PlaceSink final : public output::CompositeSink {
 public:
  PlaceSink(const Session& session, std::shared_ptr<SceneFollower> follower,
            output::RunOrders& orders);

  std::string_view name() const override { return "place"; }
  /// Only frames that an object is to be placed with.
  render::OutputMask wanted(int number) const override;
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override { return {}; }

 private:
  Result<void> place(const output::Composite& composite, const output::PlaceObject& order);

  output::RunOrders& orders_;
  SceneDesk desk_;
};

}  // namespace mixrig::session
