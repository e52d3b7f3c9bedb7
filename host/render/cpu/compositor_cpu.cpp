// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "hal/base/cpu_level.h"
#include "hal/base/parallel.h"
#include "host/render/contract/frame_io.h"
#include "host/render/contract/in_flight.h"
#include "host/render/cpu/back_end.h"
#include "host/render/cpu/background/background.h"
#include "host/render/cpu/key/people_key.h"
#include "host/render/cpu/mix/focus.h"
#include "host/render/cpu/mix/mix.h"
#include "host/render/cpu/plate/correct.h"
#include "host/render/cpu/plate/plate.h"
#include "host/render/cpu/simd.h"
#include "host/render/cpu/stop_watch.h"
#include "host/render/cpu/virtual/virtual_things.h"
#include "host/render/cpu/warp/draw_quads.h"
#include "host/render/cpu/warp/second_depth.h"
#include "host/render/cpu/warp/warp.h"
#include "host/render/frame/exposure.h"
#include "host/render/frame/focus_discs.h"
#include "host/render/tables/hidden_objects.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render {
namespace {

using namespace cpu;  // NOLINT(google-build-using-namespace)

std::string vectors();

class CpuCompositor final : public Compositor {
 public:
  CpuCompositor(const CompositorSetup& setup, int threads);
  Result<void> submit(const FrameInput& input, OutputMask wanted) override;
  Result<void> collect(FrameOutput& output) override;
  Result<void> compose(const FrameInput& input, FrameOutput& output) override;
  int in_flight() const override { return flight_.count(); }
  const CompositorState& state() const override { return state_; }

 private:
  void draw(const FrameInput& input, OutputMask wanted, FrameOutput& output, StageTimes& times);
  void follow(const FrameInput& input);
  void draw_depth(const FrameInput& input, StopWatch& watch);
  void key_people(const ToneCurve& tone, Image<std::uint8_t>& matte);
  void draw_background(StopWatch& watch);
  MovingBackground* colors_of_key() const;
  MixInput mix_input(const ToneCurve& tone) const;
  void store_warped_depth(Image<float>& depth_m) const;
  void store_light(Image<float>& light) const;
  void store_state(const Image<std::uint8_t>& matte, Image<std::uint8_t>& state) const;

