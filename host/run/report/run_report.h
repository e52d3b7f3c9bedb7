// SPDX-License-Identifier: Apache-2.0
// The report of a run: speed, memory, error. CONVENTIONS.md defines the keys.
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

/// Poses of the frames, and the lens.
struct PoseReport {
  std::string source;  ///< as PoseSourceInfo::name
  pose::WhenLost when_lost = pose::WhenLost::kFreeze;
  double latency_s = 0;  ///< as PoseSourceInfo::latency_s
  pose::FramePoseCounts frames;
  capture::PoseFaults faults;  ///< of the source's stream
  std::optional<capture::PoseStream> stream;
  std::optional<PoseErrors> error;  ///< where the true poses are known
  measure::QuantileSketch age_ms;   ///< frames with a pose
  SlipReport slip;
  std::optional<LensReport> lens;  ///< of a lens that zooms
};

/// How the camera's pictures came into the compositor.
struct PlateReport {
  std::uint64_t imported = 0;       ///< frames; read in the camera's memory
  std::uint64_t copied = 0;         ///< frames
  std::optional<RawLayout> layout;  ///< of imported ones
  std::string why_copied;           ///< as render::CompositorState::why_copied
};
/// "imported (DMABUF, yuyv)", "copied: the driver offers no ...".
std::string text(const PlateReport& plates);

/// What the loop measures of each frame.
struct FrameReport {
  measure::QuantileSketch frame_ms;  ///< decoded frame to finished composite, every frame
  std::array<measure::QuantileSketch, static_cast<std::size_t>(render::Stage::kCount)> stage_ms;
  measure::QuantileSketch latency_ms;      ///< live: mid-exposure to finished composite
  measure::QuantileSketch foreground_pct;  ///< pixels with matte >= 0.5, a frame
};

/// The compositor, and what it followed.
struct CompositorReport {
  std::string backend;   ///< "cpu" or "gles"
  std::string renderer;  ///< as Compositor::renderer
  Size size;
  std::optional<PlateReport> plates;              ///< of live devices
  std::optional<LightReport> light;               ///< where the lamps were followed
  std::optional<LookReport> look;                 ///< where plates were measured again
  std::optional<RoomChangesReport> room_changes;  ///< where the background was watched
  std::optional<SceneEdits> scene_edits;          ///< where the scene was followed
  measure::QuantileSketch swap_ms;                ///< of a frame that exchanged the compositor
};

/// What each part of a run told, put together when it has ended.
struct RunReport {
  std::string ended = "frames";  ///< why it ended: "frames", "stopped", "end of the source"
  FrameReport frames;
  CompositorReport compositor;
  PoseReport pose;
  std::optional<QualityChoice> quality;       ///< where the scene has a budget
  std::optional<capture::SourceReport> live;  ///< of live devices
  std::uint64_t before_ready = 0;             ///< live: captures not composited, since they were
                                              ///< late when the first frame could be made
  std::vector<output::SinkReport> sinks;
  std::vector<output::StreamOutReport> stream_outs;
  RunExtras extras;   ///< tell their own parts
  double rss_mb = 0;  ///< peak
  std::optional<measure::Errors> error;
  std::vector<BaselineErrors> baselines;  ///< none where they were not wanted
};

/// One over the mean frame time; 0 without frames.
double fps(const RunReport& report);
nlohmann::json to_json(const RunReport& report);
/// The same as a text table: stages with median and 95th percentile, then the errors.
std::string to_table(const RunReport& report);

/// Peak resident set of this process, from /proc/self/status; 0 where it is not available.
double peak_rss_mb();
/// "1280x1024".
std::string text(Size size);

}  // namespace mixrig::session
