// SPDX-License-Identifier: Apache-2.0
#include "host/run/controls/edit_history.h"

#include <chrono>
#include <utility>

#include "hal/base/partial_path.h"
#include "host/math/config/table.h"

namespace mixrig::session {
namespace {

constexpr std::size_t kMostEdits = 100;
constexpr std::size_t kMostEditedBytes = std::size_t{1} << 20;
constexpr std::chrono::seconds kJoinWithin{1};

/// Replaces the text of a file which nobody else has changed.
Result<void> replace_text(const std::filesystem::path& file, const std::string& from,
                          const std::string& to, const std::string& what) {
  MIXRIG_ASSIGN(const std::string now, config::read_text(file, kMostEditedBytes));
  if (now != from)
    return Error{ErrorCode::kData, "another program has changed " + file.filename().string() +
                                       " since \"" + what +
                                       "\": what it wrote would be lost, change it there"};
  return write_file(file, to);
}

}  // namespace

void EditHistory::add(Edit edit) {
  const std::lock_guard lock(mutex_);
  const HostTime now = clock_.now();
  edits_.resize(done_);
  const bool joins = joins_ && done_ > 0 && edits_.back().what == edit.what &&
                     edits_.back().after == edit.before && now - last_ <= kJoinWithin;
  last_ = now, joins_ = true;
  if (joins) {
    edits_.back().after = std::move(edit.after);
    edits_.back().on_redo = std::move(edit.on_redo);
    return;
  }
  if (edits_.size() == kMostEdits) edits_.erase(edits_.begin());
  edits_.push_back(std::move(edit));
  done_ = edits_.size();
}

Result<void> EditHistory::undo() {
  const std::lock_guard lock(mutex_);
  if (done_ == 0) return Error{ErrorCode::kData, "there is no change that could be undone"};
  const Edit& edit = edits_[done_ - 1];
  MIXRIG_TRY(replace_text(edit.file, edit.after, edit.before, edit.what));
  --done_, joins_ = false;
  return edit.on_undo ? edit.on_undo() : Result<void>();
}

Result<void> EditHistory::redo() {
  const std::lock_guard lock(mutex_);
  if (done_ == edits_.size())
    return Error{ErrorCode::kData, "there is no change that could be made again"};
  const Edit& edit = edits_[done_];
  MIXRIG_TRY(replace_text(edit.file, edit.before, edit.after, edit.what));
  ++done_, joins_ = false;
  return edit.on_redo ? edit.on_redo() : Result<void>();
}

std::string EditHistory::next_undo() const {
  const std::lock_guard lock(mutex_);
  return done_ == 0 ? std::string() : edits_[done_ - 1].what;
}

std::string EditHistory::next_redo() const {
  const std::lock_guard lock(mutex_);
  return done_ == edits_.size() ? std::string() : edits_[done_].what;
}

}  // namespace mixrig::session
