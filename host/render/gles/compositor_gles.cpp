// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/compositor_gles.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "host/render/exposure.h"
#include "host/render/frame_io.h"
#include "host/render/gles/correct_pass.h"
#include "host/render/gles/egl_context.h"
#include "host/render/gles/gl_mesh.h"
#include "host/render/gles/key_pass.h"
#include "host/render/gles/light_pass.h"
#include "host/render/gles/mix_pass.h"
#include "host/render/gles/plate_pass.h"
#include "host/render/gles/shadow_pass.h"
#include "host/render/gles/stage_timer.h"
#include "host/render/gles/virtual_pass.h"
#include "host/render/gles/warp_pass.h"

namespace mixrig::render {
namespace {

using namespace gles;  // NOLINT(google-build-using-namespace)

class GlesCompositor final : public Compositor {
 public:
  GlesCompositor(EglContext context, const CompositorSetup& setup);
  ~GlesCompositor() override;
  Result<void> create_passes();

  Result<void> compose(const FrameInput& input, FrameOutput& output) override;
  const StageTimes& stage_times() const override { return timer_.times(); }
  std::string renderer() const override { return renderer_; }

 private:
  Result<void> draw_objects();
  void draw_light();
  Result<void> draw_mix(bool inspect);
  void read_outputs(FrameOutput& output);
  void read_inspection(FrameOutput& output);
  bool has_objects() const { return !meshes_.empty(); }
  bool has_light_map() const { return has_shadows_ && tables_.has_background; }

