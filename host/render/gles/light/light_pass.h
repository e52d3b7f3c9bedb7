// SPDX-License-Identifier: Apache-2.0
// Pass light: light map of the real surfaces, shading of the virtual ones.
#pragma once

#include <array>

#include "host/render/gles/gl/gl_step.h"
#include "host/render/gles/virtual/virtual_pass.h"

namespace mixrig::render::gles {

class LightPass {
 public:
  /// `background_m` is kept by the caller. Errors: kUnsupported for more than kMostLamps.
  static Result<LightPass> create(const Tables& tables, const CompositorSetup& setup);

  /// Another view of the same size.
  void set_view(const Tables& tables) const;
  /// What the real room hides of the lamps, where the frame says room_changed. Errors:
  /// kUnsupported.
  Result<void> set_room(const FrameParams& params);
  /// What the objects hide of the ambient light. Once.
  void set_contacts(const FrameParams& params);
  /// Lamps and maps (ShadowPass) of this pose.
  void set_lamps(const FrameParams& params);
  /// Light of the empty room, after a change of pose. `background_m`: z, GL_R32F.
  /// `normal`: of this frame; null: that of the take.
  void draw_background(const Texture& background_m, GLuint shadow_maps,
                       const Texture* normal = nullptr) const;
  /// No real background is shown: its light is 1.
  void skip_background() const;
  /// Shaded virtual colour from the samples of VirtualPass, after a change of pose; in each frame
  /// where people cast shadows: `people_maps` of PeopleShadowPass, else 0.
  void shade_virtual(const FrameParams& params, const VirtualPass& samples, GLuint shadow_maps,
                     GLuint people_maps = 0) const;
  /// What of people's light is found from: blocks, matte and visible_w of KeyPass.
  struct People {
    const Texture& blocks;
    const Texture& matte;
    const Texture& visible_w;
  };
  /// What people hide of the background: as of draw_background(); maps 0: nothing.
  struct PastPeople {
    GLuint maps = 0;  ///< of PeopleShadowPass
    const Texture* background_m = nullptr;
    const Texture* normal = nullptr;
  };
  /// Light of the visible surfaces.
  void draw_people(const People& people, GLuint shadow_maps, const PastPeople& past) const;

  const Texture& background_light() const { return background_light_; }  ///< GL_R16F
  const Texture& light() const { return light_; }                        ///< GL_R16F
  const Target& light_target() const { return people_.target; }
  /// Linear, premultiplied by the coverage in alpha, GL_RGBA16F; its w is GL_R32F.
  const Texture& virtual_color() const { return virtual_color_; }
  const Texture& virtual_w() const { return virtual_w_; }

 private:
  void bind_lamps(GLuint shadow_maps) const;
  void bind_people(GLuint maps) const;
  void place_contacts(const FrameParams& params) const;
  void copy_background() const;
  std::array<const Step*, 4> lit_steps() const {
    return {&background_, &past_people_, &tiles_, &shade_};
  }

  Texture normal_, background_light_, tile_w_, tile_light_, light_, virtual_color_, virtual_w_;
  Step background_, past_people_, tile_depth_, tiles_, people_, shade_;
  BufferHandle lamps_, people_lamps_;
  TextureHandle room_, contacts_;
  GLint shade_origin_px_ = -1, shade_size_px_ = -1, has_people_ = -1, glossy_ = -1, emits_ = -1;
};

}  // namespace mixrig::render::gles
