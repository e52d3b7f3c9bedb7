// SPDX-License-Identifier: Apache-2.0
// Orders that an operator gives to a run (keys, signals, page, OSC), and the state that the run
// reports. One object a run, so that each control shows what the others have changed.
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

/// Ends the run with the frames done so far.
struct StopRun {};
/// Selects the view that is shown; files are not affected.
struct ShowView {
  View view = View::kComposite;
};
/// Freezes or resumes the pictures that are shown.
struct FreezePictures {
  bool on = false;
};
/// Starts or stops recording; see RunState::recording.
struct Record {
  bool on = false;
};
/// Makes the changes found in the room part of the background.
struct LearnChanges {};
/// Begins kScanLooks captures of the empty room, or cancels them without a result.
struct LearnRoom {
  bool on = false;
};
/// Focuses on the depth seen at this pixel of the view.
struct FocusAt {
  glm::ivec2 pixel{0, 0};
};
/// Places an object (index from 0) on the surface seen at a pixel of the view.
struct PlaceObject {
  int object = 0;
  glm::ivec2 pixel{0, 0};
};
using RunOrder = std::variant<StopRun, ShowView, FreezePictures, Record, LearnChanges, LearnRoom,
                              FocusAt, PlaceObject>;

/// Captures of the empty room before it replaces the background.
inline constexpr int kScanLooks = 24;

/// Result of an order to place an object.
enum class Placement : std::uint8_t { kPlaced, kNoSurface, kFailed };
std::string_view text(Placement placement);

/// State that a run reports.
struct RunState {
  View view = View::kComposite;
  bool frozen = false;
  /// Whether frames are written to the run's files or, with `records_takes`, whether a take is
  /// being recorded.
  bool recording = true;
  bool records_takes = false;
  int scan_left = 0;  ///< captures of the empty room still to be taken; 0: none in progress
  std::optional<glm::ivec2> focus_px;     ///< set by an operator; absent: as in the scene
  int objects = 0;                        ///< number that can be placed
  std::uint32_t placements = 0;           ///< number of orders to place that were handled
  Placement placed = Placement::kPlaced;  ///< result of the last of them
  bool can_learn = false;                 ///< LearnChanges is possible: the background is watched
  bool can_scan = false;    ///< LearnRoom is possible: the background is a single view
  bool can_record = false;  ///< Record is possible: there is a folder to write to
  bool can_focus = false;   ///< FocusAt is possible: the scene has a [focus]
};

/// Thread-safe. The lock is held for a copy only, and only errors allocate. It must outlive the run
/// and its sinks.
class RunOrders {
 public:
  static constexpr std::size_t kMost = 16;  ///< orders that may wait

  /// `stop` ends the run and its devices; it must outlive this object.
  explicit RunOrders(std::atomic<bool>& stop) : stop_(stop) {}

  /// Gives an order. StopRun, ShowView and FreezePictures take effect at once; the others wait
  /// until the thread that handles them takes them at a frame. Precondition: state() says that the
  /// run can do it. Errors: kData if kMost orders wait; the order is then dropped.
  Result<void> give(const RunOrder& order);
  /// Gives LearnChanges; may be called in a signal handler.
  void learn_by_signal() { learn_signal_ = true; }

  /// Takes the oldest waiting order of one kind; only one thread takes each kind.
  template <typename Order>
  std::optional<Order> take() {
    if constexpr (std::is_same_v<Order, LearnChanges>)
      if (learn_signal_.exchange(false)) return LearnChanges{};
    const std::optional<RunOrder> order = take_first(is<Order>);
    return order ? std::optional<Order>(std::get<Order>(*order)) : std::nullopt;
  }
  /// Whether an order of this kind waits.
  template <typename Order>
  bool waits() const {
    const std::lock_guard lock(mutex_);
    return find(is<Order>) < count_;
  }

  /// State as the run reported it last, with waiting orders applied, so that a screen shows at once
  /// what it asked for.
  RunState state() const;
  /// Changes the state: `change(RunState&)` is called under the lock and must only assign values.
  /// Each value has one writer, the thread that handles the orders for it.
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
  mutable std::mutex mutex_;  ///< guards the members below
  std::array<RunOrder, kMost> waiting_;
  std::size_t count_ = 0;  ///< orders in waiting_, the oldest first
  RunState told_;
};

}  // namespace mixrig::output
