// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/compositor_gles.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "hal/base/log.h"
#include "hal/base/parallel.h"
#include "host/render/exposure.h"
#include "host/render/focus_discs.h"
#include "host/render/frame_io.h"
#include "host/render/gles/background_pass.h"
#include "host/render/gles/correct_pass.h"
#include "host/render/gles/egl_context.h"
#include "host/render/gles/focus_pass.h"
#include "host/render/gles/gl_mesh.h"
#include "host/render/gles/gpu_colors.h"
#include "host/render/gles/key_pass.h"
#include "host/render/gles/light_pass.h"
#include "host/render/gles/look_pass.h"
#include "host/render/gles/mix_pass.h"
#include "host/render/gles/motion_pass.h"
#include "host/render/gles/people_shadow_pass.h"
#include "host/render/gles/plate_pass.h"
#include "host/render/gles/read_back.h"
#include "host/render/gles/second_depth_pass.h"
#include "host/render/gles/shadow_pass.h"
#include "host/render/gles/stage_timer.h"
#include "host/render/gles/virtual_pass.h"
#include "host/render/gles/warp_pass.h"
#include "host/render/in_flight.h"
#include "host/render/people_motion.h"

namespace mixrig::render {
namespace {

using namespace gles;  // NOLINT(google-build-using-namespace)

class GlesCompositor final : public Compositor {
 public:
  GlesCompositor(EglContext context, const CompositorSetup& setup);
  ~GlesCompositor() override;
  Result<void> create_passes();
  /// Composites of kGpuColor stay in the GPU's memory, where the driver can copy them.
  void share_colors();
  /// The context is current on no thread afterwards.
  void leave_thread() const { context_.release(); }

  Result<void> submit(const FrameInput& input, OutputMask wanted) override;
  Result<void> collect(FrameOutput& output) override;
  int in_flight() const override { return flight_.count(); }
  const StageTimes& stage_times() const override { return times_; }
  std::string renderer() const override { return renderer_; }

 private:
  /// A frame between submit() and collect().
  struct Frame {
    OutputMask wanted = 0, read = 0;  ///< `read`: what the buffers below hold
    ReadBack color_and_matte, mixed, segmented, warped_w, state, light, layer, alpha;
    Fence done;
    std::shared_ptr<const GpuPicture> gpu_color;
    std::optional<StageTimer> timer;
  };

  Result<void> draw(const FrameInput& input, Frame& frame);
  void follow(const FrameInput& input);
  void follow_people(const FrameInput& input);
  void key_people(const FrameInput& input);
  void draw_background(StageTimer& timer);
  Result<void> draw_objects(StageTimer& timer);
  Result<void> draw_light(bool people, StageTimer& timer);
  void take_look(const FrameInput& input);
  void use_look(const PictureLook& look);
  void blur_objects(const std::optional<CameraMotion>& motion);
  Result<void> draw_mix(OutputMask wanted);
  void start_read_back(Frame& frame);
  static Result<void> fetch(const Frame& frame, FrameOutput& output);
  const Texture& background_m() const {
    return background_pass_ ? background_pass_->depth_m() : background_m_;
  }
  const Texture& learned() const {
    return background_pass_ ? background_pass_->learned() : learned_;
  }
  const Texture& learned_sigma() const {
    return background_pass_ ? background_pass_->learned_sigma() : learned_sigma_;
  }
  bool has_objects() const { return !meshes_.empty(); }
  bool keys() const { return preparer_.params().key.by != KeyBy::kNothing; }
  bool has_light_map() const { return has_shadows_ && keys(); }

