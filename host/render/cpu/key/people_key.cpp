// SPDX-License-Identifier: Apache-2.0
#include "host/render/cpu/key/people_key.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "host/render/cpu/key/move_people.h"

namespace mixrig::render::cpu {

PeopleKey::PeopleKey(const CompositorSetup& setup, const Tables& tables, int threads)
    : setup_(setup), tables_(tables), scratch_(tables.view_size, tables.tof_footprint_px, threads) {
  if (!follows_people(setup)) return;
  motion_.emplace(tables);
  depth_shift_px_.reset(motion_->cells());
  if (!setup.key.steady) return;
  plate_before_.reset(tables.view_size);
  matte_now_.reset(tables.view_size), matte_before_.reset(tables.view_size);
}

void PeopleKey::follow(Crew& crew, const FrameInput& input, Image<Rgbx16>& plate) {
  if (!motion_) return;
  const bool moves = setup_.key.motion && input.depth_delay_s != 0;
  if (!moves && !setup_.key.steady) return;
  if (!motion_->see(input, crew) || !setup_.key.steady) return;
  std::swap(plate, plate_before_);
  std::swap(matte_now_, matte_before_);
  has_before_ = std::exchange(has_now_, false);
}

void PeopleKey::key(Crew& crew, double depth_delay_s, KeyInput input, Image<float>& view_w,
                    Image<std::uint8_t>& matte) {
  if (motion_ && setup_.key.motion && motion_->depth_shift_px(depth_delay_s, depth_shift_px_)) {
    if (unmoved_w_.empty()) unmoved_w_.reset(tables_.view_size);
    move_people(crew, tables_.key_limit_w, depth_shift_px_, motion_->cell_px(), unmoved_w_, view_w);
  }
  const std::optional<FrameBefore> frame_before = before();
  input.before = frame_before ? &*frame_before : nullptr;
  cpu::key(crew, input, scratch_, view_w, matte);
  if (!motion_ || !setup_.key.steady) return;
  for (int y = 0; y < matte.height(); ++y)
    std::copy_n(matte.row(y), matte.width(), matte_now_.row(y));
  has_now_ = true;
}

std::optional<FrameBefore> PeopleKey::before() const {
  const bool joins = motion_ && setup_.key.steady && has_before_;
  const Image<glm::vec2>* motion_px = joins ? motion_->motion_px() : nullptr;
  if (motion_px == nullptr) return std::nullopt;
  return FrameBefore{plate_before_, matte_before_, *motion_px, motion_->cell_px(),
                     static_cast<int>(std::lround(tables_.tof_footprint_px))};
}

}  // namespace mixrig::render::cpu
