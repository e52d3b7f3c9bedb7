// SPDX-License-Identifier: Apache-2.0
#include "host/run/loop/run.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/guarded.h"
#include "hal/base/log.h"
#include "hal/base/partial_path.h"
#include "hal/base/pool.h"
#include "hal/base/work_gate.h"
#include "host/judge/baselines/baselines.h"
#include "host/judge/baselines/judge.h"
#include "host/output/sheet/contact_sheet.h"
#include "host/room/background/frame_lens.h"
#include "host/room/background/seen_through.h"
#include "host/run/loop/capture_feed.h"
#include "host/run/loop/run_compositor.h"
#include "host/run/loop/run_poses.h"
#include "host/run/session/camera_pose.h"
#include "host/run/session/quality.h"
#include "host/run/sinks/run_sinks.h"

namespace mixrig::session {
namespace {

constexpr const char* kReportName = "report.json";

Result<FrameRange> range_of(const Session& session, const RunOptions& options) {
  const FrameRange range = options.frames.value_or(session.default_frames());
  const int frames = session.source->info().frames;
  if (!options.frames && range.first > range.second)
    return Error{ErrorCode::kUsage,
                 fmt::format("the take has frames 1-{} and the background is learned from all of "
                             "them: none is left to composite, select some by --frames",
                             frames)};
  if (range.first < 1 || range.second < range.first || range.second > frames)
    return Error{ErrorCode::kUsage,
                 fmt::format("--frames {}-{} is out of range: the take has frames 1-{}",
                             range.first, range.second, frames)};
  return range;
}

double foreground_pct(const Image<std::uint8_t>& matte) {
  std::size_t count = 0;
  for (int y = 0; y < matte.height(); ++y)
    count += static_cast<std::size_t>(std::count_if(matte.row(y), matte.row(y) + matte.width(),
                                                    [](std::uint8_t m) { return m >= 128; }));
  return 100.0 * static_cast<double>(count) / static_cast<double>(matte.size().area());
}

/// Exchanges the images of two frames that only an inspection needs.
void swap_inspection(render::FrameOutput& a, render::FrameOutput& b) {
  std::swap(a.warped_depth_m, b.warped_depth_m);
  std::swap(a.state, b.state);
  std::swap(a.light, b.light);
  std::swap(a.layer, b.layer);
}

/// The state of a run; one method per step of the frame loop.
class Runner {
 public:
  Runner(Session& session, const RunOptions& options, const Clock& clock, RunParts parts)
      : session_(session),
        options_(options),
        clock_(clock),
        parts_(std::move(parts)),
        sinks_(session_, options_, clock_, gate()),
        compositor_(session_, options_, parts_.scene, parts_.orders),
        poses_(session_),
        judge_(!session.setup.backdrop) {}

  Result<void> prepare(FrameRange range, const ProgressFn& progress);
  /// False when the source has ended.
  Result<bool> frame();
  Result<RunReport> finish(std::string ended);
  /// Ends the sinks after an error; files with a frame stay under their partial name, which the
  /// returned error says.
  Error keep(const Error& error);
  /// Why frame() gave false.
  const std::string& ended() const { return ended_; }

 private:
  bool live() const { return session_.is_live(); }
  /// A recording has no deadline: while a frame is timed nothing is decoded or encoded beside it.
  WorkGate* gate() { return live() ? nullptr : &gate_; }
  bool judges() const { return options_.judge && session_.source->info().has_truth; }
  bool reads_truth() const {
    return judges() || (options_.true_people && session_.source->info().has_truth);
  }
  Result<void> open_compositor();
  void tell_ghosts(const capture::Capture& capture);
  pose::FramePose pose_of_first(const capture::Capture& capture);
  Result<void> warm_up(capture::CaptureItem item, const pose::FramePose& known);
  Result<void> open_baselines();
  render::OutputMask wanted(render::OutputMask by_sinks) const;
  Result<void> compose_timed(output::Composite& composite, render::OutputMask wanted);
  Result<void> inspect_and_deliver(output::Composite& composite, const capture::Truth* truth,
                                   render::OutputMask images, bool kept);
  Result<void> judge(output::Composite& composite, const capture::Truth& truth);
  void obey_record_orders();
  Result<void> add_last_to_sheet();