  CompositorSetup setup_;
  Crew crew_;
  Tables tables_;
  FramesOfSetup frames_;
  LensFollower lens_;
  const FramePreparer* frame_ = &frames_.with_objects();  ///< preparer of this frame
  std::unique_ptr<MovingBackground> moving_background_;
  const FramePreparer* background_by_ = nullptr;  ///< preparer when the background was last drawn
  BackgroundView background_;                     ///< of the setup, or of moving_background_
  ExposureMeter meter_;
  TofGrid grid_;
  WarpScratch warp_scratch_;
  std::optional<SecondDepth> second_depth_;  ///< with two depth cameras
  PeopleKey people_key_;
  PlateScratch plate_scratch_;
  Image<Rgbx16> plate_;
  Image<float> view_w_;
  /// Virtual things of all objects, and those of frames_.hidden(); empty if there are none.
  std::optional<VirtualThings> all_things_, set_things_;
  VirtualThings* things_ = nullptr;  ///< of this frame
  FocusScratch focus_scratch_;
  Image<std::uint8_t> matte_;  ///< used if the matte is not wanted
  struct Frame {
    FrameOutput output;
    StageTimes times{};
  };
  InFlight<Frame> flight_;
  CompositorState state_;
};

CpuCompositor::CpuCompositor(const CompositorSetup& setup, int threads)
    : setup_(setup),
      crew_(threads),
      tables_(make_tables(setup_)),
      frames_(setup_),
      lens_(setup_),
      background_(setup_.background),
      meter_(tables_, background_),
      grid_(tables_.tof_size),
      warp_scratch_(tables_.tof_size),
      people_key_(setup_, tables_, crew_.threads()),
      plate_scratch_(tables_, crew_.threads()),
      plate_(tables_.view_size),
      view_w_(with_margin(tables_.view_size)) {
  state_.renderer = fmt::format("cpu, {} threads, {}", crew_.threads(), vectors());
  if (!setup_.background_models.empty()) {
    moving_background_ = std::make_unique<MovingBackground>(crew_, setup_);
    background_ = moving_background_->view();
    tables_.has_background = true;
    tables_.key_limit_w.reset(tables_.view_size);
    tables_.hole_behind_w.reset(tables_.view_size);
  }
  if (setup_.tof2) second_depth_.emplace(setup_, tables_, grid_);
  tables_.plate_px = {}, tables_.plate_gain = {};  // plate_scratch_ holds them in a faster form
  if (!setup_.objects.empty())
    all_things_.emplace(setup_, background_, tables_, frames_.with_objects().params(),
                        crew_.threads());
  const HiddenObjects* const hidden = frames_.hidden();
  if (hidden != nullptr && !hidden->setup().objects.empty())
    set_things_.emplace(hidden->setup(), background_, tables_, hidden->preparer().params(),
                        crew_.threads());
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
  draw(input, output.wanted, output, state_.stage_times);
  return {};
}

void CpuCompositor::draw(const FrameInput& input, OutputMask wanted, FrameOutput& output,
                         StageTimes& times) {
  StopWatch watch(times);
  output.wanted = with_needed(wanted, false);
  const bool focuses = setup_.focus && (wanted & kColor);
  if (focuses) output.wanted |= kMixedDepth;
  follow(input);
  const NeededPasses needed = needed_passes(output.wanted, things_ != nullptr, setup_);
  // The key needs an image to write.
  const bool own_matte = needed.key && !(output.wanted & kMatte);
  if (own_matte) std::swap(matte_, output.matte);
  size_outputs(tables_.view_size, needed.key ? output.wanted | kMatte : output.wanted, output);
  if (all_things_) all_things_->take_look(input);
  if (set_things_) set_things_->take_look(input);
  watch.lap(Stage::kUpload);
  draw_background(watch);
  const ToneCurve tone = meter_.curve(input.plate);
  watch.lap(Stage::kUpload);

  people_key_.follow(input, plate_);
  // Mix draws over the plate; where the real background is replaced, mix draws everything.
  const bool shows_plate = (output.wanted & kColor) && needed.mix && !setup_.backdrop;
  draw_plate(crew_, input.plate, plate_scratch_, plate_, shows_plate ? &output.color : nullptr);
  watch.lap(Stage::kPlate);
  draw_depth(input, watch);
  if (output.wanted & kWarpedDepth) store_warped_depth(output.warped_depth_m);
  watch.lap(Stage::kReadback);

  if (things_) things_->draw(crew_, moving_background_.get(), watch);
  if (needed.key) key_people(tone, output.matte);
  watch.lap(Stage::kKey);
  if (things_ && needed.light)
    things_->light_real(crew_, moving_background_.get(), view_w_, output.matte);
  if (things_) things_->blur(crew_, input.motion);
  watch.lap(Stage::kLight);
  if (needed.mix) mix(crew_, mix_input(tone), output);
  watch.lap(Stage::kMix);
  if (focuses)
    draw_focus(crew_, focus_of(setup_, input), setup_.view.fx_px, focus_scratch_, output);
  watch.lap(Stage::kFocus);
  if (output.wanted & kLight) store_light(output.light);
  if (output.wanted & kState) store_state(output.matte, output.state);
  if (own_matte) std::swap(matte_, output.matte);
  watch.lap(Stage::kReadback);
}

/// Rebuilds what depends on the lens, only if it has moved.
void CpuCompositor::follow(const FrameInput& input) {
  const bool moved = lens_.follow(input.lens, setup_, tables_);
  if (moved) {
    plate_scratch_.see_through(crew_, setup_.target, setup_.view);
    meter_.see_through(setup_);
    if (moving_background_) moving_background_->see_through(setup_);
    if (second_depth_) second_depth_->set_view(setup_);
  }
  const SetupChanges changes{moved, place_objects(input.world_from_object, setup_),
                             set_light(input.light, setup_)};
  frame_ = &frames_.update(lens_.world_from_pupil(input.world_from_target), changes,
                           !input.objects_shown);
  std::optional<VirtualThings>& things = frames_.hides() ? set_things_ : all_things_;
  things_ = things ? &*things : nullptr;
}

/// Runs passes correct, agree and warp.
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

Result<void> CpuCompositor::collect(FrameOutput& output) {
  MIXRIG_ASSIGN(Frame* const slot, flight_.pop());
  deliver(slot->output, output);
  state_.stage_times = slot->times;
  return {};
}

/// Computes the matte and people's depth.
void CpuCompositor::key_people(const ToneCurve& tone, Image<std::uint8_t>& matte) {
  people_key_.key(crew_,
                  {tables_, frame_->params().key, background_, plate_, tone, colors_of_key()},
                  view_w_, matte);
}

MovingBackground* CpuCompositor::colors_of_key() const {
  const bool any = moving_background_ && moving_background_->has_color() && setup_.key.color;
  return any ? moving_background_.get() : nullptr;
}

/// Draws the colours of places, evenly spaced ones of a row together.
void draw_colors_at(std::span<const ExposureMeter::Place> places, MovingBackground& background) {
  for (std::size_t i = 0, end = 0; i < places.size(); i = end) {
    const int x = places[i].view_x, y = places[i].view_y;
    const auto beyond = [&](std::size_t k) {
      return k < places.size() && places[k].view_y == y ? places[k].view_x - places[k - 1].view_x
                                                        : 0;
    };
    const int step = beyond(end = i + 1);
    while (step > 0 && end - i < MovingBackground::kMostColumns && beyond(end) == step) ++end;
    background.draw_color(x, y, static_cast<int>(end - i), std::max(step, 1));
  }
}

/// Draws the background of a moving camera, if the pose has changed.
void CpuCompositor::draw_background(StopWatch& watch) {
  if (!moving_background_) return;
  if (std::exchange(background_by_, frame_) == frame_ && !frame_->params().pose_changed) return;
  moving_background_->draw(crew_, frame_->world_from_camera(), tables_, things_ != nullptr);
  if (moving_background_->has_color()) draw_colors_at(meter_.places(), *moving_background_);
  meter_.learn(background_);
  watch.lap(Stage::kBackground);
}

MixInput CpuCompositor::mix_input(const ToneCurve& tone) const {
  const bool edges = !moving_background_ && things_ && !tables_.edge_depth_m.empty();
  return {.background = background_,
          .room_m = edges ? tables_.edge_depth_m.view() : background_.depth_m,
          .plate = plate_,
          .view_w = view_w_,
          .objects = things_ ? &things_->mixed() : nullptr,
          .light = things_ ? things_->light() : nullptr,
          .tone = tone,
          .key = &people_key_.scratch(),
          .grain = things_ ? things_->grain() : nullptr,
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
  const LightLayer* const layer = things_ ? things_->light() : nullptr;
  if (layer == nullptr) return light.fill(1);
  for (int y = 0; y < light.height(); ++y)
    for (int x = 0; x < light.width(); ++x)
      light.row(y)[x] = static_cast<float>(layer->visible.row(y)[x]) / kLinearOne;
}

void CpuCompositor::store_state(const Image<std::uint8_t>& matte,
                                Image<std::uint8_t>& state) const {
  for (int y = 0; y < state.height(); ++y)
    std::copy_n(people_key_.scratch().state.row(y), state.width(), state.row(y));
  decide_states(matte, state);
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
