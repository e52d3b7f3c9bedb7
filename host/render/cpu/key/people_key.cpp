// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/people_key.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace mixrig::render::cpu {

PeopleKey::PeopleKey(const CompositorSetup& setup, const Tables& tables, int threads)
    : tables_(tables),
      scratch_(tables.view_size, tables.tof_footprint_px, threads),
      joins_(joins_mattes(setup)) {
  if (!joins_) return;
  plate_before_.reset(tables.view_size);
  matte_now_.reset(tables.view_size), matte_before_.reset(tables.view_size);
}

void PeopleKey::follow(const FrameInput& input, Image<Rgbx16>& plate) {
  if (!joins_ || !order_.see(input)) return;
  std::swap(plate, plate_before_);
  std::swap(matte_now_, matte_before_);
  has_before_ = std::exchange(has_now_, false) && order_.follows();
}

void PeopleKey::key(Crew& crew, KeyInput input, Image<float>& view_w, Image<std::uint8_t>& matte) {
  const FrameBefore before{plate_before_, matte_before_,
                           static_cast<int>(std::lround(tables_.tof_footprint_px))};
  input.before = has_before_ ? &before : nullptr;
  cpu::key(crew, input, scratch_, view_w, matte);
  if (!joins_) return;
  for (int y = 0; y < matte.height(); ++y)
    std::copy_n(matte.row(y), matte.width(), matte_now_.row(y));
  has_now_ = true;
}

}  // namespace mixrig::render::cpu
