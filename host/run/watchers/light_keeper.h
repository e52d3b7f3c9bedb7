// SPDX-License-Identifier: Apache-2.0
// Follows lamps that are switched or dimmed during a run ([light] follow of the scene).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/quantile_sketch.h"
#include "host/run/session/session.h"
#include "host/run/watchers/frame_watch.h"

namespace mixrig::session {

/// A change of a lamp's light from a frame on.
struct LampEvent {
  int frame = 0;
  std::string lamp;   ///< the lamp's name, or "ambient"
  double factor = 1;  ///< relative to the scene's light
};

struct LightReport {
  std::vector<LampEvent> changed;    ///< the first kMostEvents
  int looks = 0, unexplained = 0;    ///< frames examined; those that the lamps do not explain
  measure::QuantileSketch watch_ms;  ///< of one frame, in the watching thread
};
/// docs/reference/report.md has the keys.
nlohmann::json to_json(const LightReport& report);

class LightSink;

/// For the compositing thread of one run.
class LightKeeper {
 public:
  LightKeeper(const Session& session, bool live) : session_(session), live_(live) {}

  /// Opens the watch. Errors: kFormat without a lamp or a virtual object, or if the background is
  /// not a single view of a still camera, for which alone each lamp's part in a pixel is known.
  Result<void> open(WorkGate* gate);
  bool is_open() const { return watch_.sink() != nullptr; }
  /// Gives about one of five finished frames to the watch, and the second frame after one in which
  /// it found a change. Errors: those of an earlier frame.
  Result<void> push(const output::CompositePtr& composite);
  /// Applies the changes found so far from now on.
  void take_factors();
  /// Light of a frame: the scene's, or `live` instead, times the factors. Valid until the next
  /// call. Allocates on the first call only.
  render::FrameLight changed(const scene::Light& light,
                             const std::optional<render::FrameLight>& live);
  Result<void> finish();
  LightReport report() const;  ///< precondition: finish() was called

 private:
  const Session& session_;
  const bool live_;
  int next_look_ = 0, last_look_ = 0;  ///< frame numbers
  std::vector<float> factors_;         ///< ambient light, then lamps; empty: nothing found yet
  std::vector<glm::vec3> intensity_;
  FrameWatch<LightSink> watch_;
};

}  // namespace mixrig::session
