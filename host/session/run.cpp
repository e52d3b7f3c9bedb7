// SPDX-License-Identifier: Apache-2.0
#include "host/session/run.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "hal/base/log.h"
#include "hal/base/partial_path.h"
#include "hal/base/pool.h"
#include "hal/base/work_gate.h"
#include "host/capture/capture_reader.h"
#include "host/output/contact_sheet.h"
#include "host/session/baselines.h"
#include "host/session/camera_pose.h"
#include "host/session/change_sink.h"
#include "host/session/contact_points.h"
#include "host/session/frame_lens.h"
#include "host/session/judge.h"
#include "host/session/plate_motion.h"
#include "host/session/quality.h"
#include "host/session/run_compositor.h"
#include "host/session/run_sinks.h"
#include "host/session/slip.h"

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

/// Whether the poses of the scene can be held against true ones: both are of one world.
bool has_true_poses(const Session& session) {
  using scene::PoseSource;
  const PoseSource used = session.scene.pose_source;
  const bool own = session.scene.camera.trajectory.empty();
  const bool from_elsewhere = used == PoseSource::kFixed || used == PoseSource::kPanTilt ||
                              used == PoseSource::kMocap || used == PoseSource::kTracker ||
                              used == PoseSource::kFreeD || used == PoseSource::kOpenTrack ||
                              (used == PoseSource::kRecorded && !own);
  return from_elsewhere && session.source->info().true_poses;
}

/// For the motion blur of virtual things and to tell which plates are sharp: what the scene or else
/// the source says; 0: nobody asks, or it is not known.
double plate_exposure_s(const Session& session) {
  const scene::LookSettings& look = session.scene.look;
  const bool asked = look.motion || session.setup.look.measures();
  if (!asked || !session.poses->moves()) return 0;
  const double known_s =
      look.exposure_ms > 0 ? 1e-3 * look.exposure_ms : session.source->info().exposure_s;
  if (!(known_s > 0) && look.motion)
    log_warning("session", session.scene.path.string() +
                               ": look.motion: how long a plate is exposed is not known, so that "
                               "nothing is blurred: give look.exposure_ms");
  return known_s;
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
  Runner(Session& session, RunOptions options, const Clock& clock)
      : session_(session),
        options_(std::move(options)),
        clock_(clock),
        sinks_(session_, options_, clock_, gate(), report_),
        compositor_(session_, options_, clock_, report_),
        judge_(!session.setup.backdrop) {}

  Result<void> prepare(FrameRange range, const ProgressFn& progress);
  /// False when the source has ended.
  Result<bool> frame();
  Result<RunReport> finish(std::string ended);
  /// Why frame() gave false.
  const std::string& ended() const { return ended_; }

 private:
  bool live() const { return session_.source->info().frames == capture::kEndless; }
  /// A recording has no deadline: while a frame is timed nothing is decoded or encoded beside it.
  WorkGate* gate() { return live() ? nullptr : &gate_; }
  bool judges() const { return options_.judge && session_.source->info().has_truth; }
  bool reads_truth() const {
    return judges() || (options_.true_people && session_.source->info().has_truth);
  }
  Result<std::optional<capture::CaptureItem>> next_item();
  Result<void> open_poses();
  Result<void> open_compositor();
  Result<void> warm_up();
  Result<std::optional<capture::CaptureItem>> next_fresh_item();
  Result<void> open_baselines();
  render::OutputMask wanted(render::OutputMask by_sinks) const;
  Result<void> compose_timed(output::Composite& composite, render::OutputMask wanted);
  Result<void> inspect_and_deliver(output::Composite& composite, const capture::Truth* truth,
                                   render::OutputMask images, bool kept);
  Result<void> judge(const output::Composite& composite, const capture::Truth& truth);
  Result<void> add_last_to_sheet();
  void watch_camera(const geometry::Pose& world_from_target);
  void set_pose(output::Composite& composite);
  void watch_slip(output::Composite& composite, const capture::Truth* truth);

  Session& session_;
  RunOptions options_;
  const Clock& clock_;
  WorkGate gate_;
  RunReport report_;  ///< sinks write into it
  std::optional<PartialPath> folder_;
  RunSinks sinks_;
  RunCompositor compositor_;
  std::optional<pose::FramePoses> poses_;
  HeadWatch head_;
  std::unique_ptr<capture::CaptureReader> reader_;
  std::vector<capture::CaptureItem> held_;  ///< that were read ahead, the oldest first
  bool drained_ = false;                    ///< the reader has no more
  std::optional<HostTime> ready_;           ///< when the first frame of a live run could be made
  Pool<output::Composite> composites_;
  Pool<output::Composite> inspected_;  ///< with inspection images that wait for a sink
  std::shared_ptr<output::Composite> last_;
  Judge judge_;
  std::optional<Baselines> baselines_;
  PlateMotion motion_;
  std::optional<SlipWatch> slip_;
  std::optional<LensWatch> lens_;
  render::FrameOutput inspection_;  ///< images that are needed before the next frame alone
  std::optional<geometry::Pose> first_pose_;
  bool warned_ = false, warned_lost_ = false;
  std::string ended_ = "end of the source";
};

