// SPDX-License-Identifier: Apache-2.0
#include "host/operator/desk/composite_recorder.h"

#include <algorithm>
#include <utility>

#include <fmt/format.h>

#include "hal/base/guarded.h"
#include "hal/base/left_partial.h"
#include "hal/base/thread_priority.h"
#include "host/math/config/writer.h"

namespace mixrig::session {
namespace fs = std::filesystem;

namespace {

constexpr double kLeastFree_gb = 0.5;  ///< of the disk; as `mixrig record --keep-free`
constexpr std::size_t kMostWaitingBytes = std::size_t{256} << 20;
constexpr std::size_t kLeastWaiting = 4, kMostWaitingFrames = 256;
constexpr std::size_t kBytesOfPixel = sizeof(Rgb8) + sizeof(float);

}  // namespace

CompositeRecorder::CompositeRecorder(const Session& session, fs::path folder, FreeSpace free_space,
                                     double segment_s)
    : session_(session),
      folder_(std::move(folder)),
      free_space_(std::move(free_space)),
      segment_s_(segment_s) {}

/// Ends a running recording and keeps it.
CompositeRecorder::~CompositeRecorder() { (void)stop(); }

page::RecordingState CompositeRecorder::state() const {
  const std::lock_guard lock(state_mutex_);
  return state_;
}

template <typename Change>
void CompositeRecorder::change_state(Change&& change) {
  const std::lock_guard lock(state_mutex_);
  change(state_);
}

std::string CompositeRecorder::free_name() const {
  for (int i = 1;; ++i) {
    const std::string name = "take " + std::to_string(i);
    if (!fs::exists(folder_ / name) && !has_left_partial(folder_ / name)) return name;
  }
}

Result<void> CompositeRecorder::start(const std::string& name, const std::string& notes) {
  const std::lock_guard lock(mutex_);
  if (on_)
    return Error{ErrorCode::kData, "\"" + state().name + "\" is being recorded: stop it first"};
  join();  // of one that a fault has ended
  const std::string used = name.empty() ? free_name() : name;
  MIXRIG_TRY(open(used));
  change_state([&](page::RecordingState& state) {
    state = {};
    state.on = true, state.name = used, state.notes = notes;
  });
  const std::lock_guard queue_lock(queue_mutex_);
  const auto area = static_cast<std::size_t>(session_.setup.view.size_px.area());
  most_waiting_ =
      std::max(kLeastWaiting, kMostWaitingBytes / (kBytesOfPixel * std::max<std::size_t>(area, 1)));
  most_waiting_ = std::min(most_waiting_, kMostWaitingFrames);
  last_number_ = 0, ends_ = false;
  thread_ = guarded_thread(
      "recording", [this] { return run(); }, [this](const Error& error) { end_early(error); });
  on_ = true;
  return {};
}

/// Precondition: mutex_ is held.
Result<void> CompositeRecorder::open(const std::string& name) {
  const fs::path wanted = folder_ / name;
  if (fs::exists(wanted))
    return Error{ErrorCode::kUsage, wanted.string() + " exists: give another name"};
  MIXRIG_TRY(set_aside_left(wanted));
  MIXRIG_TRY(check_disk());
  std::error_code code;
  fs::create_directories(folder_, code);
  PartialPath path(wanted);
  if (!code) fs::create_directory(path.path(), code);
  if (code)
    return system_error(ErrorCode::kIo, "cannot make folder " + wanted.string(), code.value());
  MIXRIG_ASSIGN(files_, output::FilesSink::create(
                            path.path(), session_.source->info(), session_.setup.view,
                            {.format = output::OutputFormat::kVideo, .segment_s = segment_s_}));
  path_.emplace(std::move(path));
  return {};
}

Result<void> CompositeRecorder::check_disk() const {
  const std::optional<double> free = free_space_(folder_);
  if (!free || *free >= kLeastFree_gb) return {};
  return Error{ErrorCode::kIo,
               fmt::format("'{}': disk almost full, {:.1f} GB are free: free some, or record to "
                           "another disk",
                           folder_.string(), *free)};
}

/// Copies the images that FilesSink writes; the frame's own buffers go back to the run.
output::CompositePtr CompositeRecorder::copy(const output::Composite& from) {
  const capture::Capture& seen = *from.capture;
  auto values = std::make_shared<capture::Capture>();
  values->number = seen.number, values->tick = seen.tick, values->time_s = seen.time_s;
  values->mid_exposure = seen.mid_exposure, values->lens = seen.lens;
  auto to = copies_.take();
  to->capture = std::move(values);
  to->pose = from.pose, to->view = from.view, to->world_from_target = from.world_from_target;
  to->slip_px = from.slip_px, to->slip_sigma_px = from.slip_sigma_px;
  to->frame_ms = from.frame_ms, to->foreground_pct = from.foreground_pct;
  to->images.wanted = render::kColor | render::kMixedDepth;
  to->images.color = from.images.color;
  to->images.mixed_depth_m = from.images.mixed_depth_m;
  return to;
}

void CompositeRecorder::write(const output::CompositePtr& composite) {
  constexpr render::OutputMask kNeeds = render::kColor | render::kMixedDepth;
  if (!on_ || (composite->images.wanted & kNeeds) != kNeeds) return;
  const int number = composite->capture->number;
  const double now_s = seconds(composite->capture->mid_exposure.time_since_epoch());
  bool has_room = false;
  {
    const std::lock_guard lock(queue_mutex_);
    has_room = !ends_ && queue_.size() < most_waiting_;
  }
  output::CompositePtr kept = has_room ? copy(*composite) : nullptr;
  const std::lock_guard lock(queue_mutex_);
  if (ends_) return;
  if (last_number_ == 0) first_s_ = now_s;
  const int lost = (last_number_ > 0 ? number - last_number_ - 1 : 0) + (kept ? 0 : 1);
  last_number_ = number;
  change_state([&](page::RecordingState& state) {
    state.frames += kept ? 1 : 0;
    state.lost += static_cast<std::uint64_t>(lost);
    state.seconds = now_s - first_s_;
  });
  if (!kept) return;
  queue_.push_back(std::move(kept));
  wake_.notify_one();
}

/// Encodes until the queue is empty at the end.
Result<void> CompositeRecorder::run() {
  lower_thread_priority();
  for (;;) {
    std::unique_lock lock(queue_mutex_);
    wake_.wait(lock, [this] { return ends_ || !queue_.empty(); });
    if (queue_.empty()) return {};
    const output::CompositePtr next = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    MIXRIG_TRY(check_disk());
    MIXRIG_TRY(files_->write(next));
  }
}

/// Completes the recording by what was written before an error; frames that wait are lost. Called
/// by the thread.
void CompositeRecorder::end_early(const Error& error) {
  std::uint64_t lost = 1;
  {
    const std::lock_guard lock(queue_mutex_);
    ends_ = true;
    lost += queue_.size();
    queue_.clear();
  }
  std::uint64_t written = 0;
  change_state([&](page::RecordingState& state) {
    state.lost += lost, state.frames -= lost;
    written = state.frames;
  });
  if (written == 0) return give_up(error);
  if (!complete(to_line(error))) return give_up(keep_partial(error));
  change_state([&](page::RecordingState& state) { state.error = to_line(error); });
  on_ = false;
}

/// Leaves the recording under its partial name, which the returned error says.
Error CompositeRecorder::keep_partial(const Error& error) {
  const std::string partial = path_->path().string();
  path_->keep();
  return {error.code, error.context + ": what was written before is in '" + partial + "'"};
}

/// Ends the recording with an error; frames that wait are lost. Called by the thread, or while it
/// does not run.
void CompositeRecorder::give_up(const Error& error) {
  {
    const std::lock_guard lock(queue_mutex_);
    ends_ = true;
    queue_.clear();
  }
  files_.reset(), path_.reset();
  change_state([&](page::RecordingState& state) {
    state.on = false;
    state.error = to_line(error);
  });
  on_ = false;
}

/// Precondition: mutex_ is held.
void CompositeRecorder::join() {
  {
    const std::lock_guard lock(queue_mutex_);
    ends_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
}

/// Writes what is left of the recording and gives it its name. `ended`: why it ends, for
/// recording.toml. Called by the thread, or with mutex_ held after the thread has ended.
Result<void> CompositeRecorder::complete(const std::string& ended) {
  const page::RecordingState made = state();
  config::Writer table;
  table.set("name", made.name).set("notes", made.notes);
  table.set("scene", session_.scene.path.string()).set("source", session_.source->info().name);
  table.set("frames", static_cast<double>(made.frames));
  table.set("lost", static_cast<double>(made.lost)).set("seconds", made.seconds);
  table.set("ended", ended);
  Result<void> done = files_->finish();
  if (done) done = write_file(path_->path() / "recording.toml", table.text());
  if (done) done = path_->commit();
  if (!done) return done;
  files_.reset(), path_.reset();
  change_state([&](page::RecordingState& state) {
    state.on = false;
    state.folder = (folder_ / made.name).string();
  });
  return {};
}

Result<void> CompositeRecorder::stop() {
  const std::lock_guard lock(mutex_);
  const bool ran = on_;
  join();
  if (!ran || !files_) {
    const std::string why = ran ? state().error : "nothing is being recorded";
    return Error{ErrorCode::kData, why};
  }
  on_ = false;
  if (state().frames > 0) {
    const auto done = complete("stopped");
    if (done) return done;
    const Error failed = keep_partial(done.error());
    give_up(failed);
    return failed;
  }
  const Error none{ErrorCode::kData,
                   "\"" + state().name + "\" has no frame yet: nothing was recorded"};
  give_up(none);
  return none;
}

}  // namespace mixrig::session
