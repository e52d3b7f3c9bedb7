// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/runner.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "host/output/sheet/contact_sheet.h"
#include "host/room/background/frame_lens.h"

namespace mixrig::session {
namespace {

double foreground_pct(const Image<std::uint8_t>& matte) {
  std::size_t count = 0;
  for (int y = 0; y < matte.height(); ++y)
    count += static_cast<std::size_t>(std::count_if(matte.row(y), matte.row(y) + matte.width(),
                                                    [](std::uint8_t m) { return m >= 128; }));
  return 100.0 * static_cast<double>(count) / static_cast<double>(matte.size().area());
}

}  // namespace

/// Images that a frame is made with; the matte, for the share of foreground, where the composite
/// does not stay in the GPU's memory.
render::OutputMask Runner::wanted(render::OutputMask by_sinks) const {
  // A recording is composited completely, also without sinks, so that its times are comparable.
  if (!live()) return render::kComposite | by_sinks;
  const bool follows = session_.scene.light.follow;
  const render::OutputMask people = follows ? render::kMatte | render::kSegmentedDepth : 0;
  return by_sinks & render::kGpuColor ? by_sinks | people : by_sinks | people | render::kMatte;
}

/// Says after the first second whether the background holds what is gone.
void Runner::tell_ghosts(const capture::Capture& capture) {
  constexpr double kGhosts = 0.01;
  const auto share = seen_through_ ? seen_through_->add(capture) : std::nullopt;
  if (share) log_info("room", fmt::format("behind the background: {:.2f} %", 100 * *share));
  if (!share || *share < kGhosts) return;
  log_warning("room",
              fmt::format("on {:.1f} % of the background depth lies behind it: it holds people or "
                          "things that are gone, and people are keyed wrong there: scan the empty "
                          "room again",
                          100 * *share));
}

Result<bool> Runner::frame() {
  MIXRIG_ASSIGN(auto item, feed_->next_fresh());
  if (!item) return false;
  if (auto fault = head_.fault(session_, *item->capture)) {
    if (!live()) return Error{ErrorCode::kData, *std::move(fault)};
    ended_ = *std::move(fault);
    return false;
  }
  compositor_.follow_changes();
  obey_record_orders();
  const int number = item->capture->number;
  const RunSinks::Wanted by_sinks = sinks_.wanted(number);
  const render::OutputMask images = wanted(by_sinks.all);
  const bool on_sheet = sinks_.on_sheet(number);
  const bool kept = (by_sinks.kept & ~render::kComposite) != 0;
  last_.reset();  // its buffers may be used again
  last_ = (kept ? inspected_ : composites_).take();
  output::Composite& composite = *last_;
  composite.capture = std::move(item->capture);
  composite.truth = on_sheet ? item->truth : nullptr;  // only the sheet shows it
  composite.true_people.reset();
  if (options_.true_people && item->truth) composite.true_people = item->truth->people;
  composite.view = frame_view(session_.setup, *composite.capture);
  poses_.set(composite);
  tell_ghosts(*composite.capture);
  if (!live()) sinks_.wait_for_mover();
  compositor_.move_objects(composite);
  poses_.watch(composite, judges(), judges() ? item->truth.get() : nullptr);

  // A live frame is made once. Of a recording, whose times are compared, the timed pass makes what
  // every frame has; the images of an inspection come in a second one.
  const bool once = live() && !on_sheet;
  MIXRIG_TRY(compose_timed(composite, once ? images : images & render::kComposite));
  if (composite.images.wanted & render::kMatte) {
    composite.foreground_pct = foreground_pct(composite.images.matte);
    frames_.foreground_pct.add(composite.foreground_pct);
  }

  MIXRIG_TRY(inspect_and_deliver(composite, item->truth.get(), once ? 0 : images, kept));
  MIXRIG_TRY(compositor_.see(last_));
  return true;
}

/// Follows record orders for the run's files, unless a recorder of takes follows them.
void Runner::obey_record_orders() {
  if (parts_.orders == nullptr || parts_.orders->state().records_takes) return;
  while (const auto order = parts_.orders->take<output::Record>()) sinks_.set_recording(order->on);
}

/// Makes those of `images`, and what judges need, that the composite lacks. Inspection images that
/// are not `kept` by a sink are lent to it until it is delivered, so that what waits for a sink
/// does not hold them.
Result<void> Runner::inspect_and_deliver(output::Composite& composite, const capture::Truth* truth,
                                         render::OutputMask images, bool kept) {
  const bool judged = judges() && !compositor_.is_edited();
  const render::OutputMask needed = images | (judged ? Judge::kWanted : 0);
  const bool inspected = (needed & ~render::kComposite) != 0;
  const bool lent = inspected && !kept, on_sheet = sinks_.on_sheet(composite.capture->number);
  if (lent) swap_inspection(composite.images);
  if (inspected) {
    const render::OutputMask made = composite.images.wanted | images;
    MIXRIG_TRY(compositor_.compose(composite, made | needed, composite.images));
    composite.images.wanted = made;
  }
  composite.worst_piece.reset();
  if (judged) MIXRIG_TRY(judge(composite, *truth));
  if (lent && !on_sheet) swap_inspection(composite.images);
  MIXRIG_TRY(sinks_.deliver(last_));
  // Only the sheet has used them, and is done.
  if (lent && on_sheet) swap_inspection(composite.images);
  return {};
}

void Runner::swap_inspection(render::FrameOutput& images) {
  std::swap(images.warped_depth_m, inspection_.warped_depth_m);
  std::swap(images.state, inspection_.state);
  std::swap(images.light, inspection_.light);
  std::swap(images.layer, inspection_.layer);
}

Result<void> Runner::compose_timed(output::Composite& composite, render::OutputMask wanted) {
  const WorkGate::Pause pause(gate());
  const HostTime begin = clock_.now();
  MIXRIG_TRY(compositor_.compose(composite, wanted, composite.images));
  composite.frame_ms = static_cast<float>(milliseconds(clock_.now() - begin));
  compositor_.count_plate(*composite.capture);
  frames_.frame_ms.add(composite.frame_ms);
  if (live()) frames_.latency_ms.add(milliseconds(clock_.now() - composite.capture->mid_exposure));
  const render::StageTimes& times = compositor_.stage_times();
  for (std::size_t i = 0; i < times.size(); ++i) frames_.stage_ms[i].add(times[i]);
  return {};
}

Result<void> Runner::judge(output::Composite& composite, const capture::Truth& truth) {
  MIXRIG_TRY(judge_.add(truth, composite.images));
  const measure::Piece& worst = judge_.worst_scrap();
  composite.worst_piece = {worst.pixels, worst.x_px, worst.y_px, worst.width_px, worst.height_px};
  if (!baselines_) return {};
  return baselines_->add(*composite.capture, composite.world_from_target, composite.objects_shown,
                         truth);
}

/// A run that was stopped before the first frame of its sheet shows its last frame.
Result<void> Runner::add_last_to_sheet() {
  std::shared_ptr<output::Composite> composite = inspected_.take();
  composite->capture = last_->capture;
  composite->world_from_target = last_->world_from_target;
  composite->view = last_->view;
  composite->objects_shown = last_->objects_shown;
  composite->world_from_object = last_->world_from_object;
  composite->motion = last_->motion;
  MIXRIG_TRY(compositor_.compose(*composite, output::ContactSheet::kWanted, composite->images));
  return sinks_.empty_sheet()->push(std::move(composite));
}

Result<RunReport> Runner::finish(std::string ended) {
  RunReport report;
  const std::uint64_t dropped = feed_->dropped();
  report.before_ready = feed_->late();
  feed_.reset();
  if (frames_.frame_ms.count() == 0)
    return Error{ErrorCode::kData, "no frame was composited (" + ended + "): nothing was written"};
  report.ended = std::move(ended);
  report.frames = frames_, report.quality = quality_;
  report.live = session_.source->report();
  if (report.live) report.live->dropped_sets += dropped;
  if (judges()) report.error = judge_.errors();
  if (baselines_) report.baselines = baselines_->errors();
  if (sinks_.empty_sheet() != nullptr) MIXRIG_TRY(add_last_to_sheet());
  report.pose = poses_.report();
  MIXRIG_ASSIGN(report.compositor, compositor_.finish());
  inspection_ = {};
  composites_ = {};
  MIXRIG_TRY(sinks_.finish());
  report.sinks = sinks_.reports(), report.stream_outs = sinks_.stream_reports();
  report.extras = parts_.extras;
  report.rss_mb = peak_rss_mb();
  if (!folder_) return report;
  MIXRIG_TRY(write_file(folder_->path() / kReportName, to_json(report).dump(2) + "\n"));
  MIXRIG_TRY(folder_->commit());
  return report;
}

Error Runner::keep(const Error& error) {
  feed_.reset();
  (void)guarded("ending", [&] { return sinks_.finish(); });
  if (!sinks_.has_written()) return error;
  const std::string partial = folder_->path().string();
  folder_->keep();
  Error kept = error;
  kept.context += ": what was written before is in '" + partial +
                  "', of which mixrig info --repair makes a take";
  return kept;
}

}  // namespace mixrig::session
