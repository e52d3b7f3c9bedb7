// SPDX-License-Identifier: Apache-2.0
// What an operator asks of a run while it runs (keys, signals, page, OSC), and what the run tells
// of itself. There is one for a run, so that each of them shows what the others have changed.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string_view>
#include <type_traits>
#include <variant>

#include <glm/glm.hpp>

#include "hal/base/result.h"
#include "host/output/sink/views.h"

namespace mixrig::output {

/// The run ends with the frames done so far.
struct StopRun {};
/// Of the pictures that are shown, not of what is written.
struct ShowView {
  View view = View::kComposite;
};
/// The pictures that are shown stay as they are.
struct FreezePictures {
  bool on = false;
};
/// As RunState::recording.
struct Record {
  bool on = false;
};
/// What changed in the room becomes background.
struct LearnChanges {};
/// Begins kScanLooks looks at the empty room, or ends them without a result.
struct LearnRoom {
  bool on = false;
};
/// What is seen at this pixel of the view is sharp from now on.
struct FocusAt {
  glm::ivec2 pixel{0, 0};
};
/// Sets an object, counted from 0, on the surface that is seen at a pixel of the view.
struct PlaceObject {
  int object = 0;
  glm::ivec2 pixel{0, 0};
};
using RunOrder = std::variant<StopRun, ShowView, FreezePictures, Record, LearnChanges, LearnRoom,
                              FocusAt, PlaceObject>;

/// Looks at the empty room before it replaces the background.
inline constexpr int kScanLooks = 24;

/// What became of an order to place an object.
enum class Placement : std::uint8_t { kPlaced, kNoSurface, kFailed };
std::string_view text(Placement placement);

/// What a run tells of itself.
struct RunState {
  View view = View::kComposite;
  bool frozen = false;
  /// False: frames are not written to the run's files. With `records_takes` instead: whether a take
  /// is being recorded.
  bool recording = true;
  bool records_takes = false;
  int scan_left = 0;                      ///< looks that are still to be taken; 0: none is at work
  std::optional<glm::ivec2> focus_px;     ///< by an operator; absent: as the scene says
  int objects = 0;                        ///< that can be placed
  std::uint32_t placements = 0;           ///< orders to place that were obeyed or refused
  Placement placed = Placement::kPlaced;  ///< of the last of them
  bool can_learn = false;                 ///< the background is watched
  bool can_scan = false;                  ///< it is of one view, which can be learned anew
  bool can_record = false;                ///< there is a folder to write to
  bool can_focus = false;                 ///< the scene has a [focus]
};

/// Any threads. The lock is held for a copy only, and nothing allocates but an error. It must
/// outlive the run and its sinks.
class RunOrders {
 public:
  static constexpr std::size_t kMost = 16;  ///< that wait

  /// `stop` ends the run and its devices, and outlives this.
  explicit RunOrders(std::atomic<bool>& stop) : stop_(stop) {}

  /// StopRun, ShowView and FreezePictures are in force at once, since no frame is needed for them;
  /// the others wait until a frame comes to who obeys them. Who gives one has seen in state() that
  /// the run can do it. Errors: kData where kMost wait; this one is left out then.
  Result<void> give(const RunOrder& order);
  /// As LearnChanges; for a signal handler too.
  void learn_by_signal() { learn_signal_ = true; }

  /// The oldest of one kind that waits; each kind has one thread that takes it.
  template <typename Order>
  std::optional<Order> take() {
    if constexpr (std::is_same_v<Order, LearnChanges>)
      if (learn_signal_.exchange(false)) return LearnChanges{};
    const std::optional<RunOrder> order = take_first(is<Order>);
    return order ? std::optional<Order>(std::get<Order>(*order)) : std::nullopt;
  }
  /// Whether one of this kind waits.
  template <typename Order>
  bool waits() const {
    const std::lock_guard lock(mutex_);
    return find(is<Order>) < count_;
  }

  /// As the run told it last, with what waits as if it were done: a screen shows at once what it
  /// asked for.
  RunState state() const;
  /// Changes what state() gives: `change(RunState&)` is called under the lock and assigns values
  /// alone. Each value has one writer, the thread that obeys the orders it is about.
  template <typename Change>
  void tell(const Change& change) {
    const std::lock_guard lock(mutex_);
    change(told_);
  }
  const std::atomic<bool>& stop() const { return stop_; }

 private:
  using IsKind = bool (*)(const RunOrder&);
  template <typename Order>
  static bool is(const RunOrder& order) {
    return std::holds_alternative<Order>(order);
  }
  std::optional<RunOrder> take_first(IsKind is_kind);
  std::size_t find(IsKind is_kind) const;

  std::atomic<bool>& stop_;
  std::atomic<bool> learn_signal_ = false;
  static_assert(std::atomic<bool>::is_always_lock_free);
  mutable std::mutex mutex_;  ///< guards what follows
  std::array<RunOrder, kMost> waiting_;
  std::size_t count_ = 0;  ///< of waiting_, the oldest first
  RunState told_;
};

}  // namespace mixrig::output
