// SPDX-License-Identifier: Apache-2.0
// The report of a run: speed, memory, error. docs/reference/report.md defines the keys.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "hal/base/image.h"
#include "hal/base/quantile_sketch.h"
#include "host/capture/capture/source_report.h"
#include "host/judge/baselines/baselines.h"
#include "host/judge/baselines/pose_errors.h"
#include "host/judge/baselines/slip.h"
#include "host/judge/measure/errors.h"
#include "host/output/sink/sink_thread.h"
#include "host/output/streams/stream_sink.h"
#include "host/pose/source/frame_poses.h"
#include "host/render/contract/compositor.h"
#include "host/room/background/frame_lens.h"
#include "host/run/controls/run_extra.h"
#include "host/run/controls/scene_follower.h"
#include "host/run/session/quality.h"
#include "host/run/watchers/light_keeper.h"
#include "host/run/watchers/look_keeper.h"
#include "host/run/watchers/room_changes_report.h"

namespace mixrig::session {

/// Statistics of the frames' poses and lens.
struct PoseReport {
  std::string source;  ///< PoseSourceInfo::name
  pose::WhenLost when_lost = pose::WhenLost::kFreeze;
  double latency_s = 0;  ///< PoseSourceInfo::latency_s
  pose::FramePoseCounts frames;
  capture::PoseFaults faults;  ///< faults of the source's stream
  std::optional<capture::PoseStream> stream;
  std::optional<PoseErrors> error;  ///< if true poses are known
  measure::QuantileSketch age_ms;   ///< over frames with a pose
  SlipReport slip;
  std::optional<LensReport> lens;  ///< of a zooming lens
};

/// How the camera's pictures came into the compositor.
struct PlateReport {
  std::uint64_t imported = 0;       ///< frames whose plate was read in the camera's memory
  std::uint64_t copied = 0;         ///< frames whose plate was copied
  std::optional<RawLayout> layout;  ///< layout of imported plates
  std::string why_copied;           ///< render::CompositorState::why_copied
};
/// One line, such as "imported (DMABUF, yuyv)" or "copied: the driver offers no ...".
std::string text(const PlateReport& plates);

/// Measurements of the loop over all frames.
struct FrameReport {
  measure::QuantileSketch frame_ms;  ///< decoded frame to finished composite
  std::array<measure::QuantileSketch, static_cast<std::size_t>(render::Stage::kCount)> stage_ms;
  measure::QuantileSketch latency_ms;      ///< live: mid-exposure to finished composite
  measure::QuantileSketch foreground_pct;  ///< share of a frame's pixels with a matte >= 0.5
};

/// Report of the compositor and of what it followed.
struct CompositorReport {
  std::string backend;   ///< "cpu" or "gles"
  std::string renderer;  ///< CompositorState::renderer
  Size size;
  std::optional<PlateReport> plates;              ///< of live devices
  std::optional<LightReport> light;               ///< if lamps were followed
  std::optional<LookReport> look;                 ///< if the look was measured again
  std::optional<RoomChangesReport> room_changes;  ///< if the background was watched
  std::optional<SceneEdits> scene_edits;          ///< if the scene file was followed
  measure::QuantileSketch swap_ms;                ///< of frames that replaced the compositor
};

/// Reports of all parts of a run, complete when it has ended.
struct RunReport {
  std::string ended = "frames";  ///< "frames", "stopped" or "end of the source"
  FrameReport frames;
  CompositorReport compositor;
  PoseReport pose;
  std::optional<QualityChoice> quality;       ///< if the scene has a budget
  std::optional<capture::SourceReport> live;  ///< of live devices
  /// Live: captures skipped because they were late when the first frame could be made.
  std::uint64_t before_ready = 0;
  std::vector<output::SinkReport> sinks;
  std::vector<output::StreamOutReport> stream_outs;
  RunExtras extras;   ///< report their own parts
  double rss_mb = 0;  ///< peak
  std::optional<measure::Errors> error;
  std::vector<BaselineErrors> baselines;  ///< empty if not requested
};

/// One over the mean frame time; 0 without frames.
double fps(const RunReport& report);
nlohmann::json to_json(const RunReport& report);
/// The report as a text table: stages with median and 95th percentile, then the errors.
std::string to_table(const RunReport& report);

/// Peak resident set of this process, from /proc/self/status; 0 if not available.
double peak_rss_mb();
/// The size as text, such as "1280x1024".
std::string text(Size size);

}  // namespace mixrig::session
