// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/gl/stage_timer.h"

#include <string_view>

namespace mixrig::render::gles {
namespace {

template <typename Function>
Function load(const char* name) {
  return reinterpret_cast<Function>(eglGetProcAddress(name));
}

}  // namespace

StageTimer::StageTimer(const EglContext& context) {
  if (context.has_extension("GL_KHR_debug")) {
    push_group_ = load<PFNGLPUSHDEBUGGROUPKHRPROC>("glPushDebugGroupKHR");
    pop_group_ = load<PFNGLPOPDEBUGGROUPKHRPROC>("glPopDebugGroupKHR");
  }
  if (!context.has_extension("GL_EXT_disjoint_timer_query")) return;
  GLint bits = 0;
  const auto get = load<PFNGLGETQUERYIVEXTPROC>("glGetQueryivEXT");
  if (get) get(GL_TIMESTAMP_EXT, GL_QUERY_COUNTER_BITS_EXT, &bits);
  query_result_ = load<PFNGLGETQUERYOBJECTUI64VEXTPROC>("glGetQueryObjectui64vEXT");
  if (bits == 0 || !query_result_) return;
  query_counter_ = load<PFNGLQUERYCOUNTEREXTPROC>("glQueryCounterEXT");
  glGenQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
}

StageTimer::~StageTimer() {
  if (queries_[0] != 0) glDeleteQueries(static_cast<GLsizei>(queries_.size()), queries_.data());
}

void StageTimer::begin_frame(bool alone) {
  alone_ = alone;
  times_.fill(0);
  on_gpu_.fill(false);
}

void StageTimer::begin(Stage stage, bool on_host) {
  open_ = static_cast<std::size_t>(stage);
  if (push_group_) {
    const std::string_view label = name(stage);
    push_group_(GL_DEBUG_SOURCE_APPLICATION_KHR, 0, static_cast<GLsizei>(label.size()),
                label.data());
  }
  open_on_host_ = on_host;
  if (query_counter_ && !on_host) {
    on_gpu_[open_] = true;
    query_counter_(query(open_, false), GL_TIMESTAMP_EXT);
  }
  began_ = clock_.now();
}

void StageTimer::end() {
  if (query_counter_ && !open_on_host_) {
    query_counter_(query(open_, true), GL_TIMESTAMP_EXT);
  } else {
    if (!open_on_host_ && alone_) glFinish();
    times_[open_] += static_cast<float>(milliseconds(clock_.now() - began_));
  }
  if (pop_group_) pop_group_();
}

double StageTimer::gpu_ms(std::size_t stage) const {
  GLuint64 begin_ns = 0, end_ns = 0;
  query_result_(query(stage, false), GL_QUERY_RESULT_EXT, &begin_ns);
  query_result_(query(stage, true), GL_QUERY_RESULT_EXT, &end_ns);
  return end_ns > begin_ns ? static_cast<double>(end_ns - begin_ns) * 1e-6 : 0.0;
}

const StageTimes& StageTimer::finish_frame() {
  // After a disjoint operation (a change of clock rate) stamps are meaningless and count as 0.
  GLint disjoint = 0;
  if (query_counter_) glGetIntegerv(GL_GPU_DISJOINT_EXT, &disjoint);
  for (std::size_t stage = 0; stage < kStages; ++stage)
    if (on_gpu_[stage] && !disjoint) times_[stage] += static_cast<float>(gpu_ms(stage));
  return times_;
}

}  // namespace mixrig::render::gles
