// SPDX-License-Identifier: Apache-2.0
// Measures the time of each stage of a frame, and names groups for frame captures.
#pragma once

#include <array>

#include <GLES2/gl2.h>  // what gl2ext.h needs before it
#include <GLES2/gl2ext.h>
#include <GLES3/gl31.h>

#include "hal/base/clock.h"
#include "host/render/contract/compositor.h"
#include "host/render/gles/gl/egl_context.h"

namespace mixrig::render::gles {

/// Times of the stages of one frame. With GL_EXT_disjoint_timer_query the GPU stamps begin and end
/// of a stage, without waiting. Otherwise wall time counts: a frame alone on the GPU waits after
/// each stage; in a frame queued behind another, GPU stages only count the time of queueing. Host
/// stages always count wall time. Stages do not nest.
class StageTimer {
 public:
  explicit StageTimer(const EglContext& context);
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer();

  /// `alone`: nothing else is queued on the GPU.
  void begin_frame(bool alone);
  /// `on_host`: the stage works on the host (upload, copies out of buffers). Times of a stage that
  /// runs both on the GPU and on the host add up.
  void begin(Stage stage, bool on_host = false);
  void end();
  /// Returns the times once the GPU has drawn the frame; 0 for a stage that did not run.
  const StageTimes& finish_frame();

 private:
  static constexpr std::size_t kStages = static_cast<std::size_t>(Stage::kCount);
  GLuint query(std::size_t stage, bool end) const { return queries_[2 * stage + (end ? 1 : 0)]; }
  double gpu_ms(std::size_t stage) const;

  SystemClock clock_;
  // Entry points of the extensions, null where the driver lacks them.
  PFNGLQUERYCOUNTEREXTPROC query_counter_ = nullptr;
  PFNGLGETQUERYOBJECTUI64VEXTPROC query_result_ = nullptr;
  PFNGLPUSHDEBUGGROUPKHRPROC push_group_ = nullptr;
  PFNGLPOPDEBUGGROUPKHRPROC pop_group_ = nullptr;
  std::array<GLuint, 2 * kStages> queries_{};
  std::array<bool, kStages> on_gpu_{};
  std::size_t open_ = kStages;
  bool alone_ = true, open_on_host_ = false;
  HostTime began_{};
  StageTimes times_{};
};

/// Times a stage from here to the end of the block.
class StageScope {
 public:
  StageScope(StageTimer& timer, Stage stage, bool on_host = false) : timer_(timer) {
    timer_.begin(stage, on_host);
  }
  ~StageScope() { timer_.end(); }
  StageScope(const StageScope&) = delete;
  StageScope& operator=(const StageScope&) = delete;

 private:
  StageTimer& timer_;
};

}  // namespace mixrig::render::gles
