// SPDX-License-Identifier: Apache-2.0
// What a run tells: speed, memory, error. Keys and definitions stand in CONVENTIONS.md.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "hal/base/image.h"
#include "host/measure/errors.h"
#include "host/render/compositor.h"

namespace mixrig::app {

struct RunReport {
  std::string backend;   ///< "cpu" or "gles"
  std::string renderer;  ///< as Compositor::renderer
  Size size;
  std::vector<float> frame_ms;  ///< decoded frame to finished composite, every frame, the first too
  std::array<std::vector<float>, static_cast<std::size_t>(render::Stage::kCount)> stage_ms;
  std::vector<double> foreground_pct;  ///< pixels with matte >= 0.5, a frame
  std::string ended = "frames";        ///< what ended it: "frames", "stopped", "end of the source"
  nlohmann::json live;                 ///< as FrameSource::report
  double rss_mb = 0;                   ///< peak
  std::optional<measure::Errors> error;
};

/// One over the mean frame time; 0 without frames.
double fps(const RunReport& report);
/// An error measure that had nothing to judge becomes null.
nlohmann::json to_json(const RunReport& report);
nlohmann::json to_json(const measure::Errors& errors);
/// The same to read: stages with median and 95th percentile, then the errors.
std::string to_table(const RunReport& report);

/// Peak resident set of this process, from /proc/self/status; 0 where that is not to be had.
double peak_rss_mb();
/// "1280x1024".
std::string text(Size size);

}  // namespace mixrig::app