  EglContext context_;  // dies last
  std::string renderer_;
  CompositorSetup setup_;
  Tables tables_;
  FramePreparer preparer_;
  LensFollower lens_;
  std::optional<Crew> crew_;   ///< where the lens moves, or people are followed
  Image<glm::vec2> plate_px_;  ///< the same
  ExposureMeter meter_;
  ToneCurve tone_;
  Texture background_m_, light_m_, learned_, learned_sigma_;
  std::vector<GpuMesh> meshes_;  // as FrameParams::draws
  PlatePass plate_;
  CorrectPass correct_;
  WarpPass warp_;
  std::optional<SecondDepthPass> second_depth_;    ///< of a rig with two depth cameras
  std::optional<BackgroundPass> background_pass_;  ///< of a camera that moves
  VirtualPass virtual_;
  ShadowPass shadow_;
  std::optional<PeopleShadowPass> people_shadow_;
  std::optional<PeopleMotion> people_motion_;  ///< of a camera that stands still
  Image<glm::vec2> depth_shift_px_;            ///< of its cells
  Texture shift_px_, motion_px_;
  bool has_now_ = false, has_before_ = false;  ///< a matte of this frame, and of that before
  KeyPass key_;
  LightPass light_;
  std::optional<LookMeter> look_meter_;  ///< until the first frame
  std::optional<PictureLook> used_look_;
  std::optional<LookPass> look_;
  bool objects_shaded_ = false;  ///< since they were blurred
  std::optional<MotionPass> motion_;
  const Texture *mixed_color_ = nullptr, *mixed_w_ = nullptr;  ///< of objects, in this frame
  std::uint32_t frames_ = 0;
  MixPass mix_;
  std::optional<FocusPass> focus_;
  bool has_shadows_ = false;
  std::optional<GpuColors> gpu_colors_;  ///< where objects are shared with a screen
  InFlight<Frame> flight_;
  StageTimes times_{};
};

GlesCompositor::GlesCompositor(EglContext context, const CompositorSetup& setup)
    : context_(std::move(context)),
      renderer_(context_.renderer()),
      setup_(setup),
      tables_(make_tables(setup_)),
      preparer_(setup_),
      lens_(setup_),
      meter_(tables_, setup_.background) {
  for (Frame& frame : flight_.slots()) frame.timer.emplace(context_);
  if (setup_.look.measures() && !setup_.objects.empty()) look_meter_.emplace(setup_);
  if (!setup_.lens_moves) return;
  crew_.emplace();
  plate_px_.reset(tables_.view_size);
}

// GL names are given back to the context that made them.
GlesCompositor::~GlesCompositor() { (void)context_.make_current(); }

/// Only the passes that the scene needs; their tables go to the GPU here, once.
Result<void> GlesCompositor::create_passes() {
  const BackgroundView& background = setup_.background;
  const LearnedColor learned{!background.color.empty(), !background.color_sigma.empty()};
  MIXRIG_ASSIGN(plate_, PlatePass::create(tables_));
  MIXRIG_ASSIGN(correct_, CorrectPass::create(tables_));
  MIXRIG_ASSIGN(warp_, WarpPass::create(tables_));
  if (setup_.tof2) {
    MIXRIG_ASSIGN(second_depth_, SecondDepthPass::create(setup_, tables_));
  }
  if (!setup_.background_models.empty()) {
    MIXRIG_ASSIGN(background_pass_, BackgroundPass::create(tables_, setup_, meter_.places()));
    tables_.has_background = true;
    const bool color = has_model_color(setup_);
    MIXRIG_ASSIGN(key_, KeyPass::create(tables_, {color, color}, preparer_.params().key));
  } else if (tables_.has_background) {
    background_m_ = make_texture(
        tables_.edge_depth_m.empty() ? background.depth_m : tables_.edge_depth_m.view(), GL_R32F);
    if (!tables_.light_depth_m.empty())
      light_m_ = make_texture(tables_.light_depth_m.view(), GL_R32F);
    if (!background.color.empty()) learned_ = make_texture(background.color, GL_RGB16F);
    if (!background.color_sigma.empty())
      learned_sigma_ = make_texture(background.color_sigma, GL_R16F);
    MIXRIG_ASSIGN(key_, KeyPass::create(tables_, learned, preparer_.params().key));
    if (follows_people(setup_)) {
      people_motion_.emplace(tables_);
      if (!crew_) crew_.emplace();
      depth_shift_px_.reset(people_motion_->cells());
      shift_px_ = make_texture(depth_shift_px_.view(), GL_RG32F);
      motion_px_ = make_texture(depth_shift_px_.view(), GL_RG32F);
      MIXRIG_TRY(key_.follow_people(tables_, people_motion_->cell_px(), setup_.key.steady));
    }
  } else if (keys()) {
    MIXRIG_ASSIGN(key_, KeyPass::create(tables_, learned, preparer_.params().key));
  }
  for (const Draw& draw : preparer_.params().draws) meshes_.emplace_back(*draw.mesh);
  if (has_objects()) {
    const FrameParams& first = preparer_.params();
    MIXRIG_ASSIGN(virtual_, VirtualPass::create(first.glossy || first.emits));
    MIXRIG_ASSIGN(light_, LightPass::create(tables_, setup_));
    light_.set_contacts(first);
    if (!setup_.light.lamps.empty()) {
      MIXRIG_ASSIGN(shadow_, ShadowPass::create());
    }
    if (!preparer_.params().people_lamps.empty()) {
      MIXRIG_ASSIGN(people_shadow_, PeopleShadowPass::create(tables_));
    }
  }
  if (look_meter_) {
    MIXRIG_ASSIGN(look_, LookPass::create(tables_));
  }
  if (setup_.look.motion && has_objects()) {
    MIXRIG_ASSIGN(motion_, MotionPass::create(tables_));
  }
  MIXRIG_ASSIGN(mix_, MixPass::create(tables_, setup_));
  if (setup_.focus) {
    MIXRIG_ASSIGN(focus_, FocusPass::create(tables_, setup_));
  }
  if (glGetError() != GL_NO_ERROR)
    return Error{ErrorCode::kUnsupported,
                 "the OpenGL ES driver (" + renderer_ +
                     ") lacks memory or a format for this view: use --backend cpu"};
  // The GPU has them now.
  tables_.tof_ray = tables_.plate_px = {};
  tables_.plate_gain = {};
  tables_.key_limit_w = {};
  tables_.background_normal = {};
  tables_.light_depth_m = tables_.edge_depth_m = {};
  return {};
}

void GlesCompositor::share_colors() {
  if (GpuColors::are_possible())
    gpu_colors_.emplace(tables_.view_size);
  else
    log_info("render", renderer_ + " does not copy between textures: composites are read back");
}

Result<void> GlesCompositor::submit(const FrameInput& input, OutputMask wanted) {
  MIXRIG_TRY(check_frame(input, tables_));
  MIXRIG_TRY(context_.make_current());
  const bool alone = flight_.count() == 0;
  MIXRIG_ASSIGN(Frame* const frame, flight_.push());
  frame->wanted = with_needed(wanted, gpu_colors_.has_value());
  frame->timer->begin_frame(alone);
  auto drawn = draw(input, *frame);
  if (!drawn) {
    flight_.drop_last();
    return drawn;
  }
  if (frame->wanted & kGpuColor)
    frame->gpu_color = gpu_colors_->copy(focus_ ? focus_->color() : mix_.color());
  start_read_back(*frame);
  frame->done.set();
  return {};
}

/// The passes, in the order of host/render/README.md.
Result<void> GlesCompositor::draw(const FrameInput& input, Frame& frame) {
  const NeededPasses needed = needed_passes(frame.wanted, setup_);
  StageTimer& timer = *frame.timer;
  const bool two = second_depth_ && !input.tof2_depth_m.empty();
  {
    const StageScope stage(timer, Stage::kUpload, true);
    follow(input);
    take_look(input);
    if (!background_pass_) tone_ = meter_.curve(input.plate);
    if (people_motion_) follow_people(input);
    plate_.upload_plate(input.plate);
    correct_.upload_depth(input.tof_depth_m);
    if (two) second_depth_->upload_depth(input.tof2_depth_m);
  }
  if (plate_.draws()) {
    const StageScope stage(timer, Stage::kPlate);
    plate_.draw();
  }
  draw_background(timer);
  if (background_pass_) tone_ = meter_.curve(input.plate);
  {
    const StageScope stage(timer, Stage::kCorrect);
    two ? second_depth_->correct_both(correct_) : correct_.draw();
  }
  {
    const StageScope stage(timer, Stage::kWarp);
    warp_.draw(correct_.vertices(), correct_.tof_ray(), correct_.raw_z_m(), &plate_.in_view());
    if (two) second_depth_->add_to(warp_);
  }
  MIXRIG_TRY(draw_objects(timer));
  if (keys() && needed.key) {
    const StageScope stage(timer, Stage::kKey);
    key_people(input);
  }
  MIXRIG_TRY(draw_light(needed.light, timer));
  if (needed.mix) blur_objects(input.motion);
  if (!needed.mix && !(frame.wanted & kMatte)) return {};
  const bool colors = frame.wanted & (kColor | kGpuColor), focuses = focus_ && colors;
  {
    const StageScope stage(timer, Stage::kMix);
    MIXRIG_TRY(draw_mix(frame.wanted | (colors ? kColor : 0) | (focuses ? kMixedDepth : 0)));
  }
  if (!focuses) return {};
  const StageScope stage(timer, Stage::kFocus);
  focus_->draw(focus_of(setup_, input), mix_.color(), mix_.mixed_m());
  return {};
}

/// How people moved since the frame before, whose plate and matte are kept.
void GlesCompositor::follow_people(const FrameInput& input) {
  const bool moves = setup_.key.motion && input.depth_delay_s != 0;
  if (!moves && !setup_.key.steady) return;
  if (!people_motion_->see(input, *crew_) || !setup_.key.steady) return;
  if (has_now_) key_.remember(plate_.in_view());
  has_before_ = std::exchange(has_now_, false);
  if (const Image<glm::vec2>* motion_px = people_motion_->motion_px())
    upload(motion_px_, motion_px->view());
}

/// The matte and people's depth. This is brought to the time of the plate first.
void GlesCompositor::key_people(const FrameInput& input) {
  const bool moved = people_motion_ && setup_.key.motion &&
                     people_motion_->depth_shift_px(input.depth_delay_s, depth_shift_px_);
  if (moved) upload(shift_px_, depth_shift_px_.view());
  const bool steady =
      people_motion_ && setup_.key.steady && has_before_ && people_motion_->motion_px() != nullptr;
  key_.draw(preparer_.params().key, {warp_.w(), plate_.in_view(), learned(), learned_sigma(), tone_,
                                     background_pass_ ? &background_pass_->limit_w() : nullptr,
                                     moved ? &shift_px_ : nullptr, steady ? &motion_px_ : nullptr});
  has_now_ = true;
}

/// What depends on the lens is made again where it has moved, and only there.
void GlesCompositor::follow(const FrameInput& input) {
  constexpr int kRows = 16;
  const bool moved = lens_.follow(input.lens, setup_, tables_);
  if (moved) {
    crew_->rows(plate_px_.height(), kRows, [&](int begin, int end) {
      for (int y = begin; y < end; ++y) plate_row(setup_.target, setup_.view, y, plate_px_.row(y));
    });
    plate_.upload_map(plate_px_);
    meter_.see_through(setup_);
    warp_.set_view(tables_);
    if (second_depth_) second_depth_->set_view(setup_);
    if (background_pass_) background_pass_->set_view(tables_, setup_);
    if (keys()) key_.set_view(tables_);
    if (has_objects()) light_.set_view(tables_);
    if (people_shadow_) people_shadow_->set_view(tables_);
  }
  preparer_.update(lens_.world_from_pupil(input.world_from_target), moved,
                   place_objects(input.world_from_object, setup_), set_light(input.light, setup_));
}

/// Only where the camera moves; while the pose stays, so does the background.
void GlesCompositor::draw_background(StageTimer& timer) {
  if (!background_pass_ || !preparer_.params().pose_changed) return;
  const StageScope stage(timer, Stage::kBackground);
  background_pass_->draw(preparer_.world_from_camera());
  meter_.learn(background_pass_->colors_of_places());
}

/// While the pose stays, virtual samples and shadow maps stay.
Result<void> GlesCompositor::draw_objects(StageTimer& timer) {
  const FrameParams& params = preparer_.params();
  if (!has_objects() || !params.pose_changed) return {};
  if (!params.virtual_rect.empty()) {
    const StageScope stage(timer, Stage::kVirtual);
    MIXRIG_TRY(virtual_.draw(params, meshes_));
  }
  const bool has_maps = std::any_of(params.lamps.begin(), params.lamps.end(),
                                    [](const LampParams& lamp) { return lamp.map_size_texel > 0; });
  has_shadows_ = has_maps || !params.contacts.empty();
  if (!has_maps || !params.maps_changed) return {};
  const StageScope stage(timer, Stage::kShadow);
  return shadow_.draw(params, meshes_);
}

/// Shading and the background's light stay with the pose as well; people and their shadows move.
Result<void> GlesCompositor::draw_light(bool people, StageTimer& timer) {
  if (!has_objects()) return {};
  const StageScope stage(timer, Stage::kLight);
  objects_shaded_ |= preparer_.params().pose_changed || (people_shadow_ && people);
  if (preparer_.params().pose_changed) {
    if (preparer_.params().room_changed) MIXRIG_TRY(light_.set_room(preparer_.params()));
    light_.set_lamps(preparer_.params());
    if (!people_shadow_ || !people)
      light_.shade_virtual(preparer_.params(), virtual_, shadow_.maps());
    if (has_light_map() && (!tables_.has_background || setup_.backdrop))
      light_.skip_background();
    else if (has_light_map())
      light_.draw_background(background_pass_ ? background_m() : light_m_, shadow_.maps(),
                             background_pass_ ? &background_pass_->normal() : nullptr);
  }
  if (!people) return {};
  if (people_shadow_)
    MIXRIG_TRY(people_shadow_->draw(preparer_.params(), key_.matte(), key_.visible_w()));
  if (has_light_map()) {
    LightPass::PastPeople past;
    if (people_shadow_ && tables_.has_background && !setup_.backdrop)
      past = {people_shadow_->maps(), background_pass_ ? &background_m() : &light_m_,
              background_pass_ ? &background_pass_->normal() : nullptr};
    light_.draw_people({key_.blocks(), key_.matte(), key_.visible_w()}, shadow_.maps(), past);
  }
  if (!people_shadow_) return {};
  light_.shade_virtual(preparer_.params(), virtual_, shadow_.maps(), people_shadow_->maps());
  return {};
}

/// What virtual things take on of the plate: as the frame says, else found in the first frame.
void GlesCompositor::take_look(const FrameInput& input) {
  ++frames_;
  if (!look_) return;
  if (input.look != nullptr)
    use_look(*input.look);
  else if (look_meter_)
    use_look(measured_first(*look_meter_, input.plate));
  look_meter_.reset();
}

void GlesCompositor::use_look(const PictureLook& look) {
  const PictureLook wanted = wanted_of(look, setup_.look);
  if (used_look_ == wanted) return;
  used_look_ = wanted;
  look_->set(wanted);
  objects_shaded_ = true;
}

/// By the lens, then by the camera's motion.
void GlesCompositor::blur_objects(const std::optional<CameraMotion>& motion) {
  if (!has_objects()) return;
  mixed_color_ = &light_.virtual_color(), mixed_w_ = &light_.virtual_w();
  if (look_ && look_->blurs()) {
    if (objects_shaded_)
      look_->draw(preparer_.params().virtual_rect, light_.virtual_color(), light_.virtual_w());
    mixed_color_ = &look_->virtual_color(), mixed_w_ = &look_->virtual_w();
    objects_shaded_ = false;
  }
  if (!motion_) return;
  const MotionParams params = motion_params(motion, setup_.view, preparer_.params());
  if (!params.blurs()) return;
  motion_->draw(params, *mixed_color_, *mixed_w_);
  mixed_color_ = &motion_->virtual_color(), mixed_w_ = &motion_->virtual_w();
}

Result<void> GlesCompositor::draw_mix(OutputMask wanted) {
  const bool keyed = keys();
  MixInput input;
  input.plate = &plate_.in_view();
  input.visible_w = keyed ? &key_.visible_w() : &warp_.w();
  input.matte = keyed ? &key_.matte() : nullptr;
  input.background_m = tables_.has_background ? &background_m() : nullptr;
  input.room = keyed ? &key_.room() : nullptr;
  input.learned = &learned();
  input.light = has_light_map() ? &light_.light() : nullptr;
  if (has_objects()) {
    input.virtual_color = mixed_color_ != nullptr ? mixed_color_ : &light_.virtual_color();
    input.virtual_w = mixed_w_ != nullptr ? mixed_w_ : &light_.virtual_w();
  }
  if (look_ && look_->noise() != nullptr) {
    input.noise = look_->noise();
    input.grain = look_->grain();
    input.grain_offset = grain_offset(frames_ - 1);
  }
  input.tone = tone_;
  return mix_.draw(input, wanted);
}

/// Queues the copies of the wanted images. What the scene does not have is filled in by fetch().
void GlesCompositor::start_read_back(Frame& frame) {
  const StageScope stage(*frame.timer, Stage::kReadback);
  frame.read = frame.wanted;
  if (!keys()) frame.read &= ~kState;
  if (!mix_.has_alpha()) frame.read &= ~kAlpha;
  if (!has_light_map()) frame.read &= ~kLight;
  const Target& colored = focus_ && (frame.read & kColor) ? focus_->target() : mix_.target();
  if (frame.read & (kColor | kMatte)) frame.color_and_matte.start_rgba(colored, kMixColor);
  if (frame.read & kMixedDepth) frame.mixed.start_float(mix_.target(), kMixDepth);
  if (frame.read & kSegmentedDepth) frame.segmented.start_float(mix_.target(), kMixSegmented);
  if (frame.read & kWarpedDepth) frame.warped_w.start_float(warp_.target(), 0);
  if (frame.read & kState) frame.state.start_byte(key_.state_target(), 0);
  if (frame.read & kLight) frame.light.start_float(light_.light_target(), 0);
  if (frame.read & kLayer) frame.layer.start_byte(mix_.target(), kMixLayer);
  if (frame.read & kAlpha) frame.alpha.start_byte(mix_.alpha_target(), 0);
}

Result<void> GlesCompositor::collect(FrameOutput& output) {
  MIXRIG_TRY(context_.make_current());
  MIXRIG_ASSIGN(Frame* const frame, flight_.pop());
  MIXRIG_TRY(frame->done.wait());
  {
    const StageScope stage(*frame->timer, Stage::kReadback, true);
    output.wanted = frame->wanted;
    size_outputs(tables_.view_size, frame->wanted, output);
    MIXRIG_TRY(fetch(*frame, output));
    output.gpu_color = std::move(frame->gpu_color);
  }
  times_ = frame->timer->finish_frame();
  return {};
}

Result<void> GlesCompositor::fetch(const Frame& frame, FrameOutput& output) {
  const OutputMask read = frame.read;
  if (read & (kColor | kMatte))
    MIXRIG_TRY(frame.color_and_matte.fetch(
        read & kColor ? output.color.view() : ImageView<Rgb8>{},
        read & kMatte ? output.matte.view() : ImageView<std::uint8_t>{}));
  if (read & kMixedDepth) MIXRIG_TRY(frame.mixed.fetch(output.mixed_depth_m));
  if (read & kSegmentedDepth) MIXRIG_TRY(frame.segmented.fetch(output.segmented_depth_m));
  if (read & kWarpedDepth) {
    MIXRIG_TRY(frame.warped_w.fetch(output.warped_depth_m));
    for (int y = 0; y < output.warped_depth_m.height(); ++y)
      for (int x = 0; x < output.warped_depth_m.width(); ++x) {
        float& value = output.warped_depth_m.row(y)[x];  // w, negative in cut cells
        value = value == 0 ? 0 : 1 / std::abs(value);
      }
  }
  if (frame.wanted & kState) {
    if (read & kState)
      MIXRIG_TRY(frame.state.fetch(output.state));
    else
      output.state.fill(static_cast<std::uint8_t>(PixelState::kUnknown));
    decide_states(output.matte, output.state);
  }
  if (read & kLight)
    MIXRIG_TRY(frame.light.fetch(output.light));
  else if (frame.wanted & kLight)
    output.light.fill(1);
  if (read & kLayer) MIXRIG_TRY(frame.layer.fetch(output.layer));
  if (read & kAlpha)
    MIXRIG_TRY(frame.alpha.fetch(output.alpha));
  else if (frame.wanted & kAlpha)
    output.alpha.fill(255);
  return {};
}

}  // namespace

Result<std::unique_ptr<Compositor>> make_gles_compositor(const CompositorSetup& setup,
                                                         const GlShare& share) {
  MIXRIG_TRY(validate(setup));
  MIXRIG_ASSIGN(EglContext context, share.display != nullptr ? EglContext::create_sharing(share)
                                                             : EglContext::create());
  auto compositor = std::make_unique<GlesCompositor>(std::move(context), setup);
  const SystemClock clock;
  const HostTime begin = clock.now();
  MIXRIG_TRY(compositor->create_passes());
  log_info("render", fmt::format("{}: shaders are ready after {:.0f} ms", compositor->renderer(),
                                 milliseconds(clock.now() - begin)));
  if (share.display != nullptr) compositor->share_colors();
  compositor->leave_thread();
  return std::unique_ptr<Compositor>(std::move(compositor));
}

}  // namespace mixrig::render
