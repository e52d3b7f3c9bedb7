// SPDX-License-Identifier: Apache-2.0
#include "host/run/watchers/room_keeper.h"

#include <utility>

#include "host/run/watchers/change_sink.h"

namespace mixrig::session {

Result<void> RoomKeeper::open(const ChangeOptions& options, output::RunOrders* orders,
                              WorkGate* gate) {
  if (!ChangeSink::can_watch(session_)) return {};
  MIXRIG_ASSIGN(auto sink, ChangeSink::create(session_, options, orders));
  watch_.open(std::move(sink), live_, gate);
  return {};
}

Result<void> RoomKeeper::push(const output::CompositePtr& composite) {
  const int number = composite->capture->number;
  if (!is_open() || number < next_look_) return {};
  next_look_ = number - number % ChangeSink::kFrameStep + ChangeSink::kFrameStep;
  return watch_.push(composite);
}

std::shared_ptr<const KeptBackground> RoomKeeper::take_learned() {
  return is_open() ? watch_.sink()->take_learned() : nullptr;
}

Result<void> RoomKeeper::finish() { return watch_.finish(); }

const KeptBackground* RoomKeeper::kept() const {
  return is_open() ? watch_.sink()->kept() : nullptr;
}

RoomChangesReport RoomKeeper::report() const { return watch_.sink()->report(); }

}  // namespace mixrig::session
