// SPDX-License-Identifier: Apache-2.0
// Pass mix: draws colour with matte, mixed depth, segmented depth and layer at once.
#pragma once

#include "host/render/frame/look_filter.h"
#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/gl/tone_uniforms.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::gles {

/// Inputs of the pass; null if the scene has none.
struct MixInput {
  const Texture* plate = nullptr;
  const Texture* people = nullptr;  ///< KeyPass::blocks(), if there is a matte
  const Texture* visible_w = nullptr;
  const Texture* matte = nullptr;          ///< if there is a background
  const Texture* background_m = nullptr;   ///< if there is a background
  const Texture* learned = nullptr;        ///< the background's colour, if learned
  const Texture* light = nullptr;          ///< if there are shadows
  const Texture* virtual_color = nullptr;  ///< if there are objects
  const Texture* virtual_w = nullptr;
  Rect objects;                    ///< pixels that they may touch
  ToneCurve tone{};                ///< from ExposureMeter
  const Texture* room = nullptr;   ///< KeyPass::room()
  const Texture* noise = nullptr;  ///< make_grain(), if virtual things have noise
  Grain grain{};                   ///< strength of that noise
  glm::ivec2 grain_offset{0};      ///< texel of `noise` at which this frame begins
};

/// Attachments of the pass' targets.
enum MixOutput : int { kMixColor = 0, kMixDepth = 1, kMixSegmented = 2, kMixLayer = 3 };

class MixPass {
 public:
  static Result<MixPass> create(const Tables& tables, const CompositorSetup& setup);
  /// Draws the attachments that hold `wanted` images. Errors: kUnsupported at the first call with
  /// kLayer.
  Result<void> draw(const MixInput& input, OutputMask wanted);
  /// Target of the last draw(), with attachments in the order of MixOutput.
  const Target& target() const { return has_layer_ ? layer_target_ : target_; }
  /// Colour of the last draw() with kColor, GL_SRGB8_ALPHA8; alpha is the matte.
  const Texture& color() const { return color_; }
  const Texture& mixed_m() const { return mixed_; }  ///< of the last draw() with kMixedDepth
  /// Whether parts of the picture may be transparent.
  bool has_alpha() const { return !alpha_.size.empty(); }
  const Target& alpha_target() const { return make_alpha_.target; }

 private:
  Result<void> make_programs(const Tables& tables, const CompositorSetup& setup);
  void draw_blocks(const MixInput& input);

  Texture color_, mixed_, segmented_, layer_, alpha_, backdrop_;
  Texture nobody_;          ///< blocks, where nothing is keyed
  Program program_, room_;  ///< blocks with people or objects, and the others
  Step make_alpha_;
  Target target_, layer_target_;
  bool shows_room_ = false;
  bool has_layer_ = false;
  GLint has_objects_ = -1, alpha_has_objects_ = -1;
  GLint has_light_ = -1, room_has_light_ = -1, wanted_px_ = -1, other_px_ = -1;
  ToneUniforms tone_;
  GLint has_grain_ = -1, grain_offset_ = -1, grain_floor_ = -1, grain_slope_ = -1;
};

}  // namespace mixrig::render::gles
