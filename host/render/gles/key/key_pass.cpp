// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/key/key_pass.h"

#include <cmath>
#include <utility>

namespace mixrig::render::gles {
namespace {

/// Tables::key_limit_w and Tables::hole_behind_w in one texture.
Texture limits_texture(const Tables& tables) {
  Image<glm::vec2> limits(tables.view_size);
  for (int y = 0; y < limits.height(); ++y)
    for (int x = 0; x < limits.width(); ++x)
      limits.row(y)[x] = {tables.key_limit_w.row(y)[x], tables.hole_behind_w.row(y)[x]};
  return make_texture(std::as_const(limits).view(), GL_RG32F);
}

}  // namespace

Result<KeyPass> KeyPass::create(const Tables& tables, LearnedColor learned,
                                const KeyPassParams& params, bool joins) {
  KeyPass pass;
  const Size view = tables.view_size;
  const Size blocks = blocks_of(view);
  const Size tiles{blocks.width * (kBlockPx + 2), blocks.height * (kBlockPx + 2)};
  pass.use_color_ = params.color;
  pass.has_learned_ = learned.there;
  if (!tables.key_limit_w.empty()) pass.limit_w_ = limits_texture(tables);
  pass.state_image_ = make_texture(view, GL_R8);
  for (Texture* image : {&pass.counts_, &pass.colors_, &pass.kept_counts_, &pass.kept_colors_,
                         &pass.band_, &pass.person_, &pass.rooms_, &pass.kept_rooms_, &pass.room_,
                         &pass.deep_, &pass.person_deep_})
    *image = make_texture(blocks, GL_RGBA32F);
  pass.has_light_ = params.color && learned.there && !tables.key_limit_w.empty();
  if (pass.has_light_)
    for (Texture* image : {&pass.found_light_, &pass.light_})
      *image = make_texture(blocks, GL_RGBA32F);
  pass.refine_ = params.color && params.refine;
  if (pass.refine_) {
    const int px = matte_tile_px(tables.tof_footprint_px);
    const Size matte_tiles{(view.width + px - 1) / px, (view.height + px - 1) / px};
    for (Texture* image : {&pass.tile_counts_, &pass.tile_with_p_, &pass.tile_squares_,
                           &pass.tile_products_, &pass.lines_, &pass.people_})
      *image = make_texture(matte_tiles, GL_RGBA32F);
  }
  pass.voted_ = make_texture(view, GL_R8);
  if (pass.use_color_) pass.votes_ = make_texture(tiles, GL_R32F);
  MIXRIG_TRY(pass.make_steps());
  MIXRIG_TRY(pass.make_finish(tables, joins));
  pass.set_constants(params, learned.with_spread);
  if (pass.refine_) pass.sum_tiles_.program.set("tile_px", matte_tile_px(tables.tof_footprint_px));
  pass.set_view(tables);
  return pass;
}

Result<void> KeyPass::make_steps() {
  MIXRIG_ASSIGN(state_, make_step("key_state.frag", {&state_image_}));
  MIXRIG_ASSIGN(blocks_, make_step("key_blocks.frag", {&counts_, &colors_, &rooms_}));
  MIXRIG_ASSIGN(speckles_,
                make_step("key_speckles.frag", {&kept_counts_, &kept_colors_, &kept_rooms_}));
  MIXRIG_ASSIGN(find_deep_, make_step("key_deep.frag", {&deep_}));
  MIXRIG_ASSIGN(find_band_, make_step("key_band.frag", {&band_, &person_, &room_, &person_deep_}));
  if (has_light_) {
    MIXRIG_ASSIGN(find_light_, make_step("key_room_light.frag", {&found_light_}));
    MIXRIG_ASSIGN(mean_light_, make_step("key_light.frag", {&light_}));
  }
  MIXRIG_ASSIGN(fill_, make_step("key_fill.frag", {&voted_}));
  if (use_color_) {
    MIXRIG_ASSIGN(vote_, make_block_step("key_votes.frag", {&votes_}, kVotes, kBlockPx + 2));
  }
  MIXRIG_ASSIGN(decide_, make_block_step("key_decide.frag", {&voted_}, kVotes, kBlockPx));
  if (refine_) {
    MIXRIG_ASSIGN(sum_tiles_, make_step("key_tiles.frag", {&tile_counts_, &tile_with_p_,
                                                           &tile_squares_, &tile_products_}));
    MIXRIG_ASSIGN(fit_, make_step("key_lines.frag", {&lines_, &people_}));
  }
  return {};
}

/// Makes the last step, which draws matte and visible depth.
Result<void> KeyPass::make_finish(const Tables& tables, bool joins) {
  visible_w_ = make_texture(tables.view_size, GL_R32F);
  for (std::size_t i = 0; i < (joins ? 2U : 1U); ++i) {
    mattes_[i] = make_texture(tables.view_size, GL_R8);
    MIXRIG_ASSIGN(finished_[i], make_target({&mattes_[i], &visible_w_}));
  }
  MIXRIG_ASSIGN(copy_, make_program("fullscreen.vert", "key_copy.frag"));
  MIXRIG_ASSIGN(finish_, make_block_program("key_matte.frag", tables.view_size, kVotes, kBlockPx));
  finish_.set("tile_px", matte_tile_px(tables.tof_footprint_px));
  finish_.set("reach_px", static_cast<int>(std::lround(tables.tof_footprint_px)));
  return {};
}

void KeyPass::set_view(const Tables& tables) const {
  const float footprint = tables.tof_footprint_px;
  state_.program.set("focal_px", tables.warp.view.focal_px);
  state_.program.set("center_px", tables.warp.view.center_px);
  finish_.set("parallax_px_m", parallax_px_m(tables.warp));
  speckles_.program.set("tof_px", footprint * footprint);
  decide_.program.set("tap_px", glm::ivec2(std::lround(0.5F * footprint), std::lround(footprint)));
}

void KeyPass::set_constants(const KeyPassParams& params, bool has_sigma) {
  state_.program.set("crop", params.crop);
  state_.program.set("crop_min_m", params.crop_min_m);
  state_.program.set("crop_max_m", params.crop_max_m);
  if (use_color_) {
    vote_.program.set("has_sigma", has_sigma);
    vote_.program.set("has_learned", has_learned_);
    vote_.program.set("is_still", has_light_);
    tone_ = ToneUniforms(vote_.program);
  }
  decide_.program.set("use_color", use_color_);
  decide_.program.set("is_still", has_light_);
  for (const Step* step : {&blocks_, &speckles_})
    step->program.set("needs_room", use_color_ && !has_learned_);
  finish_.set("refine", refine_);
  finish_.set("has_light", has_light_);
  if (has_light_) {
    find_light_.program.set("has_sigma", has_sigma);
    light_tone_ = ToneUniforms(find_light_.program);
  }
  finish_.set("has_learned", has_learned_);
  matte_tone_ = ToneUniforms(finish_);
  has_before_ = finish_.location("has_before");
  state_.program.set("by_volume", params.by == KeyBy::kVolume);
  state_.program.set("noise_factor", params.noise_factor);
  state_.program.set("noise_floor_m", params.noise.floor_m);
  state_.program.set("noise_linear", params.noise.linear);
  state_.program.set("noise_quadratic_per_m", params.noise.quadratic_per_m);
  floor_w_ = state_.program.location("floor_w");
  world_from_camera_ = state_.program.location("world_from_camera");
}

void KeyPass::draw(const KeyPassParams& params, const KeyInput& input) const {
  const Texture& limit_w = input.limit_w ? *input.limit_w : limit_w_;
  state_.program.use();
  set_uniform(world_from_camera_, params.world_from_camera);
  set_uniform(floor_w_, params.floor_w);
  run(state_, {&input.w, &limit_w});
  run(blocks_, {&state_image_, &input.w, &input.plate});
  run(speckles_, {&counts_, &colors_, &rooms_});
  run(find_deep_, {&kept_counts_, &kept_colors_});
  run(find_band_, {&kept_counts_, &kept_colors_, &kept_rooms_, &deep_});
  run(fill_, {&band_});
  if (has_light_) {
    find_light_.program.use();
    light_tone_.set(input.tone);
    run(find_light_,
        {&band_, &state_image_, &kept_counts_, &input.plate, &input.learned, &input.learned_sigma});
    run(mean_light_, {&band_, &found_light_});
  }
  if (use_color_) {
    vote_.program.use();
    tone_.set(input.tone);
    run_blocks(vote_, band_,
               {&input.plate, &input.learned, &input.learned_sigma, &band_, &person_, &room_,
                nullptr, &person_deep_, has_light_ ? &light_ : nullptr});
  }
  run_blocks(decide_, band_, {&state_image_, &kept_counts_, &band_, &votes_});
  if (refine_) {
    run(sum_tiles_, {&input.plate, &voted_, &band_});
    run(fit_, {&tile_counts_, &tile_with_p_, &tile_squares_, &tile_products_});
  }
  run_into(finished_[now_], copy_, {&band_, &input.w});
  finish_.use();
  matte_tone_.set(input.tone);
  set_uniform(has_before_, input.plate_before != nullptr);
  run_blocks_into(
      finished_[now_], finish_, band_,
      {&voted_, &band_, &state_image_, &kept_counts_, &input.plate, refine_ ? &lines_ : nullptr,
       &input.w, refine_ ? &people_ : nullptr, refine_ ? &input.learned : nullptr,
       input.plate_before, input.plate_before ? &mattes_[1 - now_] : nullptr,
       has_light_ ? &light_ : nullptr});
}

}  // namespace mixrig::render::gles
