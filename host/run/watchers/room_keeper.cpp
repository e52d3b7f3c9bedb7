// SPDX-License-Identifier: Apache-2.0
#include "host/run/watchers/room_keeper.h"

#include <utility>

#include "host/run/watchers/change_sink.h"

namespace mixrig::session {

Result<void> RoomKeeper::open(const ChangeOptions& options, WorkGate* gate) {
  if (!ChangeSink::can_watch(session_)) return {};
  MIXRIG_ASSIGN(auto sink, ChangeSink::create(session_, options));
  sink_ = sink.get();
  thread_ = std::make_unique<output::SinkThread>(
      std::move(sink), live_ ? output::WhenFull::kDropOldest : output::WhenFull::kWait, gate);
  return {};
}

Result<void> RoomKeeper::push(const output::CompositePtr& composite) {
  const int number = composite->capture->number;
  if (sink_ == nullptr || number < next_look_) return {};
  next_look_ = number - number % ChangeSink::kFrameStep + ChangeSink::kFrameStep;
  MIXRIG_TRY(thread_->push(composite));
  if (!live_) thread_->wait_until_idle();
  return {};
}

std::shared_ptr<const KeptBackground> RoomKeeper::take_learned() {
  return sink_ != nullptr ? sink_->take_learned() : nullptr;
}

Result<void> RoomKeeper::finish() { return thread_ ? thread_->finish() : Result<void>(); }

const KeptBackground* RoomKeeper::kept() const {
  return sink_ != nullptr ? sink_->kept() : nullptr;
}

RoomChangesReport RoomKeeper::report() const { return sink_->report(); }

}  // namespace mixrig::session
