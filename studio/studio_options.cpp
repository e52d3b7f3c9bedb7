// SPDX-License-Identifier: Apache-2.0
#include "studio/studio_options.h"

#include <utility>

#include <fmt/format.h>

#include "studio/stage/layout.h"
#include "studio/stage/room.h"

namespace mixrig::studio {
namespace {

Result<void> check_place(const StudioOptions& o) {
  const auto in_room = [](const std::optional<Eigen::Vector3d>& at_m) {
    return !at_m || ((at_m->array() > 0.05).all() && at_m->x() < kRoomX_m - 0.05 &&
                     at_m->y() < kRoomY_m - 0.05 && at_m->z() < kRoomZ_m - 0.05);
  };
  if (!in_room(o.eye_m) || !in_room(o.look_at_m))
    return Error{ErrorCode::kUsage,
                 fmt::format("studio: the camera and what it looks at must be in the room of "
                             "{} x {} x {} m, 5 cm off its walls",
                             kRoomX_m, kRoomY_m, kRoomZ_m)};
  if (const auto& at_m = o.object_m;
      at_m && !(at_m->minCoeff() > 0.4 && at_m->x() < kRoomX_m - 0.4 && at_m->y() < kRoomY_m - 0.4))
    return Error{ErrorCode::kUsage,
                 "studio: the object must stand in the room, 0.4 m off its walls"};
  const Layout layout = make_layout(o);
  const Eigen::Vector3d ahead = layout.look_at_m - layout.eye_m;
  if (ahead.cross(Eigen::Vector3d::UnitZ()).norm() < 0.05)
    return Error{
        ErrorCode::kUsage,
        "studio: the camera looks straight up or down, or stands where it looks: move one"};
  return {};
}

}  // namespace

Result<void> check_studio_options(const StudioOptions& o) {
  const auto wrong = [](std::string what) {
    return Error{ErrorCode::kUsage, "studio: " + std::move(what)};
  };
  if (o.frames < 2 || o.frames > 100000)
    return wrong(fmt::format("frames must be 2 to 100000, not {}", o.frames));
  if (!(o.tolerance >= 0 && o.tolerance <= 2))
    return wrong(fmt::format("tolerance must be 0 to 2, not {}", o.tolerance));
  for (const int side : {o.size_px.width, o.size_px.height})
    if (side < 32 || side > 4096)
      return wrong(fmt::format("size must be 32 to 4096 pixels per side, not {}x{}",
                               o.size_px.width, o.size_px.height));
  if (o.people < 1 || o.people > 3)
    return wrong(fmt::format("people must be 1 to 3, not {}", o.people));
  if (o.scenario == Scenario::kRounds && o.people > 2)
    return wrong("scenario rounds has at most 2 people: a third would stand in the way");
  if (o.day.crowd < 0 || o.day.crowd > 8)
    return wrong(fmt::format("the crowd must be 0 to 8 people, not {}", o.day.crowd));
  if (!(o.day.lamp_level >= 0 && o.day.lamp_level <= 2))
    return wrong(fmt::format("the lamps' level must be 0 to 2, not {}", o.day.lamp_level));
  if (o.day.dim && !(o.day.dim->lamp >= 1 && o.day.dim->lamp <= 4 && o.day.dim->level >= 0 &&
                     o.day.dim->level <= 2))
    return wrong("the lamp to dim must be 1 to 4, its level 0 to 2");
  if (o.day.moved_chair && o.clear_floor)
    return wrong("a clear floor has no chair that could be moved: drop one of the two");
  if (o.scenario == Scenario::kSweep && !o.sweep.views.empty() &&
      (o.sweep.frames_per_view < 1 ||
       static_cast<std::size_t>(o.frames) != o.sweep.views.size() * o.sweep.frames_per_view))
    return wrong("frames of a sweep must be its views times the frames of a view");
  if (!(o.pan_rad >= 0 && o.pan_rad <= 2))
    return wrong(fmt::format("the pan must be 0 to 2 radians to a side, not {}", o.pan_rad));
  for (const int side : {o.fisheye_px.width, o.fisheye_px.height})
    if (side < 64 || side > 4096)
      return wrong(fmt::format("the fisheye must have 64 to 4096 pixels per side, not {}x{}",
                               o.fisheye_px.width, o.fisheye_px.height));
  if (!(o.zoom >= 1 && o.zoom <= 8))
    return wrong(fmt::format("the zoom must be 1 to 8 times, not {}", o.zoom));
  if (o.zoom > 1 && o.scenario == Scenario::kSweep)
    return wrong("a sweep has a fixed lens: leave out the zoom");
  if (o.raw && o.rig != RigPreset::kKinect2)
    return wrong("raw pictures are those of rig kinect2: give --rig kinect2, or leave out --raw");
  if (o.raw && o.second_tof)
    return wrong("raw pictures are those of one depth camera: leave out the second, or --raw");
  if (o.window && o.realism.mirror)
    return wrong("window and mirror have one place: drop one of the two");
  MIXRIG_TRY(check_place(o));
  if (!(o.lens.aperture_m >= 0 && o.lens.aperture_m <= 0.2 && o.lens.focus_m >= 0.1 &&
        o.lens.focus_m <= 100))
    return wrong("the lens must have an aperture of 0 to 200 mm and be sharp at 0.1 to 100 m");
  const Realism& look = o.realism;
  if (o.refocus && !(look.defocus && o.refocus->focus_m >= 0.1 && o.refocus->focus_m <= 100))
    return wrong("a lens that is focused anew needs the look \"defocus\" and 0.1 to 100 m");
  if (o.lens.aperture_m > 0 && (look.bounce || look.gloss || look.mirror || o.props))
    return wrong("the thin lens knows the plain look alone: add --plain, leave out --props");
  if (o.threads < 0 || o.threads > 256)
    return wrong(fmt::format("threads must be 0 to 256, not {}", o.threads));
  return {};
}

}  // namespace mixrig::studio
