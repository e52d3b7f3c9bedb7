// SPDX-License-Identifier: Apache-2.0
// Follows lamps that are switched or dimmed while a run goes on ([light] follow of the scene).
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

/// A lamp that gave other light from a frame on.
struct LampEvent {
  int frame = 0;
  std::string lamp;   ///< its name, or "ambient"
  double factor = 1;  ///< of the light that the scene tells
};

struct LightReport {
  std::vector<LampEvent> changed;    ///< the first kMostEvents
  int looks = 0, unexplained = 0;    ///< frames that were looked at; that the lamps do not explain
  measure::QuantileSketch watch_ms;  ///< of a look, on a thread of its own
};
/// docs/reference/report.md has the keys.
nlohmann::json to_json(const LightReport& report);

class LightSink;

/// For the compositing thread of one run.
class LightKeeper {
 public:
  LightKeeper(const Session& session, bool live) : session_(session), live_(live) {}

  /// Errors: kFormat without a lamp, or where the background is not one view of a camera that
  /// stands still: only there is told what each lamp gives to a pixel.
  Result<void> open(WorkGate* gate);
  bool is_open() const { return watch_.sink() != nullptr; }
  /// Gives one of five finished frames to the watch, and that two after one in which it found a
  /// change. Errors: those of an earlier one.
  Result<void> push(const output::CompositePtr& composite);
  /// What was found counts from now on.
  void take_factors();
  /// Light of a frame: that of the scene, or `live` in its place, with the factors. Valid until the
  /// next call. Allocates on the first call only.
  render::FrameLight changed(const scene::Light& light,
                             const std::optional<render::FrameLight>& live);
  Result<void> finish();
  LightReport report() const;  ///< after finish()

 private:
  const Session& session_;
  const bool live_;
  int next_look_ = 0, last_look_ = 0;  ///< numbers of frames
  std::vector<float> factors_;         ///< ambient, then lamps; empty: nothing was found yet
  std::vector<glm::vec3> intensity_;
  FrameWatch<LightSink> watch_;
};

}  // namespace mixrig::session
