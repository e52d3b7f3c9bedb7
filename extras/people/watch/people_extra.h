// SPDX-License-Identifier: Apache-2.0
// Adds [people], [events] and physics of a scene to a run.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "extras/people/watch/object_motion.h"
#include "extras/people/watch/people_sink.h"
#include "extras/people/watch/touch_stage.h"
#include "host/run/controls/run_extra.h"

namespace mixrig::session {

/// Tracks people where the scene asks for it, has events, or has objects that move by physics.
class PeopleExtra final : public RunExtra {
 public:
  /// Errors: those of PeopleSink and TouchStage.
  Result<std::vector<std::unique_ptr<output::CompositeSink>>> open(
      const ExtraSetup& setup) override;
  ObjectMover* mover() override { return motion_.get(); }
  void add_to(nlohmann::json& report) const override;
  std::string lines() const override;
  std::vector<PassLine> passes() const override;

 private:
  const Session* session_ = nullptr;  ///< after open()
  std::unique_ptr<ObjectMotion> motion_;
  std::optional<PeopleReport> people_;  ///< where they are followed
  std::optional<TouchReport> events_;   ///< where touching is watched
};

}  // namespace mixrig::session
