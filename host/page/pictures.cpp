// SPDX-License-Identifier: Apache-2.0
#include "host/page/pictures.h"

#include <utility>

namespace mixrig::page {

render::OutputMask Pictures::wanted() const {
  if (frozen_) return 0;
  // The plate comes with every composite.
  constexpr std::array<render::OutputMask, kViews> kNeeds{render::kColor, render::kMatte,
                                                          render::kState, render::kMixedDepth,
                                                          render::kLight, render::kMatte};
  render::OutputMask mask = 0;
  for (std::size_t i = 0; i < kViews; ++i)
    if (lookers_[i] > 0) mask |= kNeeds[i];
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

void Pictures::set_on_new(std::function<void(View)> on_new) {
  const std::lock_guard lock(mutex_);
  on_new_ = std::move(on_new);
}

}  // namespace mixrig::page
