// SPDX-License-Identifier: Apache-2.0
#include "host/session/room_keeper.h"

#include <chrono>
#include <utility>

#include "host/session/change_sink.h"

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

Result<RoomKeeper::Next> RoomKeeper::make(std::shared_ptr<KeptBackground> background,
                                          BackendChoice backend, bool hides) {
  Next next{std::move(background), std::make_unique<HidingCompositor>()};
  MIXRIG_TRY(next.compositor->open(next.background->setup, backend, hides));
  return next;
}

Result<void> RoomKeeper::exchange(std::unique_ptr<HidingCompositor>& compositor, bool hides) {
  if (sink_ == nullptr) return {};
  if (!making_.valid()) {
    auto learned = sink_->take_learned();
    if (!learned) return {};
    making_ = std::async(std::launch::async, make, std::move(learned), session_.backend, hides);
  }
  using std::chrono::seconds;
  if (live_ && making_.wait_for(seconds(0)) != std::future_status::ready) return {};
  const HostTime begin = clock_.now();
  MIXRIG_ASSIGN(Next next, making_.get());
  compositor = std::move(next.compositor);
  in_use_ = std::move(next.background);
  swap_ms_.add(milliseconds(clock_.now() - begin));
  return {};
}

Result<void> RoomKeeper::finish() {
  if (making_.valid()) making_.wait();
  return thread_ ? thread_->finish() : Result<void>();
}

const KeptBackground* RoomKeeper::kept() const {
  return sink_ != nullptr ? sink_->kept() : nullptr;
}

RoomChangesReport RoomKeeper::report() const {
  RoomChangesReport report = sink_->report();
  report.swap_ms = swap_ms_;
  return report;
}

}  // namespace mixrig::session
