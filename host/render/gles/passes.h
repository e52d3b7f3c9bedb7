// SPDX-License-Identifier: Apache-2.0
// The passes that a scene needs, made once.
#pragma once

#include <optional>
#include <span>

#include "host/render/gles/background/room.h"
#include "host/render/gles/key/people_key.h"
#include "host/render/gles/mix/focus_pass.h"
#include "host/render/gles/mix/mix_pass.h"
#include "host/render/gles/plate/correct_pass.h"
#include "host/render/gles/plate/plate_pass.h"
#include "host/render/gles/virtual/virtual_things.h"
#include "host/render/gles/warp/second_depth_pass.h"
#include "host/render/gles/warp/warp_pass.h"
#include "host/render/tables/hidden_objects.h"

namespace mixrig::render::gles {

struct Passes {
  /// Borrows `setup`, `frame` and `hidden`, and `tables` where the key follows people. `hidden`:
  /// null where no frame hides objects. Sets tables.has_background; images of the tables that only
  /// the GPU needs are empty afterwards. Errors: those of the passes.
  static Result<Passes> create(const CompositorSetup& setup, Tables& tables,
                               std::span<const ExposureMeter::Place> places,
                               const FrameParams& frame, const HiddenObjects* hidden);
  /// Another view of the same size.
  void set_view(const CompositorSetup& setup, const Tables& tables);
  /// Takes the look of a frame.
  void take_look(const FrameInput& input);

  Room room;
  PlatePass plate;
  CorrectPass correct;
  WarpPass warp;
  std::optional<SecondDepthPass> second_depth;  ///< of a rig with two depth cameras
  std::optional<PeopleKey> key;                 ///< where anything is keyed
  std::optional<VirtualThings> all_things;      ///< where there are any
  std::optional<VirtualThings> set_things;      ///< those of HiddenObjects, where there are any
  MixPass mix;
  std::optional<FocusPass> focus;
};

}  // namespace mixrig::render::gles
