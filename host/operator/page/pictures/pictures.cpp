// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/pictures/pictures.h"

#include <utility>

namespace mixrig::page {

render::OutputMask Pictures::wanted() const {
  if (frozen()) return 0;
  // The plate comes with every composite.
  constexpr std::array<render::OutputMask, kViews> kNeeds{render::kColor, render::kMatte,
                                                          render::kState, render::kMixedDepth,
                                                          render::kLight, render::kMatte};
  render::OutputMask mask = 0;
  for (std::size_t i = 0; i < kViews; ++i)
    if (is_wanted(static_cast<View>(i))) mask |= kNeeds[i];
  return mask;
}

PicturePtr Pictures::newest(View view) const {
  const std::lock_guard lock(mutex_);
  return newest_[index(view)];
}

void Pictures::put(View view, std::shared_ptr<Picture> picture) {
  const std::lock_guard lock(mutex_);
  PicturePtr& newest = newest_[index(view)];
  picture->serial = newest ? newest->serial + 1 : 1;
  newest = std::move(picture);
  if (on_new_) on_new_(view);
}

int Pictures::add_taker(View view, TakePicture take) {
  const std::lock_guard lock(takers_mutex_);
  ++taken_[index(view)];
  takers_.emplace(next_taker_, Taker{view, std::move(take)});
  return next_taker_++;
}

void Pictures::set_view(int taker, View view) {
  const std::lock_guard lock(takers_mutex_);
  const auto found = takers_.find(taker);
  if (found == takers_.end()) return;
  --taken_[index(std::exchange(found->second.view, view))];
  ++taken_[index(view)];
}

void Pictures::remove_taker(int taker) {
  const std::lock_guard lock(takers_mutex_);
  const auto found = takers_.find(taker);
  if (found == takers_.end()) return;
  --taken_[index(found->second.view)];
  takers_.erase(found);
}

void Pictures::give(View view, ImageView<const Rgb8> picture, int frame,
                    HostTime mid_exposure) const {
  const std::lock_guard lock(takers_mutex_);
  for (const auto& [number, taker] : takers_)
    if (taker.view == view) taker.take(picture, frame, mid_exposure);
}

void Pictures::set_on_new(std::function<void(View)> on_new) {
  const std::lock_guard lock(mutex_);
  on_new_ = std::move(on_new);
}

}  // namespace mixrig::page
