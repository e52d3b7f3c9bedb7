// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "hal/base/clock.h"
#include "hal/base/cpu_level.h"
#include "hal/base/parallel.h"
#include "host/render/cpu/back_end.h"
#include "host/render/cpu/background.h"
#include "host/render/cpu/correct.h"
#include "host/render/cpu/draw_quads.h"
#include "host/render/cpu/focus.h"
#include "host/render/cpu/key.h"
#include "host/render/cpu/light.h"
#include "host/render/cpu/look.h"
#include "host/render/cpu/mix.h"
#include "host/render/cpu/motion.h"
#include "host/render/cpu/move_people.h"
#include "host/render/cpu/people_shadow.h"
#include "host/render/cpu/plate.h"
#include "host/render/cpu/second_depth.h"
#include "host/render/cpu/shadow.h"
#include "host/render/cpu/simd.h"
#include "host/render/cpu/virtual.h"
#include "host/render/cpu/warp.h"
#include "host/render/exposure.h"
#include "host/render/focus_discs.h"
#include "host/render/frame_io.h"
#include "host/render/in_flight.h"
#include "host/render/people_motion.h"
#include "host/render/prepare.h"

namespace mixrig::render {
namespace {

using namespace cpu;  // NOLINT(google-build-using-namespace)

/// Adds wall time to stages, from one lap to the next.
class StopWatch {
 public:
  explicit StopWatch(StageTimes& times) : times_(times) { times_.fill(0); }
  void lap(Stage stage) {
    const HostTime now = clock_.now();
    times_[static_cast<std::size_t>(stage)] += static_cast<float>(milliseconds(now - last_));
    last_ = now;
  }

 private:
  SystemClock clock_;
  StageTimes& times_;
  HostTime last_ = clock_.now();
};

std::string vectors();

class CpuCompositor final : public Compositor {
 public:
  CpuCompositor(const CompositorSetup& setup, int threads);
  Result<void> submit(const FrameInput& input, OutputMask wanted) override;
  Result<void> collect(FrameOutput& output) override;
  Result<void> compose(const FrameInput& input, FrameOutput& output) override;
  int in_flight() const override { return flight_.count(); }
  const StageTimes& stage_times() const override { return times_; }
  std::string renderer() const override;

 private:
  void draw(const FrameInput& input, OutputMask wanted, FrameOutput& output, StageTimes& times);
  void follow(const FrameInput& input);
  void draw_depth(const FrameInput& input, StopWatch& watch);
  void follow_people(const FrameInput& input);
  void key_people(const FrameInput& input, const ToneCurve& tone, Image<std::uint8_t>& matte);
  void draw_background(StopWatch& watch);
  MovingBackground* colors_of_key() const;
  void draw_objects(StopWatch& watch);
  void draw_peoples_shadows(const Image<std::uint8_t>& matte);
  void light_real(const Image<std::uint8_t>& matte);
  void take_look(const FrameInput& input);
  void use_look(const PictureLook& look);
  void blur_objects(const std::optional<CameraMotion>& motion);
  bool people_cast() const { return !preparer_.params().people_lamps.empty(); }
  MixInput mix_input(const ToneCurve& tone, bool shadows) const;
  void store_warped_depth(Image<float>& depth_m) const;
  void store_light(Image<float>& light) const;
  void store_state(const Image<std::uint8_t>& matte, Image<std::uint8_t>& state) const;

