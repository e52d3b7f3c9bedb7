// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/key/people_key.h"

#include <utility>

namespace mixrig::render::gles {

Result<PeopleKey> PeopleKey::create(const CompositorSetup& setup, const Tables& tables,
                                    LearnedColor learned, const KeyPassParams& params) {
  PeopleKey key(setup.key);
  MIXRIG_ASSIGN(key.pass_, KeyPass::create(tables, learned, params));
  if (!follows_people(setup)) return key;
  key.followed_ = std::make_unique<Followed>(tables);
  Followed& followed = *key.followed_;
  followed.depth_shift_px.reset(followed.motion.cells());
  followed.shift_px = make_texture(followed.depth_shift_px.view(), GL_RG32F);
  followed.motion_px = make_texture(followed.depth_shift_px.view(), GL_RG32F);
  MIXRIG_TRY(key.pass_.follow_people(tables, followed.motion.cell_px(), setup.key.steady));
  return key;
}

void PeopleKey::follow(const FrameInput& input, const Texture& plate) {
  if (!followed_) return;
  const bool moves = key_->motion && input.depth_delay_s != 0;
  if (!moves && !key_->steady) return;
  if (!followed_->motion.see(input, followed_->crew) || !key_->steady) return;
  if (has_now_) pass_.remember(plate);
  has_before_ = std::exchange(has_now_, false);
  if (const Image<glm::vec2>* motion_px = followed_->motion.motion_px())
    upload(followed_->motion_px, motion_px->view());
}

void PeopleKey::draw(const KeyPassParams& params, double depth_delay_s, KeyInput input) {
  if (followed_) {
    Followed& people = *followed_;
    if (key_->motion && people.motion.depth_shift_px(depth_delay_s, people.depth_shift_px)) {
      upload(people.shift_px, people.depth_shift_px.view());
      input.shift_px = &people.shift_px;
    }
    if (key_->steady && has_before_ && people.motion.motion_px() != nullptr)
      input.motion_px = &people.motion_px;
  }
  pass_.draw(params, input);
  has_now_ = true;
}

}  // namespace mixrig::render::gles
