// SPDX-License-Identifier: Apache-2.0
#include "host/render/gles/passes.h"

namespace mixrig::render::gles {
namespace {

/// Makes the passes of virtual things; none if the frame draws no object.
Result<void> create_things(const CompositorSetup& setup, const Tables& tables,
                           const FrameParams& frame, std::optional<VirtualThings>& things) {
  if (frame.draws.empty()) return {};
  MIXRIG_ASSIGN(things, VirtualThings::create(setup, tables, frame));
  return {};
}

void drop_uploaded(Tables& tables) {
  tables.tof_ray = tables.plate_px = {};
  tables.plate_gain = {};
  tables.key_limit_w = {}, tables.hole_behind_w = {};
  tables.background_normal = {};
  tables.light_depth_m = tables.edge_depth_m = {};
}

}  // namespace

Result<Passes> Passes::create(const CompositorSetup& setup, Tables& tables,
                              std::span<const ExposureMeter::Place> places,
                              const FrameParams& frame, const HiddenObjects* hidden) {
  Passes passes;
  MIXRIG_ASSIGN(passes.plate, PlatePass::create(setup, tables.plate_is_view));
  MIXRIG_ASSIGN(passes.correct, CorrectPass::create(tables));
  MIXRIG_ASSIGN(passes.warp, WarpPass::create(tables));
  if (setup.tof2) {
    MIXRIG_ASSIGN(passes.second_depth, SecondDepthPass::create(setup, tables));
  }
  MIXRIG_ASSIGN(passes.room, Room::create(setup, tables, places));
  if (frame.key.by != KeyBy::kNothing) {
    MIXRIG_ASSIGN(passes.key, PeopleKey::create(setup, tables, passes.room.has_color(), frame.key));
  }
  MIXRIG_TRY(create_things(setup, tables, frame, passes.all_things));
  if (hidden != nullptr)
    MIXRIG_TRY(
        create_things(hidden->setup(), tables, hidden->preparer().params(), passes.set_things));
  MIXRIG_ASSIGN(passes.mix, MixPass::create(tables, setup));
  if (setup.focus) {
    MIXRIG_ASSIGN(passes.focus, FocusPass::create(tables, setup));
  }
  drop_uploaded(tables);
  return passes;
}

void Passes::set_view(const CompositorSetup& setup, const Tables& tables) {
  warp.set_view(tables);
  if (second_depth) second_depth->set_view(setup);
  room.set_view(tables, setup);
  if (key) key->set_view(tables);
  if (all_things) all_things->set_view(tables);
  if (set_things) set_things->set_view(tables);
}

void Passes::take_look(const FrameInput& input) {
  if (all_things) all_things->take_look(input);
  if (set_things) set_things->take_look(input);
}

}  // namespace mixrig::render::gles
