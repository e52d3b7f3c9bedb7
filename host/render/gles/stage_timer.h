// SPDX-License-Identifier: Apache-2.0
// How long each stage of a frame took, and named groups for frame captures.
#pragma once

#include <array>

#include <GLES2/gl2.h>  // what gl2ext.h needs before it
#include <GLES2/gl2ext.h>
#include <GLES3/gl31.h>

#include "hal/base/clock.h"
#include "host/render/compositor.h"
#include "host/render/gles/egl_context.h"

namespace mixrig::render::gles {

/// Times of the stages of a frame. With GL_EXT_disjoint_timer_query the GPU stamps a stage's
/// begin and end; without, and on the host's stages, the wall clock counts and a GPU stage ends
/// with glFinish. Stages do not nest.
class StageTimer {
 public:
  explicit StageTimer(const EglContext& context);
  StageTimer(const StageTimer&) = delete;
  StageTimer& operator=(const StageTimer&) = delete;
  ~StageTimer();

  void begin_frame();
  /// `on_host`: the stage works on the host or waits for it (upload, read-back).
  void begin(Stage stage, bool on_host = false);
  void end();
  /// Waits until all is drawn and gathers the times; a stage that did not run keeps 0.
  void finish_frame();
  const StageTimes& times() const { return times_; }

 private:
  static constexpr std::size_t kStages = static_cast<std::size_t>(Stage::kCount);
  GLuint query(std::size_t stage, bool end) const { return queries_[2 * stage + (end ? 1 : 0)]; }
  double gpu_ms(std::size_t stage) const;

  SystemClock clock_;
  // Null where the driver lacks them.
  PFNGLQUERYCOUNTEREXTPROC query_counter_ = nullptr;
  PFNGLGETQUERYOBJECTUI64VEXTPROC query_result_ = nullptr;
  PFNGLPUSHDEBUGGROUPKHRPROC push_group_ = nullptr;
  PFNGLPOPDEBUGGROUPKHRPROC pop_group_ = nullptr;
  std::array<GLuint, 2 * kStages> queries_{};
  std::array<bool, kStages> on_gpu_{};
  std::size_t open_ = kStages;
  HostTime began_{};
  StageTimes times_{};
};

/// Runs a stage from here to the end of the block.
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
