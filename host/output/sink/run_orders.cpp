// SPDX-License-Identifier: Apache-2.0
#include "host/output/sink/run_orders.h"

namespace mixrig::output {
namespace {

/// Sets the state as it will be once the order is done, where that is known.
void assume_done(const RunOrder& order, RunState& state) {
  if (const auto* show = std::get_if<ShowView>(&order)) state.view = show->view;
  if (const auto* freeze = std::get_if<FreezePictures>(&order)) state.frozen = freeze->on;
  if (const auto* record = std::get_if<Record>(&order)) state.recording = record->on;
  if (const auto* room = std::get_if<LearnRoom>(&order))
    state.scan_left = room->on ? kScanLooks : 0;
  if (const auto* focus = std::get_if<FocusAt>(&order)) state.focus_px = focus->pixel;
}

bool needs_no_frame(const RunOrder& order) {
  return std::holds_alternative<StopRun>(order) || std::holds_alternative<ShowView>(order) ||
         std::holds_alternative<FreezePictures>(order);
}

}  // namespace

std::string_view text(Placement placement) {
  switch (placement) {
    case Placement::kPlaced:
      return "placed";
    case Placement::kNoSurface:
      return "nothing can stand there: the log says why";
    case Placement::kFailed:
      break;
  }
  return "not placed: the log says why";
}

Result<void> RunOrders::give(const RunOrder& order) {
  if (std::holds_alternative<StopRun>(order)) stop_ = true;
  const std::lock_guard lock(mutex_);
  if (needs_no_frame(order)) {
    assume_done(order, told_);
    return {};
  }
  if (count_ == kMost)
    return Error{ErrorCode::kData, "too many orders wait for a frame: ask again when one comes"};
  waiting_[count_++] = order;
  return {};
}

std::size_t RunOrders::find(IsKind is_kind) const {
  std::size_t at = 0;
  while (at < count_ && !is_kind(waiting_[at])) ++at;
  return at;
}

std::optional<RunOrder> RunOrders::take_first(IsKind is_kind) {
  const std::lock_guard lock(mutex_);
  const std::size_t at = find(is_kind);
  if (at == count_) return std::nullopt;
  const RunOrder order = waiting_[at];
  --count_;
  for (std::size_t i = at; i < count_; ++i) waiting_[i] = waiting_[i + 1];
  assume_done(order, told_);
  return order;
}

RunState RunOrders::state() const {
  const std::lock_guard lock(mutex_);
  RunState state = told_;
  for (std::size_t i = 0; i < count_; ++i) assume_done(waiting_[i], state);
  return state;
}

}  // namespace mixrig::output
