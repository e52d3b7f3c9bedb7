// SPDX-License-Identifier: Apache-2.0
// The passes of a scene, made once with the compositor.
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
  /// Makes the passes that the setup needs. Borrows `setup`, `frame` and `hidden`. `hidden`: null if no frame hides objects. Sets tables.has_background
  /// and empties images of the tables that only the GPU needs. Errors: those of the passes.
  static Result<Passes> create(const CompositorSetup& setup, Tables& tables,
                               std::span<const ExposureMeter::Place> places,
                               const FrameParams& frame, const HiddenObjects* hidden);
  /// Sets another view of the same size.
  void set_view(const CompositorSetup& setup, const Tables& tables);
  /// Takes the look of a frame.
  void take_look(const FrameInput& input);

  Room room;
  PlatePass plate;
  CorrectPass correct;
  WarpPass warp;
  std::optional<SecondDepthPass> second_depth;  ///< with two depth cameras
  std::optional<PeopleKey> key;                 ///< if anything is keyed
  std::optional<VirtualThings> all_things;      ///< if there are objects
  std::optional<VirtualThings> set_things;      ///< objects of HiddenObjects, if there are any
  MixPass mix;
  std::optional<FocusPass> focus;
};

}  // namespace mixrig::render::gles
