// SPDX-License-Identifier: Apache-2.0
// Sink that places objects where the viewfinder was clicked.
#pragma once

#include <memory>
#include <string>

#include "host/operator/desk/scene_desk.h"
#include "host/output/sink/composite_sink.h"
#include "host/output/sink/run_orders.h"

namespace mixrig::session {

/// Handles output::PlaceObject with the view of the next frame: writes the scene file, which the
/// run follows. Errors of a placement are logged and reported by RunState::placed; they do not fail
/// the sink. `session` and `orders` must outlive it.
class PlaceSink final : public output::CompositeSink {
 public:
  PlaceSink(const Session& session, std::shared_ptr<SceneFollower> follower,
            output::RunOrders& orders);

  std::string_view name() const override { return "place"; }
  /// Wants only frames with which an object is to be placed.
  render::OutputMask wanted(int number) const override;
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override { return {}; }

 private:
  Result<void> place(const output::Composite& composite, const output::PlaceObject& order);

  output::RunOrders& orders_;
  SceneDesk desk_;
};

}  // namespace mixrig::session
