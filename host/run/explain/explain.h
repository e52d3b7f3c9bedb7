// SPDX-License-Identifier: Apache-2.0
// Explains the passes, buffers and shadow maps of a scene, with reasons and measured cost.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/clock.h"
#include "hal/base/result.h"
#include "host/run/controls/run_extra.h"
#include "host/run/session/quality.h"
#include "host/run/session/session.h"

namespace mixrig::session {

struct BufferLine {
  std::string name, size;
  std::size_t bytes = 0;
};
struct ShadowMapLine {
  std::string lamp;
  int size_texel = 0;  ///< 0: this lamp casts no shadow
  std::string why;
};

struct Explanation {
  std::string scene, source, backend, renderer;
  std::string calibration;  ///< which calibration is used, and why
  std::string camera;       ///< source of the camera's pose
  std::string levels;       ///< quality levels in use, such as "key refined, light people"
  std::optional<QualityChoice> quality{};  ///< set if they follow from a budget
  int frames = 0;                          ///< frames composited for the measurement
  double frame_p50_ms = 0, rss_mb = 0;
  double still_p50_ms = 0;  ///< repeating the first frame, the camera at rest
  /// Repeating it with changing poses; absent if impossible.
  std::optional<double> moving_p50_ms{};
  std::vector<PassLine> passes;
  std::vector<ShadowMapLine> shadow_maps;
  std::vector<BufferLine> buffers;  ///< kept from frame to frame
};

/// Composites the first `frames` frames after the learned ones and reports what ran, including
/// extras. Errors: those of run().
Result<Explanation> explain(Session& session, int frames, RunExtras extras, const Clock& clock,
                            const ProgressFn& progress);

nlohmann::json to_json(const Explanation& explanation);
std::string to_text(const Explanation& explanation);

}  // namespace mixrig::session
