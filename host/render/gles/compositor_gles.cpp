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
#include "host/render/contract/frame_io.h"
#include "host/render/contract/in_flight.h"
#include "host/render/frame/exposure.h"
#include "host/render/frame/focus_discs.h"
#include "host/render/gles/background/room.h"
#include "host/render/gles/gl/egl_context.h"
#include "host/render/gles/gl/gpu_colors.h"
#include "host/render/gles/gl/read_back.h"
#include "host/render/gles/gl/stage_timer.h"
#include "host/render/gles/key/people_key.h"
#include "host/render/gles/mix/focus_pass.h"
#include "host/render/gles/mix/mix_pass.h"
#include "host/render/gles/plate/correct_pass.h"
#include "host/render/gles/plate/plate_import.h"
#include "host/render/gles/plate/plate_pass.h"
#include "host/render/gles/virtual/virtual_things.h"
#include "host/render/gles/warp/second_depth_pass.h"
#include "host/render/gles/warp/warp_pass.h"
#include "host/render/tables/hidden_objects.h"

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
  /// Plates are read in their camera's memory, where the driver offers it.
  Result<void> import_plates(PlateImport import);
  /// The context is current on no thread afterwards.
  void leave_thread() const { context_.release(); }

  Result<void> submit(const FrameInput& input, OutputMask wanted) override;
  Result<void> collect(FrameOutput& output) override;
  int in_flight() const override { return flight_.count(); }
  const StageTimes& stage_times() const override { return times_; }
  PlateNeed plate_need() const override;
  bool imported_plate() const override { return imported_; }
  std::string why_copied() const override { return imports_ ? imports_->why() : why_copied_; }
  std::string renderer() const override { return renderer_; }

 private:
  /// A frame between submit() and collect().
  struct Frame {
    OutputMask wanted = 0, read = 0;  ///< `read`: what the buffers below hold
    ReadBack color_and_matte, mixed, segmented, warped_w, state, light, layer, alpha;
    Fence done;
    std::shared_ptr<const GpuPicture> gpu_color;
    std::shared_ptr<const void> plate_memory;  ///< of a plate that is read in place
    std::optional<StageTimer> timer;
  };

  const ImportedPlanes* import_plate(FrameInput& input);
  Result<void> draw(const FrameInput& input, const ImportedPlanes* planes, Frame& frame);
  ToneCurve tone_of(const FrameInput& input);
  void follow(const FrameInput& input);
  void choose_objects(bool hide, const geometry::Pose& world_from_camera);
  void upload(const FrameInput& input, bool with_plate);
  void key_people(const FrameInput& input);
  Result<void> draw_mix(OutputMask wanted);
  void start_read_back(Frame& frame);
  static Result<void> fetch(const Frame& frame, FrameOutput& output);
  /// Null where nothing is keyed.
  const KeyPass* key() const { return key_ ? &key_->pass() : nullptr; }
  /// Null where objects take light from nothing.
  const LightPass* light_map() const { return things_ ? things_->light_map(key()) : nullptr; }

  EglContext context_;  // dies last
  std::string renderer_;
  CompositorSetup setup_;
  Tables tables_;
  FramePreparer preparer_;
  LensFollower lens_;
  std::optional<HiddenObjects> hidden_;      ///< where frames may hide objects
  const FramePreparer* frame_ = &preparer_;  ///< of this frame: it shows all, or hides some
  const FramePreparer* room_by_ = nullptr;   ///< that when room_ was last drawn
  std::optional<Crew> crew_;                 ///< where the lens moves
  Image<glm::vec2> plate_px_;                ///< the same
  ExposureMeter meter_;
  ToneCurve tone_;
  Room room_;
  PlatePass plate_;
  CorrectPass correct_;
  WarpPass warp_;
  std::optional<SecondDepthPass> second_depth_;           ///< of a rig with two depth cameras
  std::optional<PeopleKey> key_;                          ///< where anything is keyed
  std::optional<VirtualThings> all_things_, set_things_;  ///< where there are any; of hidden_
  VirtualThings* things_ = nullptr;                       ///< of this frame
  MixPass mix_;
  std::optional<FocusPass> focus_;
  std::optional<PlateImports> imports_;  ///< where the driver has them
  std::string why_copied_;               ///< where it has not
  bool imported_ = false;                ///< the plate of the newest frame
  bool has_look_ = false;                ///< of virtual objects: found in a plate of the host
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
  if (setup_.may_hide_objects && any_object_hides(setup_)) hidden_.emplace(setup_);
  if (!setup_.lens_moves) return;
  crew_.emplace();
  plate_px_.reset(tables_.view_size);
}

// GL names are given back to the context that made them.
GlesCompositor::~GlesCompositor() {
  (void)context_.make_current();
  if (flight_.count() > 0) glFinish();  // buffers of cameras are given back now
}