  CompositorSetup setup_;
  Crew crew_;
  Tables tables_;
  FramePreparer preparer_;
  LensFollower lens_;
  std::unique_ptr<MovingBackground> moving_background_;  ///< setup_.background shows its images
  ExposureMeter meter_;
  TofGrid grid_;
  WarpScratch warp_scratch_;
  std::optional<SecondDepth> second_depth_;       ///< of a rig with two depth cameras
  std::optional<PeopleMotion> people_motion_;     ///< of a camera that stands still
  Image<glm::vec2> depth_shift_px_;               ///< of its cells
  Image<float> unmoved_w_;                        ///< once people's depth has moved
  Image<Rgbx16> plate_before_;                    ///< of the frame before, where its matte joins
  Image<std::uint8_t> matte_now_, matte_before_;  ///< the same
  bool has_now_ = false, has_before_ = false;
  KeyScratch key_scratch_;
  VirtualScratch virtual_scratch_;
  PlateScratch plate_scratch_;
  Image<Rgbx16> plate_;
  Image<float> view_w_;
  VirtualLayer objects_;
  std::vector<ShadowMap> shadow_maps_;
  LightLayer light_;
  PeopleShadow people_shadow_;
  std::optional<LookMeter> look_meter_;  ///< until the first frame
  std::optional<PictureLook> look_;      ///< in use; where the look measures
  std::optional<LookFilter> look_filter_;
  bool objects_drawn_ = false;  ///< since they were blurred
  BlurScratch blurred_;
  VirtualLayer moved_;                     ///< where the look has motion: blurred by it
  const VirtualLayer* mixed_ = &objects_;  ///< as they are mixed in this frame
  GrainOf grain_;
  std::uint32_t frames_ = 0;
  FocusScratch focus_scratch_;
  Image<std::uint8_t> matte_;  ///< where it is not wanted
  struct Frame {
    FrameOutput output;
    StageTimes times{};
  };
  InFlight<Frame> flight_;
  StageTimes times_{};
};

CpuCompositor::CpuCompositor(const CompositorSetup& setup, int threads)
    : setup_(setup),
      crew_(threads),
      tables_(make_tables(setup_)),
      preparer_(setup_),
      lens_(setup_),
      meter_(tables_, setup_.background),
      grid_(tables_.tof_size),
      warp_scratch_(tables_.tof_size),
      key_scratch_(tables_.view_size, tables_.tof_footprint_px, crew_.threads()),
      virtual_scratch_(preparer_.params(), tables_.view_size, crew_.threads()),
      plate_scratch_(tables_, crew_.threads()),
      plate_(tables_.view_size),
      view_w_(with_margin(tables_.view_size)),
      shadow_maps_(preparer_.params().lamps.size()) {
  if (!setup_.background_models.empty()) {
    moving_background_ = std::make_unique<MovingBackground>(crew_, setup_);
    setup_.background = moving_background_->view();
    tables_.has_background = true;
    tables_.key_limit_w.reset(tables_.view_size);
  }
  if (setup_.look.measures() && !setup_.objects.empty()) look_meter_.emplace(setup_);
  if (setup_.tof2) second_depth_.emplace(setup_, tables_, grid_);
  if (follows_people(setup_)) {
    people_motion_.emplace(tables_);
    depth_shift_px_.reset(people_motion_->cells());
    if (setup_.key.steady) {
      plate_before_.reset(tables_.view_size);
      matte_now_.reset(tables_.view_size), matte_before_.reset(tables_.view_size);
    }
  }
  tables_.plate_px = {}, tables_.plate_gain = {};  // plate_scratch_ holds them in a faster form
  if (setup_.objects.empty()) return;
  objects_.coverage.reset(tables_.view_size);
  objects_.w.reset(tables_.view_size);
  objects_.normal.reset(tables_.view_size);
  objects_.color.reset(tables_.view_size);
  if (preparer_.params().glossy) objects_.gloss.reset(tables_.view_size);
  if (preparer_.params().emits) objects_.emission.reset(tables_.view_size);
  light_ = LightLayer(tables_.view_size);
  if (setup_.look.motion) {
    moved_.coverage.reset(tables_.view_size);
    moved_.w.reset(tables_.view_size);
    moved_.color.reset(tables_.view_size);
  }
  if (!people_cast()) return;
  people_shadow_ = PeopleShadow(tables_.view_size);
  size_for_people(preparer_.params(), tables_.view_size, objects_);
}

Result<void> CpuCompositor::submit(const FrameInput& input, OutputMask wanted) {
  MIXRIG_TRY(check_frame(input, tables_));
  MIXRIG_ASSIGN(Frame* const slot, flight_.push());
  draw(input, wanted, slot->output, slot->times);
  return {};
}

Result<void> CpuCompositor::compose(const FrameInput& input, FrameOutput& output) {
  if (in_flight() > 0) return Compositor::compose(input, output);
  MIXRIG_TRY(check_frame(input, tables_));
  draw(input, output.wanted, output, times_);
  return {};
}

void CpuCompositor::draw(const FrameInput& input, OutputMask wanted, FrameOutput& output,
                         StageTimes& times) {
  StopWatch watch(times);
  output.wanted = with_needed(wanted, false);
  const bool focuses = setup_.focus && (wanted & kColor);
  if (focuses) output.wanted |= kMixedDepth;
  const NeededPasses needed = needed_passes(output.wanted, setup_);
  const bool own_matte = needed.key && !(output.wanted & kMatte);  // the key writes it
  if (own_matte) std::swap(matte_, output.matte);
  size_outputs(tables_.view_size, needed.key ? output.wanted | kMatte : output.wanted, output);
  follow(input);
  take_look(input);
  watch.lap(Stage::kUpload);
  draw_background(watch);
  const ToneCurve tone = meter_.curve(input.plate);
  const FrameParams& frame = preparer_.params();
  watch.lap(Stage::kUpload);

  if (people_motion_) follow_people(input);
  // What is mixed is drawn over it; where the real background is replaced, mix draws all.
  const bool shows_plate = (output.wanted & kColor) && needed.mix && !setup_.backdrop;
  draw_plate(crew_, input.plate, plate_scratch_, plate_, shows_plate ? &output.color : nullptr);
  watch.lap(Stage::kPlate);
  draw_depth(input, watch);
  if (output.wanted & kWarpedDepth) store_warped_depth(output.warped_depth_m);
  watch.lap(Stage::kReadback);

  draw_objects(watch);
  if (needed.key) key_people(input, tone, output.matte);
  watch.lap(Stage::kKey);
  if (people_cast() && needed.light) draw_peoples_shadows(output.matte);
  const bool shadows = has_shadows(frame);
  if (shadows && needed.light) light_real(output.matte);
  blur_objects(input.motion);
  watch.lap(Stage::kLight);
  if (needed.mix) mix(crew_, mix_input(tone, shadows), output);
  watch.lap(Stage::kMix);
  if (focuses)
    draw_focus(crew_, focus_of(setup_, input), setup_.view.fx_px, focus_scratch_, output);
  watch.lap(Stage::kFocus);
  if (output.wanted & kLight) store_light(output.light);
  if (output.wanted & kState) store_state(output.matte, output.state);
  if (own_matte) std::swap(matte_, output.matte);
  watch.lap(Stage::kReadback);
}

/// What depends on the lens is made again where it has moved, and only there.
void CpuCompositor::follow(const FrameInput& input) {
  const bool moved = lens_.follow(input.lens, setup_, tables_);
  if (moved) {
    plate_scratch_.see_through(crew_, setup_.target, setup_.view);
    meter_.see_through(setup_);
    if (moving_background_) moving_background_->see_through(setup_);
    if (second_depth_) second_depth_->set_view(setup_);
  }
  preparer_.update(lens_.world_from_pupil(input.world_from_target), moved,
                   place_objects(input.world_from_object, setup_), set_light(input.light, setup_));
}

/// Passes correct, agree and warp.
void CpuCompositor::draw_depth(const FrameInput& input, StopWatch& watch) {
  const bool two = second_depth_ && !input.tof2_depth_m.empty();
  if (two)
    second_depth_->correct_both(crew_, tables_, input.tof_depth_m, input.tof2_depth_m, grid_);
  else
    correct(crew_, tables_.correct, tables_.tof_ray, input.tof_depth_m, grid_);
  watch.lap(Stage::kCorrect);
  warp(crew_, tables_, grid_, warp_scratch_, view_w_);
  if (two) second_depth_->add_to(crew_, view_w_);
  watch.lap(Stage::kWarp);
}

/// How people moved since the frame before, whose plate and matte are kept.
void CpuCompositor::follow_people(const FrameInput& input) {
  const bool moves = setup_.key.motion && input.depth_delay_s != 0;
  if (!moves && !setup_.key.steady) return;
  if (!people_motion_->see(input, crew_) || !setup_.key.steady) return;
  std::swap(plate_, plate_before_);
  std::swap(matte_now_, matte_before_);
  has_before_ = std::exchange(has_now_, false);
}

/// The matte and people's depth. This is brought to the time of the plate first.
void CpuCompositor::key_people(const FrameInput& input, const ToneCurve& tone,
                               Image<std::uint8_t>& matte) {
  if (people_motion_ && setup_.key.motion &&
      people_motion_->depth_shift_px(input.depth_delay_s, depth_shift_px_)) {
    if (unmoved_w_.empty()) unmoved_w_.reset(tables_.view_size);
    move_people(crew_, tables_.key_limit_w, depth_shift_px_, people_motion_->cell_px(), unmoved_w_,
                view_w_);
  }
  const bool steady = people_motion_ && setup_.key.steady;
  const Image<glm::vec2>* motion_px = steady ? people_motion_->motion_px() : nullptr;
  std::optional<FrameBefore> before;
  if (motion_px && has_before_)
    before.emplace(FrameBefore{plate_before_, matte_before_, *motion_px, people_motion_->cell_px(),
                               static_cast<int>(std::lround(tables_.tof_footprint_px))});
  key(crew_,
      {tables_, preparer_.params().key, setup_.background, plate_, tone, colors_of_key(),
       before ? &*before : nullptr},
      key_scratch_, view_w_, matte);
  if (!steady) return;
  for (int y = 0; y < matte.height(); ++y)
    std::copy_n(matte.row(y), matte.width(), matte_now_.row(y));
  has_now_ = true;
}

Result<void> CpuCompositor::collect(FrameOutput& output) {
  MIXRIG_ASSIGN(Frame* const slot, flight_.pop());
  deliver(slot->output, output);
  times_ = slot->times;
  return {};
}

MovingBackground* CpuCompositor::colors_of_key() const {
  const bool any = moving_background_ && moving_background_->has_color() && setup_.key.color;
  return any ? moving_background_.get() : nullptr;
}

/// Only where the camera moves; while the pose stays, so does the background.
void CpuCompositor::draw_background(StopWatch& watch) {
  if (!moving_background_ || !preparer_.params().pose_changed) return;
  moving_background_->draw(crew_, preparer_.world_from_camera(), tables_);
  if (moving_background_->has_color())
    for (const ExposureMeter::Place& place : meter_.places())
      moving_background_->draw_color(place.view_x, place.view_y, 1);
  meter_.learn(setup_.background);
  watch.lap(Stage::kBackground);
}

/// Virtual layer, shadow maps and the background's light: while the pose stays, they stay.
void CpuCompositor::draw_objects(StopWatch& watch) {
  const FrameParams& frame = preparer_.params();
  if (!frame.pose_changed || setup_.objects.empty()) return;
  draw_virtual(crew_, frame, virtual_scratch_, objects_);
  objects_drawn_ = true;
  watch.lap(Stage::kVirtual);
  shadow_maps_.resize(frame.lamps.size());
  if (frame.maps_changed) draw_shadow_maps(crew_, frame, shadow_maps_);
  watch.lap(Stage::kShadow);
  const LightInput input{.frame = frame,
                         .tables = tables_,
                         .background = setup_.background,
                         .maps = shadow_maps_,
                         .moving = moving_background_.get()};
  shade_virtual(crew_, input, objects_);
  if (has_shadows(frame) && !setup_.backdrop) light_background(crew_, input, light_);
  watch.lap(Stage::kLight);
}

/// People move in every frame.
void CpuCompositor::draw_peoples_shadows(const Image<std::uint8_t>& matte) {
  const FrameParams& frame = preparer_.params();
  draw_people_maps(crew_, frame, tables_.warp.view, view_w_, matte, people_shadow_);
  const LightInput input{.frame = frame,
                         .tables = tables_,
                         .background = setup_.background,
                         .maps = shadow_maps_,
                         .people = &people_shadow_};
  shade_behind_people(crew_, input, objects_);
  objects_drawn_ = true;
}

void CpuCompositor::light_real(const Image<std::uint8_t>& matte) {
  const LightInput input{.frame = preparer_.params(),
                         .tables = tables_,
                         .background = setup_.background,
                         .maps = shadow_maps_,
                         .moving = moving_background_.get(),
                         .people = people_cast() && !setup_.backdrop ? &people_shadow_ : nullptr};
  light_visible_background(crew_, input, light_);
  light_people(crew_, input, view_w_, matte, light_);
}

/// What virtual things take on of the plate: as the frame says, else found in the first frame;
/// grain moves in each.
void CpuCompositor::take_look(const FrameInput& input) {
  grain_.offset = grain_offset(frames_++);
  if (!setup_.look.measures() || setup_.objects.empty()) return;
  if (input.look != nullptr)
    use_look(*input.look);
  else if (look_meter_)
    use_look(measured_first(*look_meter_, input.plate));
  look_meter_.reset();
}

/// How alike the noise of neighbours is stays as it was first: the table of noise is not made
/// again.
void CpuCompositor::use_look(const PictureLook& look) {
  const PictureLook wanted = wanted_of(look, setup_.look);
  if (look_ == wanted) return;
  look_ = wanted;
  look_filter_.reset();
  if (wanted.filters()) look_filter_ = look_filter(wanted);
  objects_drawn_ = true;
  grain_.grain = wanted.grain;
  if (wanted.grain.any() && grain_.noise.empty()) grain_.noise = make_grain(wanted.grain);
}

/// By the lens, then by the camera's motion.
void CpuCompositor::blur_objects(const std::optional<CameraMotion>& motion) {
  mixed_ = &objects_;
  if (setup_.objects.empty()) return;
  if (look_filter_) {
    if (objects_drawn_) blur_layer(crew_, *look_filter_, objects_, blurred_);
    mixed_ = &blurred_.layer;
  }
  objects_drawn_ = false;
  if (!setup_.look.motion) return;
  const MotionParams params = motion_params(motion, setup_.view, preparer_.params());
  if (!params.blurs()) return;
  blur_by_motion(crew_, params, *mixed_, moved_);
  mixed_ = &moved_;
}

MixInput CpuCompositor::mix_input(const ToneCurve& tone, bool shadows) const {
  const bool edges = !moving_background_ && !tables_.edge_depth_m.empty();
  return {.background = setup_.background,
          .room_m = edges ? tables_.edge_depth_m.view() : setup_.background.depth_m,
          .plate = plate_,
          .view_w = view_w_,
          .objects = setup_.objects.empty() ? nullptr : mixed_,
          .light = shadows ? &light_ : nullptr,
          .tone = tone,
          .key = &key_scratch_,
          .grain = grain_.any() ? &grain_ : nullptr,
          .open_walls = setup_.open_walls,
          .replaced = setup_.backdrop.has_value(),
          .backdrop = setup_.backdrop ? setup_.backdrop->picture : ImageView<const Rgb8>{}};
}

void CpuCompositor::store_warped_depth(Image<float>& depth_m) const {
  for (int y = 0; y < depth_m.height(); ++y)
    for (int x = 0; x < depth_m.width(); ++x) {
      const float w = view_w_.row(y)[x];
      depth_m.row(y)[x] = w > 0 ? 1 / w : 0;
    }
}

void CpuCompositor::store_light(Image<float>& light) const {
  const bool has_light = has_shadows(preparer_.params());
  for (int y = 0; y < light.height(); ++y)
    for (int x = 0; x < light.width(); ++x)
      light.row(y)[x] =
          has_light ? static_cast<float>(light_.visible.row(y)[x]) / kLinearOne : 1.0F;
}

void CpuCompositor::store_state(const Image<std::uint8_t>& matte,
                                Image<std::uint8_t>& state) const {
  for (int y = 0; y < state.height(); ++y)
    std::copy_n(key_scratch_.state.row(y), state.width(), state.row(y));
  decide_states(matte, state);
}

std::string CpuCompositor::renderer() const {
  return fmt::format("cpu, {} threads, {}", crew_.threads(), vectors());
}

std::string vectors() {
  return fmt::format("{} ({}, {} lanes)", MIXRIG_CPU_LEVEL, kVectorName, kLanes);
}

Result<std::unique_ptr<Compositor>> make(const CompositorSetup& setup, int threads) {
  MIXRIG_TRY(validate(setup));
  return std::unique_ptr<Compositor>(std::make_unique<CpuCompositor>(setup, threads));
}

}  // namespace
}  // namespace mixrig::render

const mixrig::render::CpuBackEnd MIXRIG_CPU_BACK_END{mixrig::render::door_layout(),
                                                     mixrig::render::make, mixrig::render::vectors};
