// SPDX-License-Identifier: Apache-2.0
// Newest JPEG picture of each view, between the sink that makes them and the clients.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <string>

#include "hal/base/clock.h"
#include "hal/base/image.h"
#include "host/output/sink/run_orders.h"
#include "host/output/sink/views.h"
#include "host/render/contract/compositor.h"

namespace mixrig::page {

struct Picture {
  std::string jpeg;
  std::uint64_t serial = 0;  ///< 1 for the first of its view
  int frame = 0;             ///< number of the capture
  HostTime mid_exposure{};   ///< of the plate
};
using PicturePtr = std::shared_ptr<const Picture>;

using output::kViews;
using output::View;

/// Receives a picture uncompressed on the sink's thread; must not wait.
using TakePicture = std::function<void(ImageView<const Rgb8>, int frame, HostTime mid_exposure)>;

/// Holds one picture for each view; older ones live while they are being sent. Thread-safe.
class Pictures {
 public:
  /// While the run's pictures are frozen, they stay as they are. `orders` must outlive it.
  explicit Pictures(const output::RunOrders& orders) : orders_(orders) {}

  /// Counts a client that views pictures of a view; they are made only while one does.
  void look(View view) { ++lookers_[index(view)]; }
  void look_away(View view) { --lookers_[index(view)]; }
  bool is_looked_at(View view) const { return lookers_[index(view)] > 0; }
  /// Adds a receiver of a view's pictures, which also looks at the view. Returns its number.
  int add_taker(View view, TakePicture take);
  void set_view(int taker, View view);
  /// Removes a receiver; it is not called afterwards.
  void remove_taker(int taker);
  bool is_wanted(View view) const { return is_looked_at(view) || taken_[index(view)] > 0; }
  /// Images of the compositor that the viewed views need; none while frozen.
  render::OutputMask wanted() const;

  /// Newest picture of a view; null before the first one.
  PicturePtr newest(View view) const;
  void put(View view, std::shared_ptr<Picture> picture);
  /// Gives a picture to the receivers of its view.
  void give(View view, ImageView<const Rgb8> picture, int frame, HostTime mid_exposure) const;
  /// Called on the thread of put(). Must neither wait nor call this object. After
  /// set_on_new({}) it is not called any more.
  void set_on_new(std::function<void(View)> on_new);

  bool frozen() const { return orders_.state().frozen; }

 private:
  static std::size_t index(View view) { return static_cast<std::size_t>(view); }

  struct Taker {
    View view;
    TakePicture take;
  };

  std::array<std::atomic<int>, kViews> lookers_{}, taken_{};
  const output::RunOrders& orders_;
  mutable std::mutex mutex_;  ///< guards the members below
  std::array<PicturePtr, kViews> newest_;
  std::function<void(View)> on_new_;
  mutable std::mutex takers_mutex_;  ///< guards the members below
  std::map<int, Taker> takers_;
  int next_taker_ = 0;
};

}  // namespace mixrig::page
