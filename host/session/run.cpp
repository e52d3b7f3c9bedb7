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
#include "host/output/sheet_sink.h"
#include "host/output/sink_thread.h"
#include "host/output/stream_sink.h"
#include "host/session/baselines.h"
#include "host/session/camera_pose.h"
#include "host/session/change_sink.h"
#include "host/session/contact_points.h"
#include "host/session/frame_lens.h"
#include "host/session/hiding_compositor.h"
#include "host/session/judge.h"
#include "host/session/object_motion.h"
#include "host/session/people_sink.h"
#include "host/session/pose_sink.h"
#include "host/session/room_keeper.h"
#include "host/session/setup_exchange.h"
#include "host/session/slip.h"
#include "host/session/touch_stage.h"

namespace mixrig::session {
namespace {

constexpr const char* kReportName = "report.json";
constexpr int kSheetStep = 10;  // row k of an endless sheet: frame first + 10 k^2

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

/// Spread over the range; at growing distances where its end is not known.
std::vector<int> sheet_frames(FrameRange range, int rows) {
  if (range.second != capture::kEndless) return output::spread(range.first, range.second, rows);
  std::vector<int> frames;
  for (int k = 0; k < rows; ++k) frames.push_back(range.first + kSheetStep * k * k);
  return frames;
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

/// The state of a run; one method per step of the frame loop.
class Runner {
 public:
  Runner(Session& session, RunOptions options, const Clock& clock)
      : session_(session),
        options_(std::move(options)),
        clock_(clock),
        exchange_(session_, live()),
        judge_(!session.setup.backdrop) {}

  Result<void> prepare(FrameRange range, const ProgressFn& progress);
  /// False when the source has ended.
  Result<bool> frame();
  Result<RunReport> finish(std::string ended);
  /// Why frame() gave false.
  const std::string& ended() const { return ended_; }

 private:
  using Sinks = std::vector<std::unique_ptr<output::SinkThread>>;

  bool live() const { return session_.source->info().frames == capture::kEndless; }
  /// A recording has no deadline: while a frame is timed nothing is decoded or encoded beside it.
  WorkGate* gate() { return live() ? nullptr : &gate_; }
  bool judges() const { return options_.judge && session_.source->info().has_truth; }
  bool reads_truth() const {
    return judges() || (options_.true_people && session_.source->info().has_truth);
  }
  Result<std::optional<capture::CaptureItem>> next_item();
  Result<void> open_sinks(FrameRange range);
  double stream_rate_hz() const;
  Result<void> check_streams();
  Result<void> open_streams();
  Result<void> open_people();
  Result<void> follow_changes();
  void move_objects(output::Composite& composite);
  void place_moved_objects();
  Result<void> prepare_frame_poses();
  Result<void> open_baselines();
  render::OutputMask wanted_by(const output::SinkThread& sink, int number) const;
  render::OutputMask wanted_by_sinks(int number) const;
  Result<void> compose_timed(output::Composite& composite, render::OutputMask wanted);
  Result<void> compose(const output::Composite& composite, render::OutputMask wanted,
                       render::FrameOutput& images);
  Result<void> judge(const output::Composite& composite, const capture::Truth& truth);
  Result<void> deliver(const output::CompositePtr& composite);
  Result<void> add_last_to_sheet();
  Result<void> finish_watch();
  void watch_camera(const geometry::Pose& world_from_target);
  void set_pose(output::Composite& composite);
  void watch_slip(output::Composite& composite, const capture::Truth* truth);

  Session& session_;
  RunOptions options_;
  const Clock& clock_;
  bool hides_ = false;  ///< frames without virtual objects are expected
  std::optional<RoomKeeper> keeper_;
  SetupExchange exchange_;  ///< has what compositor_ was made of
  FrameScene frame_scene_;
  bool scene_differs_ = false;                ///< of the frame: frame_scene_ from the setup
  std::vector<geometry::Pose> wanted_poses_;  ///< of objects with physics, that they were put at
  std::unique_ptr<HidingCompositor> compositor_ = std::make_unique<HidingCompositor>();
  std::optional<pose::FramePoses> poses_;
  HeadWatch head_;
  std::optional<PartialPath> folder_;
  WorkGate gate_;
  std::unique_ptr<capture::CaptureReader> reader_;
  std::vector<capture::CaptureItem> held_;  ///< that were read ahead, the oldest first
  bool drained_ = false;                    ///< the reader has no more
  Pool<output::Composite> composites_;
  Pool<output::Composite> inspected_;  ///< with inspection images, which few frames need
  RunReport report_;                   ///< sinks write into it
  Sinks sinks_;
  std::unique_ptr<ObjectMotion> motion_;  ///< null: no object has physics
  FrameTimes times_;
  output::SinkThread* files_ = nullptr;   ///< one of sinks_; none without an output folder
  output::SinkThread* people_ = nullptr;  ///< one of sinks_, where people are followed
  output::SinkThread* sheet_ = nullptr;   ///< one of sinks_; none without an output folder
  bool sheet_has_rows_ = false;
  std::shared_ptr<output::Composite> last_;
  Judge judge_;
  std::optional<Baselines> baselines_;
  std::optional<SlipWatch> slip_;
  std::optional<LensWatch> lens_;
  render::FrameOutput judged_;
  bool recording_ = true;    ///< files are written
  Image<float> no_depth_m_;  ///< of captures without: unknown everywhere
  std::optional<geometry::Pose> first_pose_;
  bool warned_ = false, warned_lost_ = false;
  std::string ended_ = "end of the source";
};

Result<void> Runner::prepare(FrameRange range, const ProgressFn& progress) {
  if (options_.out) {
    MIXRIG_ASSIGN(folder_, make_partial_folder(*options_.out, kReportName));
  }
  MIXRIG_TRY(open_sinks(range));
  // The background of a camera that moves is learned by its poses; one on the floor has its pose
  // from the background.
  const bool on_floor = session_.scene.pose_source == scene::PoseSource::kFloor;
  if (!on_floor) MIXRIG_TRY(prepare_poses(session_, clock_));
  MIXRIG_TRY(prepare_background(session_, progress));
  if (on_floor) MIXRIG_TRY(prepare_poses(session_, clock_));
  MIXRIG_TRY(open_streams());
  MIXRIG_TRY(prepare_frame_poses());
  if (options_.baselines) MIXRIG_TRY(open_baselines());
  keeper_.emplace(session_, live());
  if (options_.save_room) MIXRIG_TRY(check_save(session_, *options_.save_room));
  if (!options_.scene && live()) options_.scene = std::make_shared<SceneFollower>(session_, true);
  if (options_.watch_room.value_or(live())) MIXRIG_TRY(keeper_->open(options_.changes, gate()));
  if (options_.controls != nullptr) {
    options_.controls->can_record = files_ != nullptr || options_.controls->records_takes;
    options_.controls->can_learn = keeper_->is_open();
    options_.controls->can_scan = keeper_->is_open() && ChangeSink::can_scan(session_);
  }
  no_depth_m_.reset(session_.setup.tof.size_px());
  report_.backend = backend_of(compositor_->whole());
  report_.renderer = compositor_->whole().renderer();
  report_.size = session_.setup.view.size_px;
  // A live source may drop captures: it is read until enough were composited.
  reader_ = std::make_unique<capture::CaptureReader>(*session_.source, range.first,
                                                     live() ? capture::kEndless : range.second,
                                                     reads_truth(), gate());
  return {};
}

Result<void> Runner::prepare_frame_poses() {
  const pose::FramePoseOptions options = frame_pose_options(session_.scene);
  poses_.emplace(*session_.poses, options);
  report_.pose.source = session_.poses->name();
  report_.pose.latency_s = session_.poses->latency_s();
  report_.pose.when_lost = options.when_lost;
  slip_.emplace(contact_points(session_.setup.objects), session_.setup.view);
  lens_.emplace(session_.setup,
                session_.background && session_.rooms.empty() ? &*session_.background : nullptr);
  if (has_true_poses(session_)) report_.pose.error.emplace();
  hides_ = session_.poses->moves() && options.when_lost == pose::WhenLost::kHide;
  return compositor_->open(session_.setup, session_.backend, hides_);
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

Result<void> Runner::open_sinks(FrameRange range) {
  const auto when_full = live() ? output::WhenFull::kDropOldest : output::WhenFull::kWait;
  const auto add = [&](std::unique_ptr<output::CompositeSink> sink) {
    sinks_.push_back(std::make_unique<output::SinkThread>(std::move(sink), when_full, gate()));
  };
  if (folder_) {
    const capture::SourceInfo& info = session_.source->info();
    // A set without a picture leaves parts transparent.
    options_.output.alpha = session_.setup.backdrop && session_.setup.backdrop->picture.empty();
    MIXRIG_ASSIGN(auto files, output::FilesSink::create(folder_->path(), info, session_.setup.view,
                                                        options_.output));
    add(std::move(files));
    files_ = sinks_.back().get();
    add(std::make_unique<output::SheetSink>(
        folder_->path() / "contact_sheet.png",
        session_.scene.path.filename().string() + " in " + info.name,
        sheet_frames(range, options_.sheet_rows)));
    sheet_ = sinks_.back().get();
  }
  for (auto& sink : options_.sinks) add(std::move(sink));
  if (options_.epoch_ns && !session_.scene.pose_outs.empty()) {
    const auto begin = live() ? std::nullopt : std::optional(clock_.now());
    auto poses =
        PoseSink::create(session_.scene.pose_outs, *options_.epoch_ns, begin, report_.pose_outs);
    if (!poses)
      return Error{poses.error().code, session_.scene.path.string() + ": " + poses.error().context};
    add(*std::move(poses));
  }
  MIXRIG_TRY(check_streams());
  return open_people();
}

double Runner::stream_rate_hz() const {
  const double rate_hz = session_.source->info().rate_hz;
  return rate_hz > 0 ? rate_hz : 25;
}

Result<void> Runner::check_streams() {
  auto& streams = options_.streams;
  streams.insert(streams.begin(), session_.scene.stream_outs.begin(),
                 session_.scene.stream_outs.end());
  for (const scene::StreamOut& out : streams)
    MIXRIG_TRY(output::StreamSink::check(out, session_.setup.view.size_px, stream_rate_hz()));
  report_.stream_outs.resize(streams.size());
  return {};
}

/// After the background: what a stereo pair shows behind people is of it.
Result<void> Runner::open_streams() {
  const render::CompositorSetup& setup = session_.setup;
  const bool transparent = setup.backdrop && setup.backdrop->picture.empty();
  for (std::size_t i = 0; i < options_.streams.size(); ++i) {
    const scene::StreamOut& out = options_.streams[i];
    output::RoomBehind behind;
    if (out.picture == scene::StreamOut::Picture::kStereo && !setup.backdrop)
      behind = output::room_behind(setup.background);
    MIXRIG_ASSIGN(auto sink,
                  output::StreamSink::create(out, setup.view.size_px, stream_rate_hz(), transparent,
                                             std::move(behind), report_.stream_outs[i]));
    sinks_.push_back(std::make_unique<output::SinkThread>(
        std::move(sink), live() ? output::WhenFull::kDropOldest : output::WhenFull::kWait, gate()));
  }
  return {};
}

/// In a thread of their own, as other sinks.
Result<void> Runner::open_people() {
  const scene::Scene& scene = session_.scene;
  motion_ = ObjectMotion::create(session_);
  if (!options_.follow_people.value_or(scene.follow_people || scene.events || motion_)) {
    motion_.reset();
    return {};
  }
  std::optional<std::filesystem::path> folder;
  if (folder_) folder = folder_->path();
  MIXRIG_ASSIGN(auto sink, PeopleSink::create(folder, {}, report_.people.emplace()));
  if (scene.events || motion_) {
    MIXRIG_ASSIGN(auto touch,
                  TouchStage::create(session_, folder, motion_.get(), report_.events.emplace()));
    sink->watch_touch(std::move(touch));
  }
  sinks_.push_back(std::make_unique<output::SinkThread>(
      std::move(sink), live() ? output::WhenFull::kDropOldest : output::WhenFull::kWait, gate()));
  people_ = sinks_.back().get();
  return {};
}

/// Of the room and of the scene.
Result<void> Runner::follow_changes() {
  exchange_.use(keeper_->take_learned());
  if (options_.scene) exchange_.use(options_.scene->take_edited());
  MIXRIG_TRY(exchange_.exchange(compositor_, hides_));
  if (options_.scene) scene_differs_ = options_.scene->fill(exchange_.scene(), frame_scene_);
  return {};
}

void Runner::move_objects(output::Composite& composite) {
  composite.world_from_object.clear();
  if (!motion_) {
    if (scene_differs_ || exchange_.is_edited())
      composite.world_from_object = frame_scene_.world_from_object;
    return;
  }
  place_moved_objects();
  if (people_ != nullptr && !live()) people_->wait_until_idle();
  const HostTime begin = clock_.now();
  const auto poses =
      motion_->advance(times_.next(composite.capture->time_s), composite.world_from_target);
  report_.physics_ms.add(milliseconds(clock_.now() - begin));
  composite.world_from_object.assign(poses.begin(), poses.end());
}

/// Objects with physics go on from where the scene has been changed to put them.
void Runner::place_moved_objects() {
  const auto& wanted = frame_scene_.world_from_object;
  for (std::size_t i = 0; i < std::min(wanted.size(), wanted_poses_.size()); ++i)
    if (!(wanted[i] == wanted_poses_[i])) motion_->place(i, wanted[i]);
  wanted_poses_ = wanted;
}

/// Images that a sink requires; files none while the operator does not record.
render::OutputMask Runner::wanted_by(const output::SinkThread& sink, int number) const {
  return !recording_ && &sink == files_ ? 0 : sink.sink().wanted(number);
}

/// Images that a frame's sinks require; always the matte, for the share of foreground.
render::OutputMask Runner::wanted_by_sinks(int number) const {
  // A recording is composited completely, also without sinks, so that its times are comparable.
  render::OutputMask mask = live() ? render::kMatte : render::kComposite;
  for (const auto& sink : sinks_) mask |= wanted_by(*sink, number);
  return mask;
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

Result<bool> Runner::frame() {
  MIXRIG_ASSIGN(auto item, next_item());
  if (!item) return false;
  if (auto fault = head_.fault(session_, *item->capture)) {
    if (!live()) return Error{ErrorCode::kData, *std::move(fault)};
    ended_ = *std::move(fault);
    return false;
  }
  MIXRIG_TRY(follow_changes());
  if (options_.controls != nullptr && !options_.controls->records_takes)
    recording_ = options_.controls->recording;  // of a whole frame
  const render::OutputMask wanted = wanted_by_sinks(item->capture->number);
  const bool inspected = (wanted & ~render::kComposite) != 0;
  last_.reset();  // its buffers may be used again
  last_ = (inspected ? inspected_ : composites_).take();
  output::Composite& composite = *last_;
  composite.capture = std::move(item->capture);
  const bool on_sheet = sheet_ != nullptr && sheet_->sink().wanted(composite.capture->number) != 0;
  composite.truth = on_sheet ? item->truth : nullptr;  // only the sheet shows it
  composite.true_people.reset();
  if (options_.true_people && item->truth) composite.true_people = item->truth->people;
  composite.view = frame_view(session_.setup, *composite.capture);
  set_pose(composite);
  move_objects(composite);
  watch_slip(composite, judges() ? item->truth.get() : nullptr);
  lens_->add(*composite.capture, composite.world_from_target);
  watch_camera(composite.world_from_target);

  // A live frame is made once. Of a recording, whose times are compared, the timed pass makes what
  // every frame has; the images of an inspection come in a second one.
  const bool once = live() && !on_sheet;
  MIXRIG_TRY(compose_timed(composite, once ? wanted : wanted & render::kComposite));
  composite.foreground_pct = foreground_pct(composite.images.matte);
  report_.foreground_pct.add(composite.foreground_pct);

  if (inspected && !once) MIXRIG_TRY(compose(composite, wanted, composite.images));
  if (judges() && !exchange_.is_edited()) MIXRIG_TRY(judge(composite, *item->truth));
  MIXRIG_TRY(deliver(last_));
  return true;
}

void Runner::set_pose(output::Composite& composite) {
  const pose::FramePose known = poses_->next(*composite.capture);
  composite.pose = known.camera;
  composite.world_from_target = known.camera.world_from_target;
  composite.objects_shown = known.objects_shown;
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
  MIXRIG_TRY(compose(composite, wanted, composite.images));
  composite.frame_ms = static_cast<float>(milliseconds(clock_.now() - begin));
  report_.frame_ms.add(composite.frame_ms);
  if (live()) report_.latency_ms.add(milliseconds(clock_.now() - composite.capture->mid_exposure));
  const render::StageTimes& times = compositor_->stage_times();
  for (std::size_t i = 0; i < times.size(); ++i) report_.stage_ms[i].add(times[i]);
  return {};
}

Result<void> Runner::compose(const output::Composite& composite, render::OutputMask wanted,
                             render::FrameOutput& images) {
  images.wanted = wanted;
  const Image<float>& depth_m = composite.capture->depth_m;
  return compositor_->compose({composite.capture->plate, depth_m.empty() ? no_depth_m_ : depth_m,
                               composite.world_from_target, frame_lens(*composite.capture),
                               composite.world_from_object, composite.capture->depth2.depth_m,
                               scene_differs_ ? std::optional(frame_scene_.light) : std::nullopt},
                              composite.objects_shown, images);
}

/// In images of its own, so that composites which wait for a sink do not hold them.
Result<void> Runner::judge(const output::Composite& composite, const capture::Truth& truth) {
  MIXRIG_TRY(compose(composite, Judge::kWanted, judged_));
  MIXRIG_TRY(judge_.add(truth, judged_));
  if (!baselines_) return {};
  return baselines_->add(*composite.capture, composite.world_from_target, composite.objects_shown,
                         truth);
}

Result<void> Runner::deliver(const output::CompositePtr& composite) {
  for (const auto& sink : sinks_) {
    if (wanted_by(*sink, composite->capture->number) == 0) continue;
    MIXRIG_TRY(sink->push(composite));
    // Composites with inspection images are large: of a recording only one exists at a time.
    if (!live() && sink.get() == sheet_) sink->wait_until_idle();
    sheet_has_rows_ |= sink.get() == sheet_;
  }
  return composite->capture->depth_m.empty() ? Result<void>() : keeper_->push(composite);
}

/// A run that was stopped before the first frame of its sheet shows its last frame.
Result<void> Runner::add_last_to_sheet() {
  std::shared_ptr<output::Composite> composite = inspected_.take();
  composite->capture = last_->capture;
  composite->world_from_target = last_->world_from_target;
  composite->view = last_->view;
  composite->objects_shown = last_->objects_shown;
  composite->world_from_object = last_->world_from_object;
  MIXRIG_TRY(compose(*composite, output::ContactSheet::kWanted, composite->images));
  return sheet_->push(std::move(composite));
}

Result<void> Runner::finish_watch() {
  MIXRIG_TRY(keeper_->finish());
  exchange_.finish();
  report_.swap_ms = exchange_.swap_ms();
  if (options_.scene) report_.scene_edits = options_.scene->edits();
  if (keeper_->is_open()) {
    report_.room_changes = keeper_->report();
    report_.room_changes->swap_ms = exchange_.swap_ms();
  }
  if (!options_.save_room) return {};
  if (keeper_->kept() != nullptr) return save_kept(session_, *keeper_->kept(), *options_.save_room);
  log_warning("session", "--save-room " + options_.save_room->string() +
                             ": no change was accepted, so that nothing was written");
  return {};
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
  if (sheet_ != nullptr && !sheet_has_rows_) MIXRIG_TRY(add_last_to_sheet());
  report_.pose.frames = poses_->counts();
  report_.pose.faults = session_.poses->faults();
  report_.pose.slip = slip_->report();
  report_.lens = lens_->report();
  report_.pose.stream = session_.poses->stream();
  MIXRIG_TRY(finish_watch());
  compositor_->close();  // its buffers are not needed beside the sheet's
  judged_ = {};
  composites_ = {};
  for (const auto& sink : sinks_) {
    MIXRIG_TRY(sink->finish());
    report_.sinks.push_back(sink->report());
  }
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
