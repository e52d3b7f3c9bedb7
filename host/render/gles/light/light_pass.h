// SPDX-License-Identifier: Apache-2.0
// Pass light: draws the light map of real surfaces and shades virtual ones.
#pragma once

#include <array>

#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/virtual/virtual_pass.h"

namespace mixrig::render::gles {

class LightPass {
 public:
  /// Errors: kUnsupported for more than kMostLamps lamps.
  static Result<LightPass> create(const Tables& tables, const CompositorSetup& setup);

  /// Sets another view of the same size.
  void set_view(const Tables& tables) const;
  /// Uploads what the real room hides of the lamps, if params.room_changed. Errors: kUnsupported.
  Result<void> set_room(const FrameParams& params);
  /// Uploads the ambient light that objects hide. Called once.
  void set_contacts(const FrameParams& params);
  /// Sets lamps and maps (ShadowPass) of this pose.
  void set_lamps(const FrameParams& params);
  /// Draws the light of the empty room, after a change of pose. `background_m`: z, GL_R32F.
  /// `normal`: normals of this frame; null: those of the take.
  void draw_background(const Texture& background_m, GLuint shadow_maps,
                       const Texture* normal = nullptr) const;
  /// Sets the background's light to 1, where no real background is shown.
  void skip_background() const;
  /// Shades virtual surfaces by the samples of VirtualPass: after a change of pose, and in each
  /// frame if people cast shadows. `people_maps`: of PeopleShadowPass, else 0.
  void shade_virtual(const FrameParams& params, const VirtualPass& samples, GLuint shadow_maps,
                     GLuint people_maps = 0) const;
  /// Images of KeyPass from which people's light is computed.
  struct People {
    const Texture& blocks;
    const Texture& matte;
    const Texture& visible_w;
  };
  /// Inputs for shadows of people on the background; maps 0: none.
  struct PastPeople {
    GLuint maps = 0;  ///< of PeopleShadowPass
    const Texture* background_m = nullptr;
    const Texture* normal = nullptr;
  };
  /// Draws the light map of the visible real surfaces.
  void draw_people(const People& people, GLuint shadow_maps, const PastPeople& past) const;

  const Texture& background_light() const { return background_light_; }  ///< GL_R16F
  const Texture& light() const { return light_; }                        ///< GL_R16F
  const Target& light_target() const { return people_.target; }
  /// Linear colour premultiplied by the coverage in alpha, GL_RGBA16F; virtual_w() is GL_R32F, 1/m.
  const Texture& virtual_color() const { return virtual_color_; }
  const Texture& virtual_w() const { return virtual_w_; }

 private:
  void bind_lamps(GLuint shadow_maps) const;
  void bind_people(GLuint maps) const;
  void place_contacts(const FrameParams& params) const;
  void copy_background() const;
  std::array<const Step*, 5> lit_steps() const {
    return {&background_, &hidden_, &past_people_, &tiles_, &shade_};
  }

  Texture normal_, background_light_, taken_, hides_, tile_w_, tile_light_, light_;
  Texture virtual_color_, virtual_w_;
  Step background_, find_taken_, hidden_, past_people_, tile_depth_, tiles_, people_, shade_;
  BufferHandle lamps_;
  TextureHandle room_, contacts_;
  GLint shade_origin_px_ = -1, shade_size_px_ = -1, has_people_ = -1, glossy_ = -1, emits_ = -1;
};

}  // namespace mixrig::render::gles
