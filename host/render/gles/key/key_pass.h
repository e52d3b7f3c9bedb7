// SPDX-License-Identifier: Apache-2.0
// Pass key: finds people by depth, and by colour where depth is in doubt.
#pragma once

#include <array>

#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/gl/tone_uniforms.h"

namespace mixrig::render::gles {

/// Inputs of the pass.
struct KeyInput {
  const Texture& w;        ///< from WarpPass
  const Texture& plate;    ///< in the view; linear light when sampled
  const Texture& learned;  ///< the background's colour and its sigma, where learned
  const Texture& learned_sigma;
  ToneCurve tone{};                  ///< from ExposureMeter
  const Texture* limit_w = nullptr;  ///< of this frame; null: that of the take
  /// `plate` of the frame before swap(), whose matte is blended in; null: none.
  const Texture* plate_before = nullptr;
};

/// Flags of a block, the same as in key_band.frag.
enum BlockFlags : int { kNear = 1, kBand = 2, kVotes = 4, kHasColor = 8, kMayShowPeople = 16 };

/// Which parts of the background's colour were learned.
struct LearnedColor {
  bool there = false, with_spread = false;
};

class KeyPass {
 public:
  /// With `joins`, swap() keeps a matte. Precondition: params.by is not KeyBy::kNothing. Errors:
  /// those of make_program and make_target.
  static Result<KeyPass> create(const Tables& tables, LearnedColor learned,
                                const KeyPassParams& params, bool joins = false);
  /// Keeps the matte for the next draw(). Precondition: joins.
  void swap() { now_ = 1 - now_; }
  /// Sets another view of the same size.
  void set_view(const Tables& tables) const;
  void draw(const KeyPassParams& params, const KeyInput& input) const;

  const Texture& matte() const { return mattes_[now_]; }  ///< GL_R8
  /// One texel a block of kBlockPx; its first channel holds BlockFlags as a number.
  const Texture& blocks() const { return band_; }
  /// One texel a block: mean colour of the background around, where none was learned, and its
  /// variance, 0 where unknown.
  const Texture& room() const { return room_; }
  const Texture& visible_w() const { return visible_w_; }  ///< GL_R32F, from key_matte.frag
  /// Holds PixelState, with kStateMirrored added where the depth may be a mirror's.
  const Target& state_target() const { return state_.target; }

 private:
  Result<void> make_steps();
  Result<void> make_finish(const Tables& tables, bool joins);
  void set_constants(const KeyPassParams& params, bool has_sigma);

  bool use_color_ = false, has_learned_ = false, refine_ = false;
  bool has_light_ = false;  ///< compares the room's light around people with the learned one
  Texture limit_w_, state_image_, counts_, colors_, rooms_, kept_counts_, kept_colors_, kept_rooms_,
      deep_, band_, person_, room_, person_deep_, votes_, voted_;
  Texture tile_counts_, tile_with_p_, tile_squares_, tile_products_, lines_,
      people_;  ///< one texel a tile
  Texture found_light_, light_;
  std::size_t now_ = 0;
  std::array<Texture, 2> mattes_;  ///< the second one is empty unless swap() needs it
  std::array<Target, 2> finished_;
  Texture visible_w_;
  Program copy_, finish_;  ///< draw into finished_
  Step state_, blocks_, speckles_, find_deep_, find_band_, fill_, vote_, decide_, sum_tiles_, fit_,
      find_light_, mean_light_;
  GLint world_from_camera_ = -1, floor_w_ = -1, has_before_ = -1;
  ToneUniforms tone_, matte_tone_, light_tone_;
};

}  // namespace mixrig::render::gles
