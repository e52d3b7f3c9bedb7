// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/poses/broadcast_extra.h"

#include <utility>

#include <nlohmann/json.hpp>

namespace mixrig::broadcast {

Result<std::vector<std::unique_ptr<output::CompositeSink>>> BroadcastExtra::open(
    const session::ExtraSetup& setup) {
  const scene::Scene& scene = setup.session.scene;
  std::vector<std::unique_ptr<output::CompositeSink>> sinks;
  if (!setup.epoch || scene.pose_outs.empty()) return sinks;
  const bool live = setup.session.source->info().is_live();
  const auto begin = live ? std::nullopt : std::optional(setup.clock.now());
  auto poses = session::PoseSink::create(scene.pose_outs, setup.epoch, begin, reports_);
  if (!poses) return Error{poses.error().code, scene.path.string() + ": " + poses.error().context};
  sinks.push_back(*std::move(poses));
  return sinks;
}

void BroadcastExtra::add_to(nlohmann::json& report) const {
  if (!reports_.empty()) report["pose_out"] = session::to_json(reports_);
}

}  // namespace mixrig::broadcast
