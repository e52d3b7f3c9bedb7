// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/light/light_pass.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>

#include "host/render/contract/lobe.h"
#include "host/render/gles/gl/gl_convention.h"
#include "host/render/gles/key/key_pass.h"

namespace mixrig::render::gles {
namespace {

constexpr int kMapUnit = 7;        // of common/lamps.glsl
constexpr int kPeopleMapUnit = 6;  // of common/lamps.glsl
constexpr int kRoomUnit = 5;       // of common/lamps.glsl
constexpr int kContactUnit = 8;    // of common/contact.glsl

/// A lamp in the layout of common/lamps.glsl's uniform block (std140).
struct GpuLamp {
  glm::mat4 lamp_from_camera;
  glm::vec4 position_m, direction, intensity, panel_u, panel_v;
  float radius_m, map_focal_texel, map_center_texel, casters_near_m;
  glm::ivec4 map_size_texel;
};
static_assert(sizeof(GpuLamp) == 11 * sizeof(glm::vec4));

GpuLamp to_gpu(const LampParams& lamp) {
  return {lamp.lamp_from_camera,
          glm::vec4(lamp.position_m, 1),
          glm::vec4(lamp.direction, 0),
          glm::vec4(lamp.intensity, 0),
          glm::vec4(lamp.panel_u, 0),
          glm::vec4(lamp.panel_v, 0),
          lamp.radius_m,
          lamp.map_focal_texel,
          lamp.map_center_texel,
          lamp.casters_near_m,
          glm::ivec4(lamp.map_size_texel, lamp.room_layer, lamp.part_of, lamp.is_part)};
}

constexpr std::size_t kLampBytes = kMostLamps * sizeof(GpuLamp);

/// Makes a uniform buffer for the lamps with their maps of objects, then of people, and for
/// RoomShadeParams::cell_from_camera.
BufferHandle make_lamps() {
  GLuint name = 0;
  glGenBuffers(1, &name);
  glBindBuffer(GL_UNIFORM_BUFFER, name);
  glBufferData(GL_UNIFORM_BUFFER, 2 * kLampBytes + sizeof(glm::mat4), nullptr, GL_DYNAMIC_DRAW);
  return BufferHandle(name);
}

/// Writes lamps to the bound uniform buffer.
void upload(const std::vector<LampParams>& from, std::size_t at) {
  if (from.empty()) return;
  std::array<GpuLamp, kMostLamps> lamps;
  std::transform(from.begin(), from.end(), lamps.begin(), to_gpu);
  glBufferSubData(GL_UNIFORM_BUFFER, static_cast<GLintptr>(at),
                  static_cast<GLsizeiptr>(from.size() * sizeof(GpuLamp)), lamps.data());
}

}  // namespace

Result<LightPass> LightPass::create(const Tables& tables, const CompositorSetup& setup) {
  if (setup.light.lamps.size() > std::size_t{kMostLamps})
    return Error{ErrorCode::kUnsupported,
                 fmt::format("the gles back end draws at most {} lamps, the scene has {}: use "
                             "--backend cpu",
                             kMostLamps, setup.light.lamps.size())};
  LightPass pass;
  const Size view = tables.view_size;
  if (!tables.background_normal.empty())
    pass.normal_ = make_texture(tables.background_normal.view(), GL_RGBA8_SNORM);
  pass.background_light_ = make_texture(view, GL_R16F);
  pass.light_ = make_texture(view, GL_R16F);
  const Size tiles{(view.width + kLightTilePx - 1) / kLightTilePx,
                   (view.height + kLightTilePx - 1) / kLightTilePx};
  pass.tile_w_ = make_texture(tiles, GL_R32F);
  pass.tile_light_ = make_texture(tiles, GL_R32F);
  pass.virtual_color_ = make_texture(view, GL_RGBA16F);
  pass.virtual_w_ = make_texture(view, GL_R32F);
  MIXRIG_ASSIGN(pass.background_, make_step("light_background.frag", {&pass.background_light_}));
  pass.taken_ = make_texture(blocks_of(view), GL_R8);
  MIXRIG_ASSIGN(pass.find_taken_, make_step("light_blocks.frag", {&pass.taken_}));
  pass.hides_ = make_texture(view, GL_R8);
  MIXRIG_ASSIGN(pass.hidden_, make_block_step("light_hidden.frag", {&pass.hides_}, 1, kBlockPx));
  MIXRIG_ASSIGN(pass.past_people_,
                make_block_step("light_past_people.frag", {&pass.light_}, 1, kBlockPx));
  MIXRIG_ASSIGN(pass.tile_depth_, make_step("light_tile_w.frag", {&pass.tile_w_}));
  MIXRIG_ASSIGN(pass.tiles_, make_step("light_tiles.frag", {&pass.tile_light_}));
  MIXRIG_ASSIGN(pass.people_,
                make_block_step("light_people.frag", {&pass.light_}, kMayShowPeople, kBlockPx));
  MIXRIG_ASSIGN(pass.shade_,
                make_step("shade_virtual.frag", {&pass.virtual_color_, &pass.virtual_w_}));
  pass.shade_.program.use();
  glUniform1fv(pass.shade_.program.location("lobe_losses"), kLobeLoss.size(), kLobeLoss.data());
  glUniform1fv(pass.shade_.program.location("lobe_grazings"), kLobeGrazing.size(),
               kLobeGrazing.data());
  pass.set_view(tables);
  pass.shade_origin_px_ = pass.shade_.program.location("origin_px");
  pass.shade_size_px_ = pass.shade_.program.location("size_px");
  pass.has_people_ = pass.shade_.program.location("has_people");
  pass.glossy_ = pass.shade_.program.location("glossy");
  pass.emits_ = pass.shade_.program.location("emits");
  pass.lamps_ = make_lamps();
  return pass;
}

void LightPass::set_view(const Tables& tables) const {
  for (const Step* step : lit_steps()) {
    step->program.set("focal_px", tables.warp.view.focal_px);
    step->program.set("center_px", tables.warp.view.center_px);
  }
  tiles_.program.set("reach", normal_reach_tiles(tables.tof_footprint_px));
}

void LightPass::set_lamps(const FrameParams& params) {
  glBindBuffer(GL_UNIFORM_BUFFER, lamps_.get());
  upload(params.lamps, 0);
  upload(params.people_lamps, kLampBytes);
  if (!params.room_share.empty())
    glBufferSubData(GL_UNIFORM_BUFFER, 2 * kLampBytes, sizeof(glm::mat4),
                    &params.room.cell_from_camera);
  place_contacts(params);
  for (const Step* step : lit_steps()) {
    step->program.set("ambient", params.light.ambient);
    step->program.set("lamp_count", static_cast<int>(params.lamps.size()));
  }
  shade_.program.set("exposure", params.light.exposure);
  shade_.program.set("by_direction", params.light.by_direction);
  if (!params.light.by_direction) return;
  shade_.program.set("ambient_terms", std::span<const glm::vec3>(params.light.ambient_terms));
  shade_.program.set("world_from_camera", params.light.world_from_camera);
}

Result<void> LightPass::set_room(const FrameParams& params) {
  if (params.room_share.empty()) return {};
  const glm::ivec3 cells = params.room.cells;
  const auto layers = static_cast<GLint>(params.room_share.size()) / (cells.x * cells.y * cells.z);
  GLint most = 0;
  glGetIntegerv(GL_MAX_3D_TEXTURE_SIZE, &most);
  if (std::max({cells.x, cells.y, cells.z * layers}) > most)
    return Error{
        ErrorCode::kUnsupported,
        fmt::format("the OpenGL ES driver has 3D textures of {} texels, the shadows of the "
                    "room need {}: use --backend cpu or fewer lamps",
                    most, std::max({cells.x, cells.y, cells.z * layers}))};
  GLuint name = 0;
  glGenTextures(1, &name);
  room_ = TextureHandle(name);
  glBindTexture(GL_TEXTURE_3D, name);
  glTexStorage3D(GL_TEXTURE_3D, 1, GL_R16F, cells.x, cells.y, cells.z * layers);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, cells.x, cells.y, cells.z * layers, GL_RED, GL_FLOAT,
                  params.room_share.data());
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const Step* step : lit_steps()) {
    step->program.set("room_cells", cells);
    step->program.set("room_lift_m", params.room.lift_m);
  }
  return {};
}

