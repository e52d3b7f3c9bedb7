// SPDX-License-Identifier: Apache-2.0
#include "host/session/composite_recorder.h"

#include <utility>

#include "host/config/writer.h"

namespace mixrig::session {
namespace fs = std::filesystem;

CompositeRecorder::CompositeRecorder(const Session& session, fs::path folder)
    : session_(session), folder_(std::move(folder)) {}

/// What runs is kept.
CompositeRecorder::~CompositeRecorder() {
  const std::lock_guard lock(mutex_);
  if (files_) (void)finish();
}

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
    if (!fs::exists(folder_ / name)) return name;
  }
}

Result<void> CompositeRecorder::start(const std::string& name, const std::string& notes) {
  const std::lock_guard lock(mutex_);
  if (files_)
    return Error{ErrorCode::kData, "\"" + state().name + "\" is being recorded: stop it first"};
  const std::string used = name.empty() ? free_name() : name;
  const fs::path wanted = folder_ / used;
  if (fs::exists(wanted))
    return Error{ErrorCode::kUsage, wanted.string() + " exists: give another name"};
  std::error_code code;
  fs::create_directories(folder_, code);
  PartialPath path(wanted);
  if (!code) fs::create_directory(path.path(), code);
  if (code)
    return system_error(ErrorCode::kIo, "cannot make folder " + wanted.string(), code.value());
  MIXRIG_ASSIGN(files_,
                output::FilesSink::create(path.path(), session_.source->info(), session_.setup.view,
                                          {.format = output::OutputFormat::kVideo}));
  path_.emplace(std::move(path));
  change_state([&](page::RecordingState& state) {
    state = {};
    state.on = true, state.name = used, state.notes = notes;
  });
  last_number_ = 0;
  on_ = true;
  return {};
}

void CompositeRecorder::write(const output::CompositePtr& composite) {
  constexpr render::OutputMask kNeeds = render::kColor | render::kMixedDepth;
  const std::lock_guard lock(mutex_);
  if (!files_ || (composite->images.wanted & kNeeds) != kNeeds) return;
  const int number = composite->capture->number;
  const double now_s = seconds(composite->capture->mid_exposure.time_since_epoch());
  if (last_number_ == 0) first_s_ = now_s;
  const int lost = last_number_ > 0 ? number - last_number_ - 1 : 0;
  last_number_ = number;
  if (auto done = files_->write(composite); !done) return give_up(done.error());
  change_state([&](page::RecordingState& state) {
    ++state.frames;
    state.lost += static_cast<std::uint64_t>(lost);
    state.seconds = now_s - first_s_;
  });
}

/// Precondition: mutex_ is held.
void CompositeRecorder::give_up(const Error& error) {
  on_ = false;
  files_.reset(), path_.reset();
  change_state([&](page::RecordingState& state) {
    state.on = false;
    state.error = to_line(error);
  });
}

/// Precondition: mutex_ is held.
Result<void> CompositeRecorder::finish() {
  on_ = false;
  const page::RecordingState made = state();
  config::Writer table;
  table.set("name", made.name).set("notes", made.notes);
  table.set("scene", session_.scene.path.string()).set("source", session_.source->info().name);
  table.set("frames", static_cast<double>(made.frames));
  table.set("lost", static_cast<double>(made.lost)).set("seconds", made.seconds);
  Result<void> done = files_->finish();
  if (done) done = write_file(path_->path() / "recording.toml", table.text());
  if (done) done = path_->commit();
  if (!done) return give_up(done.error()), done;
  files_.reset(), path_.reset();
  change_state([&](page::RecordingState& state) {
    state.on = false;
    state.folder = (folder_ / made.name).string();
  });
  return {};
}

Result<void> CompositeRecorder::stop() {
  const std::lock_guard lock(mutex_);
  if (!files_) return Error{ErrorCode::kData, "nothing is being recorded"};
  if (state().frames > 0) return finish();
  const Error none{ErrorCode::kData,
                   "\"" + state().name + "\" has no frame yet: nothing was recorded"};
  give_up(none);
  return none;
}

}  // namespace mixrig::session
