// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/rung_contender.h"

#include <utility>

#include "host/judge/baselines/judge.h"
#include "host/judge/bench/heap.h"
#include "host/judge/bench/moved_bytes.h"
#include "host/room/background/frame_lens.h"

namespace mixrig::bench {
namespace {

class RungContender final : public Contender {
 public:
  RungContender(Rung rung, const session::Session& session, const std::vector<BenchFrame>& frames)
      : rung_(std::move(rung)),
        setup_(session.setup),
        frames_(frames),
        judge_(!session.setup.backdrop) {
    if (rung_.change) rung_.change(setup_);
  }
  Result<void> open();
  Result<float> time(std::size_t index) override;
  Result<void> judge(std::size_t index) override;
  Row row() const override;

 private:
  Result<void> compose(const BenchFrame& frame, const geometry::Pose& pose,
                       render::OutputMask wanted, render::FrameOutput& output);

  Rung rung_;
  render::CompositorSetup setup_;
  const std::vector<BenchFrame>& frames_;
  std::unique_ptr<render::Compositor> compositor_;
  session::Judge judge_;
  render::FrameOutput output_, judged_;
  double heap_bytes_ = 0, step_m_ = 1e-3;
  SystemClock clock_;
};

Result<void> RungContender::open() {
  const double before_bytes = heap_bytes();
  MIXRIG_ASSIGN(compositor_, session::make_compositor(setup_, rung_.backend));
  MIXRIG_TRY(
      compose(frames_.front(), frames_.front().world_from_target, render::kComposite, output_));
  heap_bytes_ = heap_bytes() - before_bytes;
  return {};
}

Result<void> RungContender::compose(const BenchFrame& frame, const geometry::Pose& pose,
                                    render::OutputMask wanted, render::FrameOutput& output) {
  output.wanted = wanted;
  const capture::Capture& capture = frame.capture;
  return compositor_->compose({.plate = capture.plate,
                               .tof_depth_m = capture.depth_m,
                               .world_from_target = pose,
                               .tof2_depth_m = capture.depth2.depth_m},
                              output);
}

Result<float> RungContender::time(std::size_t index) {
  if (!rung_.timed) return -1.0F;
  geometry::Pose pose = frames_[index].world_from_target;
  if (rung_.moves) pose.translation_m.x() += std::exchange(step_m_, -step_m_);
  const HostTime begin = clock_.now();
  MIXRIG_TRY(compose(frames_[index], pose, render::kComposite, output_));
  if (rung_.stages.empty()) return static_cast<float>(milliseconds(clock_.now() - begin));
  float sum_ms = 0;
  for (const render::Stage stage : rung_.stages)
    sum_ms += compositor_->state().stage_times[static_cast<std::size_t>(stage)];
  return sum_ms;
}

Result<void> RungContender::judge(std::size_t index) {
  const BenchFrame& frame = frames_[index];
  const render::OutputMask wanted = session::Judge::kWanted | render::kMixedDepth;
  MIXRIG_TRY(compose(frame, frame.world_from_target, wanted, judged_));
  const Image<float>& depth_m =
      rung_.look == Look::kMixed ? judged_.mixed_depth_m : judged_.warped_depth_m;
  return judge_.add(frame.truth, measure::ResultImages{judged_.color, depth_m, judged_.matte,
                                                       judged_.light, judged_.layer});
}

Row RungContender::row() const {
  Row row;
  row.name = rung_.name, row.group = session::backend_of(*compositor_);
  add_errors(judge_.errors(), rung_.look != Look::kComposite, rung_.measures, row);
  if (rung_.heap) row.more.emplace_back("heap_mb", 1e-6 * heap_bytes_);
  if (!rung_.timed || rung_.moves || row.group != "cpu") return row;
  const Size view = setup_.view.size_px, tof = setup_.tof.size_px();
  double bytes = rung_.stages.empty() ? moved_bytes(view, tof) : 0;
  for (const render::Stage stage : rung_.stages) bytes += moved_bytes(stage, view, tof);
  if (bytes > 0) row.bytes = bytes;
  return row;
}

}  // namespace

Result<ContenderPtr> open_rung(Rung rung, const session::Session& session,
                               const std::vector<BenchFrame>& frames) {
  auto contender = std::make_unique<RungContender>(std::move(rung), session, frames);
  MIXRIG_TRY(contender->open());
  return ContenderPtr(std::move(contender));
}

}  // namespace mixrig::bench