Result<void> Runner::prepare(FrameRange range, const ProgressFn& progress) {
  std::optional<std::filesystem::path> folder;
  if (options_.out) {
    MIXRIG_ASSIGN(folder_, make_partial_folder(*options_.out, kReportName));
    folder = folder_->path();
  }
  MIXRIG_TRY(sinks_.open(range, folder));
  // The background of a camera that moves is learned by its poses; one on the floor has its pose
  // from the background.
  const bool on_floor = session_.scene.pose_source == scene::PoseSource::kFloor;
  if (!on_floor) MIXRIG_TRY(prepare_poses(session_, clock_));
  MIXRIG_TRY(prepare_background(session_, progress));
  if (on_floor) MIXRIG_TRY(prepare_poses(session_, clock_));
  MIXRIG_ASSIGN(report_.quality, follow_budget(session_, range.first, clock_));
  MIXRIG_TRY(sinks_.open_streams());
  MIXRIG_TRY(open_poses());
  MIXRIG_TRY(open_compositor());
  if (options_.baselines) MIXRIG_TRY(open_baselines());
  // A live source may drop captures: it is read until enough were composited.
  reader_ = std::make_unique<capture::CaptureReader>(*session_.source, range.first,
                                                     live() ? capture::kEndless : range.second,
                                                     reads_truth(), gate());
  return warm_up();
}

Result<void> Runner::open_poses() {
  const pose::FramePoseOptions options = frame_pose_options(session_.scene);
  poses_.emplace(*session_.poses, options);
  report_.pose.source = session_.poses->name();
  report_.pose.latency_s = session_.poses->latency_s();
  report_.pose.when_lost = options.when_lost;
  slip_.emplace(contact_points(session_.setup.objects), session_.setup.view);
  lens_.emplace(session_.setup,
                session_.background && session_.rooms.empty() ? &*session_.background : nullptr);
  if (has_true_poses(session_)) report_.pose.error.emplace();
  motion_ = PlateMotion(plate_exposure_s(session_));
  return {};
}