  EglContext context_;  // dies last
  std::string renderer_;
  StageTimer timer_;
  CompositorSetup setup_;
  Tables tables_;
  FramePreparer preparer_;
  ExposureMeter meter_;
  glm::vec3 gain_{1};
  Texture background_m_, learned_, learned_sigma_;
  std::vector<GpuMesh> meshes_;  // as FrameParams::draws
  PlatePass plate_;
  CorrectPass correct_;
  WarpPass warp_;
  VirtualPass virtual_;
  ShadowPass shadow_;
  KeyPass key_;
  LightPass light_;
  MixPass mix_;
  bool has_shadows_ = false;
  Scratch scratch_;
};

GlesCompositor::GlesCompositor(EglContext context, const CompositorSetup& setup)
    : context_(std::move(context)),
      renderer_(context_.renderer()),
      timer_(context_),
      setup_(setup),
      tables_(make_tables(setup_)),
      preparer_(setup_),
      meter_(tables_, setup_.background) {}

// GL names are given back to the context that made them.
GlesCompositor::~GlesCompositor() { (void)context_.make_current(); }

/// Only the passes that the scene needs; their tables go to the GPU here, once.
Result<void> GlesCompositor::create_passes() {
  const BackgroundView& background = setup_.background;
  MIXRIG_ASSIGN(plate_, PlatePass::create(tables_));
  MIXRIG_ASSIGN(correct_, CorrectPass::create(tables_));
  MIXRIG_ASSIGN(warp_, WarpPass::create(tables_));
  if (tables_.has_background) {
    background_m_ = make_texture(background.depth_m, GL_R32F);
    if (!background.color.empty()) learned_ = make_texture(background.color, GL_RGB16F);
    if (!background.color_sigma.empty())
      learned_sigma_ = make_texture(background.color_sigma, GL_R16F);
    MIXRIG_ASSIGN(key_, KeyPass::create(tables_, background, preparer_.params().key));
  }
  for (const Draw& draw : preparer_.params().draws) meshes_.emplace_back(*draw.mesh);
  if (has_objects()) {
    MIXRIG_ASSIGN(virtual_, VirtualPass::create());
    MIXRIG_ASSIGN(light_, LightPass::create(tables_, setup_));
    if (!setup_.light.lamps.empty()) {
      MIXRIG_ASSIGN(shadow_, ShadowPass::create());
    }
  }
  MIXRIG_ASSIGN(mix_, MixPass::create(tables_, setup_));
  if (glGetError() != GL_NO_ERROR)
    return Error{ErrorCode::kUnsupported,
                 "the OpenGL ES driver (" + renderer_ +
                     ") lacks memory or a format for this view: use --backend cpu"};
  // The GPU has them now.
  tables_.tof_ray = tables_.plate_px = {};
  tables_.key_limit_w = {};
  tables_.background_normal = {};
  return {};
}

Result<void> GlesCompositor::compose(const FrameInput& input, FrameOutput& output) {
  MIXRIG_TRY(check_frame(input, tables_));
  MIXRIG_TRY(context_.make_current());
  size_outputs(tables_.view_size, output);
  timer_.begin_frame();
  {
    const StageScope stage(timer_, Stage::kUpload, true);
    preparer_.update(input.world_from_target);
    gain_ = meter_.gain(input.plate);
    plate_.upload_plate(input.plate);
    correct_.upload_depth(input.tof_depth_m);
  }
  if (plate_.draws()) {
    const StageScope stage(timer_, Stage::kPlate);
    plate_.draw();
  }
  {
    const StageScope stage(timer_, Stage::kCorrect);
    correct_.draw();
  }
  {
    const StageScope stage(timer_, Stage::kWarp);
    warp_.draw(correct_.vertices(), correct_.tof_ray());
  }
  MIXRIG_TRY(draw_objects());
  if (tables_.has_background) {
    const StageScope stage(timer_, Stage::kKey);
    key_.draw(preparer_.params().key,
              {warp_.w(), plate_.in_view(), learned_, learned_sigma_, gain_});
  }
  draw_light();
  MIXRIG_TRY(draw_mix(output.inspect));
  {
    const StageScope stage(timer_, Stage::kReadback, true);
    read_outputs(output);
    if (output.inspect) read_inspection(output);
  }
  timer_.finish_frame();
  return {};
}

/// While the pose stays, virtual samples and shadow maps stay.
Result<void> GlesCompositor::draw_objects() {
  const FrameParams& params = preparer_.params();
  if (!has_objects() || !params.pose_changed) return {};
  if (!params.virtual_rect.empty()) {
    const StageScope stage(timer_, Stage::kVirtual);
    MIXRIG_TRY(virtual_.draw(params, meshes_));
  }
  has_shadows_ = std::any_of(params.lamps.begin(), params.lamps.end(),
                             [](const LampParams& lamp) { return lamp.map_size_texel > 0; });
  if (!has_shadows_ || !params.maps_changed) return {};
  const StageScope stage(timer_, Stage::kShadow);
  return shadow_.draw(params, meshes_);
}

/// Shading and the background's light stay with the pose as well; people move.
void GlesCompositor::draw_light() {
  if (!has_objects()) return;
  const StageScope stage(timer_, Stage::kLight);
  if (preparer_.params().pose_changed) {
    light_.set_lamps(preparer_.params());
    light_.shade_virtual(preparer_.params(), virtual_, shadow_.maps());
    if (has_light_map()) light_.draw_background(background_m_, shadow_.maps());
  }
  if (has_light_map())
    light_.draw_people(key_.blocks(), key_.matte(), key_.visible_w(), shadow_.maps());
}

Result<void> GlesCompositor::draw_mix(bool inspect) {
  const StageScope stage(timer_, Stage::kMix);
  const bool keyed = tables_.has_background;
  MixInput input;
  input.plate = &plate_.in_view();
  input.visible_w = keyed ? &key_.visible_w() : &warp_.w();
  input.matte = keyed ? &key_.matte() : nullptr;
  input.background_m = keyed ? &background_m_ : nullptr;
  input.learned = &learned_;
  input.light = has_light_map() ? &light_.light() : nullptr;
  input.virtual_color = has_objects() ? &light_.virtual_color() : nullptr;
  input.virtual_w = has_objects() ? &light_.virtual_w() : nullptr;
  input.gain = gain_;
  return mix_.draw(input, inspect);
}

void GlesCompositor::read_outputs(FrameOutput& output) {
  read_back_rgba(mix_.target(), kMixColor, scratch_);
  const auto* rgba = reinterpret_cast<const std::uint8_t*>(scratch_.data());
  for (int y = 0; y < output.color.height(); ++y) {
    Rgb8* color = output.color.row(y);
    std::uint8_t* matte = output.matte.row(y);
    for (int x = 0; x < output.color.width(); ++x, rgba += 4) {
      color[x] = {rgba[0], rgba[1], rgba[2]};
      matte[x] = rgba[3];
    }
  }
  read_back(mix_.target(), kMixDepth, output.mixed_depth_m, scratch_);
  read_back(mix_.target(), kMixSegmented, output.segmented_depth_m, scratch_);
}

void GlesCompositor::read_inspection(FrameOutput& output) {
  read_back(warp_.target(), 0, output.warped_depth_m, scratch_);
  for (int y = 0; y < output.warped_depth_m.height(); ++y)
    for (int x = 0; x < output.warped_depth_m.width(); ++x) {
      float& value = output.warped_depth_m.row(y)[x];  // w, negative in cut cells
      value = value == 0 ? 0 : 1 / std::abs(value);
    }
  if (tables_.has_background)
    read_back(key_.state_target(), 0, output.state, scratch_);
  else
    output.state.fill(static_cast<std::uint8_t>(PixelState::kUnknown));
  decide_states(output.matte, output.state);
  if (has_light_map())
    read_back(light_.light_target(), 0, output.light, scratch_);
  else
    output.light.fill(1);
  read_back(mix_.target(), kMixLayer, output.layer, scratch_);
}

}  // namespace

Result<std::unique_ptr<Compositor>> make_gles_compositor(const CompositorSetup& setup) {
  MIXRIG_TRY(validate(setup));
  MIXRIG_ASSIGN(EglContext context, EglContext::create());
  auto compositor = std::make_unique<GlesCompositor>(std::move(context), setup);
  MIXRIG_TRY(compositor->create_passes());
  return std::unique_ptr<Compositor>(std::move(compositor));
}

}  // namespace mixrig::render