void LightPass::set_contacts(const FrameParams& params) {
  for (const Step* step : lit_steps())
    step->program.set("contact_count", static_cast<int>(params.contacts.size()));
  if (params.contacts.empty()) return;
  constexpr int kNodes = kContactNodes;
  const int count = static_cast<int>(params.contacts.size());
  // First the rows of `up` of a plane, then those of `down`.
  std::vector<std::array<std::uint8_t, 4>> texels;
  texels.reserve(2 * params.contact_hidden.size());
  for (std::size_t first = 0; first < params.contact_hidden.size(); first += kNodes * kNodes) {
    const auto plane = params.contact_hidden.subspan(first, kNodes * kNodes);
    for (const HiddenShares& shares : plane) texels.push_back(shares.up);
    for (const HiddenShares& shares : plane) texels.push_back(shares.down);
  }
  GLuint name = 0;
  glGenTextures(1, &name);
  contacts_ = TextureHandle(name);
  glBindTexture(GL_TEXTURE_3D, name);
  glTexStorage3D(GL_TEXTURE_3D, 1, GL_RGBA8, kNodes, 2 * kNodes, kNodes * count);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
  glTexSubImage3D(GL_TEXTURE_3D, 0, 0, 0, 0, kNodes, 2 * kNodes, kNodes * count, GL_RGBA,
                  GL_UNSIGNED_BYTE, texels.data());
  for (const GLenum axis : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T, GL_TEXTURE_WRAP_R})
    glTexParameteri(GL_TEXTURE_3D, axis, GL_CLAMP_TO_EDGE);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_3D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
}