Result<void> Runner::open_compositor() {
  const bool hides = session_.poses->moves() && report_.pose.when_lost == pose::WhenLost::kHide;
  MIXRIG_TRY(compositor_.open(hides, sinks_.motion(), gate()));
  if (options_.controls != nullptr) {
    options_.controls->can_record = sinks_.has_files() || options_.controls->records_takes;
    options_.controls->can_learn = compositor_.watches_room();
    options_.controls->can_scan = compositor_.watches_room() && ChangeSink::can_scan(session_);
    options_.controls->can_focus = session_.setup.focus.has_value();
  }
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

/// The next capture, once those within the latency of its pose have come too.
Result<std::optional<capture::CaptureItem>> Runner::next_item() {
  const double latency_s = session_.poses->latency_s();
  const auto waits = [&] {
    return held_.empty() || seconds(held_.back().capture->mid_exposure -
                                    held_.front().capture->mid_exposure) < latency_s;
  };
  while (!drained_ && waits()) {
    MIXRIG_ASSIGN(auto item, reader_->next());
    drained_ = !item;
    if (drained_) break;
    session_.poses->see(*item->capture);
    held_.push_back(*std::move(item));
  }
  if (held_.empty()) return std::optional<capture::CaptureItem>();
  std::optional<capture::CaptureItem> oldest(std::move(held_.front()));
  held_.erase(held_.begin());
  return oldest;
}

/// The first frame costs much more than others: shaders are built, memory is touched, and it is
/// found what the room hides of the lamps. The first capture is composited once for that, before
/// times are taken. What was exposed meanwhile in a live run is late, so that it is not composited
/// (next_fresh_item).
Result<void> Runner::warm_up() {
  MIXRIG_ASSIGN(auto item, next_item());
  if (!item) return {};
  const capture::Capture& capture = *item->capture;
  pose::FramePoses poses(*session_.poses, frame_pose_options(session_.scene));
  const pose::FramePose known = poses.next(capture);
  if (known.camera.ok()) {  // else the room's place is not known
    const auto composite = composites_.take();
    composite->capture = item->capture;
    composite->view = frame_view(session_.setup, capture);
    composite->world_from_target = known.camera.world_from_target;
    composite->world_from_object.clear();
    composite->motion.reset();
    const render::OutputMask images = wanted(sinks_.wanted(capture.number).all);
    MIXRIG_TRY(compositor_.compose(*composite, images, composite->images));
    swap_inspection(composite->images, inspection_);
  }
  if (live()) ready_ = clock_.now();
  held_.insert(held_.begin(), *std::move(item));
  return {};
}

/// Without what is late since the run was not ready, but for the last that there is.
Result<std::optional<capture::CaptureItem>> Runner::next_fresh_item() {
  constexpr double kLatePeriods = 1.5;
  constexpr int kMostLate = 8;  // as many wait between the devices and here
  MIXRIG_ASSIGN(auto item, next_item());
  if (!ready_) return item;
  const double rate_hz = session_.source->info().rate_hz;
  const double late_s = kLatePeriods / (rate_hz > 0 ? rate_hz : 25);
  for (int i = 0; i < kMostLate && item && seconds(*ready_ - item->capture->mid_exposure) > late_s;
       ++i) {
    MIXRIG_ASSIGN(auto newer, next_item());
    if (!newer) break;
    item = std::move(newer);
    ++report_.before_ready;
  }
  ready_.reset();
  return item;
}

Result<bool> Runner::frame() {
  MIXRIG_ASSIGN(auto item, next_fresh_item());
  if (!item) return false;
  if (auto fault = head_.fault(session_, *item->capture)) {
    if (!live()) return Error{ErrorCode::kData, *std::move(fault)};
    ended_ = *std::move(fault);
    return false;
  }
  MIXRIG_TRY(compositor_.follow_changes());
  if (options_.controls != nullptr && !options_.controls->records_takes)
    sinks_.set_recording(options_.controls->recording);
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
  set_pose(composite);
  if (sinks_.motion() != nullptr && !live()) sinks_.wait_for_people();
  compositor_.move_objects(composite);
  watch_slip(composite, judges() ? item->truth.get() : nullptr);
  lens_->add(*composite.capture, composite.world_from_target);
  watch_camera(composite.world_from_target);

  // A live frame is made once. Of a recording, whose times are compared, the timed pass makes what
  // every frame has; the images of an inspection come in a second one.
  const bool once = live() && !on_sheet;
  MIXRIG_TRY(compose_timed(composite, once ? images : images & render::kComposite));
  if (composite.images.wanted & render::kMatte) {
    composite.foreground_pct = foreground_pct(composite.images.matte);
    report_.foreground_pct.add(composite.foreground_pct);
  }

  MIXRIG_TRY(inspect_and_deliver(composite, item->truth.get(), once ? 0 : images, kept));
  MIXRIG_TRY(compositor_.see(last_));
  return true;
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
  if (judged) MIXRIG_TRY(judge(composite, *truth));
  if (lent && !on_sheet) swap_inspection(composite.images, inspection_);
  MIXRIG_TRY(sinks_.deliver(last_));
  // Only the sheet has used them, and is done.
  if (lent && on_sheet) swap_inspection(composite.images, inspection_);
  return {};
}

void Runner::set_pose(output::Composite& composite) {
  const pose::FramePose known = poses_->next(*composite.capture);
  composite.pose = known.camera;
  composite.world_from_target = known.camera.world_from_target;
  composite.objects_shown = known.objects_shown;
  composite.motion = motion_.next(known.camera, composite.capture->time_s);
  if (known.camera.ok()) {
    report_.pose.age_ms.add(1e3 * known.camera.age_s);
    if (report_.pose.error)
      report_.pose.error->add(composite.world_from_target, composite.capture->world_from_target);
    return;
  }
  if (report_.pose.error) report_.pose.error->skip();
  if (std::exchange(warned_lost_, true)) return;
  log_warning("session", fmt::format("frame {}: the camera's pose is lost ({}): virtual objects "
                                     "are {}; frames.csv and the report say where",
                                     composite.capture->number, capture::name(known.camera.loss),
                                     known.objects_shown ? "frozen" : "hidden"));
}

/// The world of "floor" and "identity" is not that of the truth.
void Runner::watch_slip(output::Composite& composite, const capture::Truth* truth) {
  composite.slip_px = composite.slip_sigma_px = std::nullopt;
  if (!composite.objects_shown) return;
  const capture::Capture& capture = *composite.capture;
  const scene::PoseSource source = session_.scene.pose_source;
  const bool known = judges() && capture.pose_origin == capture::PoseOrigin::kRecorded &&
                     source != scene::PoseSource::kFloor && source != scene::PoseSource::kIdentity;
  capture::CameraPose used = composite.pose;
  used.world_from_target = world_from_pupil(used.world_from_target, capture);
  std::optional<geometry::Pose> true_pose;
  if (known) true_pose = capture.world_from_target;
  geometry::Pinhole true_view = session_.setup.view;
  if (known && truth != nullptr && truth->lens) {
    true_pose = geometry::at_pupil(*true_pose, truth->lens->pupil_shift_m);
    true_view = resized(truth->lens->view, true_view.size_px);
  }
  const FrameSlip slip =
      slip_->add(used, true_pose, frame_view(session_.setup, capture), true_view);
  composite.slip_px = slip.measured_px;
  composite.slip_sigma_px = slip.sigma_px;
}

Result<void> Runner::compose_timed(output::Composite& composite, render::OutputMask wanted) {
  const WorkGate::Pause pause(gate());
  const HostTime begin = clock_.now();
  MIXRIG_TRY(compositor_.compose(composite, wanted, composite.images));
  composite.frame_ms = static_cast<float>(milliseconds(clock_.now() - begin));
  report_.frame_ms.add(composite.frame_ms);
  if (live()) report_.latency_ms.add(milliseconds(clock_.now() - composite.capture->mid_exposure));
  const render::StageTimes& times = compositor_.stage_times();
  for (std::size_t i = 0; i < times.size(); ++i) report_.stage_ms[i].add(times[i]);
  return {};
}

Result<void> Runner::judge(const output::Composite& composite, const capture::Truth& truth) {
  MIXRIG_TRY(judge_.add(truth, composite.images));
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

void Runner::watch_camera(const geometry::Pose& world_from_target) {
  if (!first_pose_) first_pose_ = world_from_target;
  if (warned_ || !session_.background || !session_.setup.background_models.empty() ||
      !capture::moved(*first_pose_, world_from_target))
    return;
  warned_ = true;
  log_warning("session",
              "the camera moves, the background is of a static camera: people are keyed "
              "wrongly away from the first pose");
}

Result<RunReport> Runner::finish(std::string ended) {
  const std::uint64_t dropped = reader_->dropped();
  reader_.reset();
  if (report_.frame_ms.count() == 0)
    return Error{ErrorCode::kData, "no frame was composited (" + ended + "): nothing was written"};
  report_.ended = std::move(ended);
  report_.live = session_.source->report();
  if (report_.live) report_.live->dropped_sets += dropped;
  if (judges()) report_.error = judge_.errors();
  if (baselines_) report_.baselines = baselines_->errors();
  if (sinks_.empty_sheet() != nullptr) MIXRIG_TRY(add_last_to_sheet());
  report_.pose.frames = poses_->counts();
  report_.pose.faults = session_.poses->faults();
  report_.pose.slip = slip_->report();
  report_.lens = lens_->report();
  report_.pose.stream = session_.poses->stream();
  MIXRIG_TRY(compositor_.finish());
  inspection_ = {};
  composites_ = {};
  MIXRIG_TRY(sinks_.finish());
  report_.rss_mb = peak_rss_mb();
  if (!folder_) return std::move(report_);
  MIXRIG_TRY(write_file(folder_->path() / kReportName, to_json(report_).dump(2) + "\n"));
  MIXRIG_TRY(folder_->commit());
  return std::move(report_);
}

}  // namespace

Result<RunReport> run(Session& session, RunOptions options, const Clock& clock,
                      const ProgressFn& progress) {
  MIXRIG_ASSIGN(const FrameRange range, range_of(session, options));
  const std::atomic<bool>* stop = options.stop;
  Runner runner(session, std::move(options), clock);
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

}  // namespace mixrig::session