/// Only the passes that the scene needs; their tables go to the GPU here, once.
Result<void> GlesCompositor::create_passes() {
  MIXRIG_ASSIGN(plate_, PlatePass::create(tables_));
  MIXRIG_ASSIGN(correct_, CorrectPass::create(tables_));
  MIXRIG_ASSIGN(warp_, WarpPass::create(tables_));
  if (setup_.tof2) {
    MIXRIG_ASSIGN(second_depth_, SecondDepthPass::create(setup_, tables_));
  }
  MIXRIG_ASSIGN(room_, Room::create(setup_, tables_, meter_.places()));
  const FrameParams& frame = preparer_.params();
  if (frame.key.by != KeyBy::kNothing) {
    MIXRIG_ASSIGN(key_, PeopleKey::create(setup_, tables_, room_.has_color(), frame.key));
  }
  if (!frame.draws.empty()) {
    MIXRIG_ASSIGN(all_things_, VirtualThings::create(setup_, tables_, frame));
  }
  if (hidden_ && !hidden_->preparer().params().draws.empty()) {
    MIXRIG_ASSIGN(set_things_,
                  VirtualThings::create(hidden_->setup(), tables_, hidden_->preparer().params()));
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

Result<void> GlesCompositor::import_plates(PlateImport import) {
  if (import == PlateImport::kOnGpu && is_software(renderer_)) {
    why_copied_ = renderer_ + " draws on the processor";
    return {};
  }
  const auto calls = find_import_calls(context_);
  if (!calls) {
    why_copied_ = calls.error().context;
    return {};
  }
  imports_.emplace(*calls);
  return plate_.prepare_decoding();
}

PlateNeed GlesCompositor::plate_need() const {
  if (!imports_ || !imports_->why().empty()) return PlateNeed::kDecoded;
  const bool looks_at_people = key_ && key_->follows();
  return looks_at_people ? PlateNeed::kDecodedAndShared : PlateNeed::kShared;
}

/// The plate's textures in its camera's memory; null where it is copied. Pixels that the host needs
/// are decoded.
const ImportedPlanes* GlesCompositor::import_plate(FrameInput& input) {
  const ImportedPlanes* planes = nullptr;
  if (input.shared != nullptr && imports_ && imports_->why().empty()) {
    planes = imports_->find(input.shared->raw());
    if (planes == nullptr)
      log_warning("render", "camera pictures are copied from now on: " + imports_->why());
  }
  imported_ = planes != nullptr;
  const bool measures = setup_.look.measures() && !std::exchange(has_look_, true);
  const bool on_host = planes == nullptr || measures || plate_need() != PlateNeed::kShared;
  if (input.plate.empty() && input.shared != nullptr && on_host)
    input.plate = input.shared->decoded();
  return planes;
}

Result<void> GlesCompositor::submit(const FrameInput& given, OutputMask wanted) {
  MIXRIG_TRY(check_frame(given, tables_, true));
  MIXRIG_TRY(context_.make_current());
  FrameInput input = given;
  const bool alone = flight_.count() == 0;
  MIXRIG_ASSIGN(Frame* const frame, flight_.push());
  frame->wanted = with_needed(wanted, gpu_colors_.has_value());
  frame->timer->begin_frame(alone);
  const ImportedPlanes* const planes = import_plate(input);
  if (planes != nullptr) frame->plate_memory = input.shared->hold();
  auto drawn = draw(input, planes, *frame);
  if (!drawn) {
    if (frame->plate_memory) glFinish();
    frame->plate_memory.reset();
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
Result<void> GlesCompositor::draw(const FrameInput& input, const ImportedPlanes* planes,
                                  Frame& frame) {
  StageTimer& timer = *frame.timer;
  const bool two = second_depth_ && !input.tof2_depth_m.empty();
  {
    const StageScope stage(timer, Stage::kUpload, true);
    upload(input, planes == nullptr);
  }
  const NeededPasses needed = needed_passes(frame.wanted, things_ != nullptr, setup_);
  if (plate_.draws() || planes != nullptr) {
    const StageScope stage(timer, Stage::kPlate);
    if (planes != nullptr) plate_.decode(input.shared->raw(), *planes);
    if (plate_.draws()) plate_.draw();
  }
  if (room_.is_drawn()) {
    const bool other = std::exchange(room_by_, frame_) != frame_;
    if (other || frame_->params().pose_changed)
      room_.draw(frame_->world_from_camera(), things_ != nullptr, meter_, timer);
    tone_ = tone_of(input);
  }
  {
    const StageScope stage(timer, Stage::kCorrect);
    two ? second_depth_->correct_both(correct_) : correct_.draw();
  }
  {
    const StageScope stage(timer, Stage::kWarp);
    const bool colors = color_places_borders(tables_.tof_footprint_px);
    warp_.draw(correct_.vertices(), correct_.tof_ray(), correct_.raw_z_m(),
               colors ? &plate_.in_view() : nullptr);
    if (two) second_depth_->add_to(warp_);
  }
  if (things_) MIXRIG_TRY(things_->draw(timer));
  if (key_ && needed.key) {
    const StageScope stage(timer, Stage::kKey);
    key_people(input);
  }
  if (things_) MIXRIG_TRY(things_->light(room_, key(), needed.light, timer));
  if (things_ && needed.mix) things_->blur(input.motion);
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

ToneCurve GlesCompositor::tone_of(const FrameInput& input) {
  return input.plate.empty() ? meter_.curve(input.shared->raw()) : meter_.curve(input.plate);
}

/// The frame's pictures; and what the host finds out from them.
void GlesCompositor::upload(const FrameInput& input, bool with_plate) {
  follow(input);
  if (all_things_) all_things_->take_look(input);
  if (set_things_) set_things_->take_look(input);
  if (!room_.is_drawn()) tone_ = tone_of(input);
  if (key_) key_->follow(input, plate_.in_view());
  if (with_plate) plate_.upload_plate(input.plate);
  correct_.upload_depth(input.tof_depth_m);
  if (second_depth_ && !input.tof2_depth_m.empty()) second_depth_->upload_depth(input.tof2_depth_m);
}

/// The matte and people's depth.
void GlesCompositor::key_people(const FrameInput& input) {
  key_->draw(
      frame_->params().key, input.depth_delay_s,
      {warp_.w(), plate_.in_view(), room_.color(), room_.color_sigma(), tone_, room_.limit_w()});
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
    room_.set_view(tables_, setup_);
    if (key_) key_->set_view(tables_);
    if (all_things_) all_things_->set_view(tables_);
    if (set_things_) set_things_->set_view(tables_);
  }
  preparer_.note(
      {moved, place_objects(input.world_from_object, setup_), set_light(input.light, setup_)});
  choose_objects(!input.objects_shown, lens_.world_from_pupil(input.world_from_target));
}

/// What is drawn of the scene in this frame.
void GlesCompositor::choose_objects(bool hide, const geometry::Pose& world_from_camera) {
  if (hidden_) hidden_->follow(setup_);
  std::optional<VirtualThings>& things = hidden_ && hide ? set_things_ : all_things_;
  things_ = things ? &*things : nullptr;
  frame_ = hidden_ && hide ? &hidden_->preparer() : &preparer_;
  frame_ == &preparer_ ? preparer_.update(world_from_camera) : hidden_->update(world_from_camera);
}

Result<void> GlesCompositor::draw_mix(OutputMask wanted) {
  MixInput input;
  input.plate = &plate_.in_view();
  input.visible_w = key_ ? &key()->visible_w() : &warp_.w();
  input.matte = key_ ? &key()->matte() : nullptr;
  input.background_m = tables_.has_background ? &room_.depth_m(things_ != nullptr) : nullptr;
  input.room = key_ ? &key()->room() : nullptr;
  input.learned = &room_.color();
  input.light = light_map() != nullptr ? &light_map()->light() : nullptr;
  if (things_) things_->add_to(input);
  input.tone = tone_;
  return mix_.draw(input, wanted);
}

/// Queues the copies of the wanted images. What the scene does not have is filled in by fetch().
void GlesCompositor::start_read_back(Frame& frame) {
  const StageScope stage(*frame.timer, Stage::kReadback);
  frame.read = frame.wanted;
  if (!key_) frame.read &= ~kState;
  if (!mix_.has_alpha()) frame.read &= ~kAlpha;
  if (light_map() == nullptr) frame.read &= ~kLight;
  const Target& colored = focus_ && (frame.read & kColor) ? focus_->target() : mix_.target();
  if (frame.read & (kColor | kMatte)) frame.color_and_matte.start_rgba(colored, kMixColor);
  if (frame.read & kMixedDepth) frame.mixed.start_float(mix_.target(), kMixDepth);
  if (frame.read & kSegmentedDepth) frame.segmented.start_float(mix_.target(), kMixSegmented);
  if (frame.read & kWarpedDepth) frame.warped_w.start_float(warp_.target(), 0);
  if (frame.read & kState) frame.state.start_byte(key()->state_target(), 0);
  if (frame.read & kLight) frame.light.start_float(light_map()->light_target(), 0);
  if (frame.read & kLayer) frame.layer.start_byte(mix_.target(), kMixLayer);
  if (frame.read & kAlpha) frame.alpha.start_byte(mix_.alpha_target(), 0);
}

Result<void> GlesCompositor::collect(FrameOutput& output) {
  MIXRIG_TRY(context_.make_current());
  MIXRIG_ASSIGN(Frame* const frame, flight_.pop());
  MIXRIG_TRY(frame->done.wait());
  frame->plate_memory.reset();
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
                                                         const GlShare& share, PlateImport import) {
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
  MIXRIG_TRY(compositor->import_plates(import));
  compositor->leave_thread();
  return std::unique_ptr<Compositor>(std::move(compositor));
}

}  // namespace mixrig::render
