// SPDX-License-Identifier: Apache-2.0
// Sends poses of a run to other programs: [[pose_out]] of a scene.
#pragma once

#include <vector>

#include "extras/broadcast/poses/pose_sink.h"
#include "host/run/controls/run_extra.h"

namespace mixrig::broadcast {

class BroadcastExtra final : public session::RunExtra {
 public:
  /// Opens a sink for the poses. Errors: those of PoseSink::create(), with the scene's name.
  Result<std::vector<std::unique_ptr<output::CompositeSink>>> open(
      const session::ExtraSetup& setup) override;
  void add_to(nlohmann::json& report) const override;

 private:
  std::vector<session::PoseOutReport> reports_;  ///< in the order of the scene
};

}  // namespace mixrig::broadcast