  Session& session_;
  const RunOptions& options_;
  const Clock& clock_;
  RunParts parts_;
  WorkGate gate_;
  std::optional<PartialPath> folder_;
  std::optional<QualityChoice> quality_;
  FrameReport frames_;
  RunSinks sinks_;
  RunCompositor compositor_;
  RunPoses poses_;
  HeadWatch head_;
  std::optional<model::SeenThrough> seen_through_;
  std::optional<CaptureFeed> feed_;
  Pool<output::Composite> composites_;
  Pool<output::Composite> inspected_;  ///< with inspection images that wait for a sink
  std::shared_ptr<output::Composite> last_;
  Judge judge_;
  std::optional<Baselines> baselines_;
  render::FrameOutput inspection_;  ///< images that are needed before the next frame alone
  std::string ended_ = "end of the source";
};

Result<void> Runner::prepare(FrameRange range, const ProgressFn& progress) {
  std::optional<std::filesystem::path> folder;
  if (options_.out) {
    MIXRIG_ASSIGN(folder_, make_partial_folder(*options_.out, kReportName));
    folder = folder_->path();
  }
  MIXRIG_TRY(sinks_.open(range, folder, std::move(parts_.sinks), parts_.extras));
  // The background of a camera that moves is learned by its poses; one on the floor has its pose
  // from the background.
  const bool on_floor = session_.scene.pose_source == scene::PoseSource::kFloor;
  if (!on_floor) MIXRIG_TRY(prepare_poses(session_, clock_));
  MIXRIG_TRY(prepare_background(session_, progress));
  if (on_floor) MIXRIG_TRY(prepare_poses(session_, clock_));
  MIXRIG_ASSIGN(quality_, follow_budget(session_, range.first, clock_));
  MIXRIG_TRY(sinks_.open_streams());
  poses_.open();
  // A live source may drop captures: it is read until enough were composited.
  feed_.emplace(session_, range.first, live() ? capture::kEndless : range.second, reads_truth(),
                gate());
  MIXRIG_ASSIGN(auto first, feed_->next());
  pose::FramePose known;
  if (first) known = pose_of_first(*first->capture);
  MIXRIG_TRY(open_compositor());
  if (!session_.setup.background.depth_m.empty() && !session_.setup.lens_moves)
    seen_through_.emplace(session_.setup);
  if (options_.baselines) MIXRIG_TRY(open_baselines());
  return first ? warm_up(*std::move(first), known) : Result<void>();
}

/// Pose of the first frame. The compositor of a still camera is made for it.
pose::FramePose Runner::pose_of_first(const capture::Capture& capture) {
  pose::FramePoses poses(*session_.poses, frame_pose_options(session_.scene));
  pose::FramePose known = poses.next(capture);
  render::CompositorSetup& setup = session_.setup;
  const bool still = !setup.background.depth_m.empty() && !setup.lens_moves;
  if (still && known.camera.ok()) setup.first_pose = known.camera.world_from_target;
  return known;
}

Result<void> Runner::open_compositor() {
  session_.setup.may_hide_objects = session_.poses->info().moves;
  MIXRIG_TRY(compositor_.open(sinks_.mover(), gate()));
  if (parts_.orders != nullptr)
    parts_.orders->tell(
        [&](output::RunState& run) { run.can_record = sinks_.has_files() || run.records_takes; });
  return {};
}

Result<void> Runner::open_baselines() {
  if (!judges())
    return Error{ErrorCode::kUsage, session_.source->info().name +
                                        " has no truth to hold baselines against: leave out "
                                        "--baselines, or use a take of mixrig studio"};
  if (session_.setup.lens_moves)
    return Error{ErrorCode::kUsage, session_.source->info().name +
                                        " has a lens that zooms, which the baselines do not "
                                        "follow: leave out --baselines"};
  return baselines_.emplace().open(session_.setup);
}

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

/// The first frame costs much more than others: shaders are built, memory is touched, and it is
/// found what the room hides of the lamps. The first capture is composited once for that, before
/// times are taken. What was exposed meanwhile in a live run is late, so that it is not composited
/// (CaptureFeed::next_fresh).
Result<void> Runner::warm_up(capture::CaptureItem item, const pose::FramePose& known) {
  const capture::Capture& capture = *item.capture;
  if (known.camera.ok()) {  // else the room's place is not known
    const auto composite = composites_.take();
    composite->capture = item.capture;
    composite->view = frame_view(session_.setup, capture);
    composite->world_from_target = known.camera.world_from_target;
    composite->world_from_object.clear();
    composite->motion.reset();
    const render::OutputMask images = wanted(sinks_.wanted(capture.number).all);
    MIXRIG_TRY(compositor_.compose(*composite, images, composite->images));
    swap_inspection(composite->images, inspection_);
  }
  feed_->give_back(std::move(item), clock_.now());
  return {};
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
  if (lent) swap_inspection(composite.images, inspection_);
  if (inspected) {
    const render::OutputMask made = composite.images.wanted | images;
    MIXRIG_TRY(compositor_.compose(composite, made | needed, composite.images));
    composite.images.wanted = made;
  }
  composite.worst_piece.reset();
  if (judged) MIXRIG_TRY(judge(composite, *truth));
  if (lent && !on_sheet) swap_inspection(composite.images, inspection_);
  MIXRIG_TRY(sinks_.deliver(last_));
  // Only the sheet has used them, and is done.
  if (lent && on_sheet) swap_inspection(composite.images, inspection_);
  return {};
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

/// Composites `range` until it ends, the source ends or `stop` is set.
Result<RunReport> run_frames(Runner& runner, FrameRange range, const ProgressFn& progress,
                             const std::atomic<bool>* stop) {
  MIXRIG_TRY(runner.prepare(range, progress));
  const auto stopped = [&] { return stop != nullptr && *stop; };
  for (int number = range.first; !stopped(); ++number) {
    MIXRIG_ASSIGN(const bool there, runner.frame());
    if (!there && !stopped()) return runner.finish(runner.ended());
    if (!there) break;
    if (progress && range.second != capture::kEndless)
      progress("frames", number - range.first + 1, range.second - range.first + 1);
    if (number == range.second) return runner.finish("frames");
  }
  return runner.finish("stopped");
}

}  // namespace

Result<RunReport> run(Session& session, const RunOptions& options, const Clock& clock,
                      const ProgressFn& progress, RunParts parts) {
  MIXRIG_ASSIGN(const FrameRange range, range_of(session, options));
  const std::atomic<bool>* stop = parts.stop;
  Runner runner(session, options, clock, std::move(parts));
  std::optional<RunReport> report;
  const Result<void> done = guarded("compositing", [&]() -> Result<void> {
    MIXRIG_ASSIGN(report, run_frames(runner, range, progress, stop));
    return {};
  });
  if (!done) return runner.keep(done.error());
  return *std::move(report);
}

}  // namespace mixrig::session