/// Sets the objects' transforms of this frame, and the light that they send.
void LightPass::place_contacts(const FrameParams& params) const {
  const std::size_t count = params.contacts.size();
  if (count == 0) return;
  std::array<glm::mat4, kMostContacts> from_camera;
  std::array<glm::vec3, kMostContacts> low_m, high_m;
  std::array<float, kMostContacts> reach_m{};
  std::array<glm::vec3, std::size_t{6} * kMostContacts> sent;
  for (std::size_t i = 0; i < count; ++i) {
    const ContactParams& p = params.contacts[i];
    from_camera[i] = p.object_from_camera;
    low_m[i] = p.low_m, high_m[i] = p.high_m, reach_m[i] = p.reach_m;
    std::copy(p.sent.begin(), p.sent.end(), sent.begin() + static_cast<std::ptrdiff_t>(6 * i));
  }
  for (const Step* step : lit_steps()) {
    const Program& program = step->program;
    program.set("object_from_camera", std::span<const glm::mat4>(from_camera).first(count));
    program.set("contact_low_m", std::span<const glm::vec3>(low_m).first(count));
    program.set("contact_high_m", std::span<const glm::vec3>(high_m).first(count));
    program.set("contact_reach_m", std::span<const float>(reach_m).first(count));
    program.set("contact_sent", std::span<const glm::vec3>(sent).first(6 * count));
  }
}

void LightPass::bind_lamps(GLuint shadow_maps) const {
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, lamps_.get());
  glActiveTexture(GL_TEXTURE0 + kMapUnit);
  glBindTexture(GL_TEXTURE_2D_ARRAY, shadow_maps);
  glActiveTexture(GL_TEXTURE0 + kRoomUnit);
  glBindTexture(GL_TEXTURE_3D, room_.get());
  glActiveTexture(GL_TEXTURE0 + kContactUnit);
  glBindTexture(GL_TEXTURE_3D, contacts_.get());
}

void LightPass::draw_background(const Texture& background_m, GLuint shadow_maps,
                                const Texture* normal) const {
  bind_lamps(shadow_maps);
  run(background_, {&background_m, normal ? normal : &normal_});
  run(find_taken_, {&background_light_});
}

void LightPass::skip_background() const {
  bind(background_.target);
  glClearColor(1, 1, 1, 1);
  glClear(GL_COLOR_BUFFER_BIT);
  run(find_taken_, {&background_light_});
}

void LightPass::shade_virtual(const FrameParams& params, const VirtualPass& samples,
                              GLuint shadow_maps, GLuint people_maps) const {
  const Rect& rect = params.virtual_rect;
  bind(shade_.target);
  glClearColor(0, 0, 0, 0);
  glClear(GL_COLOR_BUFFER_BIT);
  if (rect.empty()) return;
  shade_.program.use();
  set_uniform(shade_origin_px_, glm::ivec2(rect.x0, rect.y0));
  set_uniform(shade_size_px_, glm::ivec2(rect.x1 - rect.x0, rect.y1 - rect.y0));
  set_uniform(has_people_, people_maps != 0);
  set_uniform(glossy_, params.glossy && samples.gloss() != nullptr);
  set_uniform(emits_, params.emits && samples.emission() != nullptr);
  bind_people(people_maps);
  bind_lamps(shadow_maps);
  glEnable(GL_SCISSOR_TEST);
  glScissor(rect.x0, rect.y0, rect.x1 - rect.x0, rect.y1 - rect.y0);
  run_over(shade_, {&samples.albedo(), &samples.normal(), &samples.depth(), samples.gloss(),
                    samples.emission()});
  glDisable(GL_SCISSOR_TEST);
}

void LightPass::bind_people(GLuint maps) const {
  glActiveTexture(GL_TEXTURE0 + kPeopleMapUnit);
  glBindTexture(GL_TEXTURE_2D_ARRAY, maps);
}

/// Copies the light of the empty room to the light of the visible surfaces.
void LightPass::copy_background() const {
  const Size size = light_.size;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, background_.target.handle.get());
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, people_.target.handle.get());
  glBlitFramebuffer(0, 0, size.width, size.height, 0, 0, size.width, size.height,
                    GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

void LightPass::draw_people(const People& people, GLuint shadow_maps,
                            const PastPeople& past) const {
  run(tile_depth_, {&people.matte, &people.visible_w});
  bind_lamps(shadow_maps);
  run(tiles_, {&tile_w_});
  copy_background();
  if (past.maps != 0) {
    bind_people(past.maps);
    bind_lamps(shadow_maps);
    const Texture* const normal = past.normal ? past.normal : &normal_;
    run_blocks(hidden_, taken_, {past.background_m, normal, &background_light_});
    run_blocks(past_people_, taken_, {past.background_m, normal, &background_light_, &hides_});
  }
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  run_blocks(people_, people.blocks, {&people.matte, &tile_w_, &tile_light_});
  glDisable(GL_BLEND);
}

}  // namespace mixrig::render::gles
