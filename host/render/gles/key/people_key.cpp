// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/key/people_key.h"

#include <utility>

namespace mixrig::render::gles {

Result<PeopleKey> PeopleKey::create(const CompositorSetup& setup, const Tables& tables,
                                    LearnedColor learned, const KeyPassParams& params) {
  PeopleKey key;
  key.joins_ = joins_mattes(setup);
  MIXRIG_ASSIGN(key.pass_, KeyPass::create(tables, learned, params, key.joins_));
  return key;
}

void PeopleKey::follow(const FrameInput& input, PlatePass& plate) {
  if (!joins_ || !order_.see(input)) return;
  plate.swap();
  pass_.swap();
  has_before_ = std::exchange(has_now_, false) && order_.follows();
}

void PeopleKey::draw(const KeyPassParams& params, const PlatePass& plate, KeyInput input) {
  input.plate_before = has_before_ ? &plate.last_in_view() : nullptr;
  pass_.draw(params, input);
  has_now_ = true;
}

}  // namespace mixrig::render::gles
