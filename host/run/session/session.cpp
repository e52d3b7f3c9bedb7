// SPDX-License-Identifier: Apache-2.0
#include "host/run/session/session.h"

#include <fmt/format.h>

#include "hal/base/log.h"
#include "host/capture/capture/calibrated_source.h"
#include "host/capture/capture/unwrapped_source.h"
#include "host/math/image_io/scale.h"
#include "host/pose/source/world_frame.h"
#include "host/room/background/learn.h"
#include "host/room/lamps/found_lamps.h"
#include "host/room/scan/room_file.h"
#include "host/run/session/camera_pose.h"
#include "host/scene/pose_kind.h"

namespace mixrig::session {
namespace {

/// Adds the set that replaces the real background, if there is one. Its picture fills the view.
void add_set(Session& session) {
  if (!session.scene.set) return;
  const Image<Rgb8>& picture = session.scene.set->picture;
  if (!session.scene.set->model && session.scene.set->picture_path.empty())
    log_warning("session", session.scene.path.string() +
                               ": set: neither model nor picture: the real background becomes "
                               "black, and transparent in alpha/");
  if (!picture.empty())
    session.backdrop = image_io::scaled_to_fill(picture, session.setup.view.size_px);
  session.setup.backdrop = render::Backdrop{session.backdrop};
}

/// Adds the scene's file and key to an error.
Error at_key(const Session& session, const char* key, Error error) {
  error.context = session.scene.path.string() + ": " + key + ": " + error.context;
  return error;
}

std::string view_text(const geometry::Pinhole& view) {
  return fmt::format("{}x{} (f {:.1f} {:.1f}, c {:.1f} {:.1f} px)", view.size_px.width,
                     view.size_px.height, view.fx_px, view.fy_px, view.cx_px, view.cy_px);
}

Result<std::unique_ptr<capture::CaptureSource>> open_any_source(const SessionOptions& options,
                                                                Session& session) {
  const std::string& uri = options.source;
  if (uri != "rig" && !uri.starts_with("rig:")) return open_source(uri, options.kinds);
  if (options.clock == nullptr || options.stop == nullptr)
    return Error{ErrorCode::kUsage, "--source " + uri + ": only mixrig run accepts live devices"};
  session.cameras = std::make_shared<live::CameraSettings>();
  session.rig = std::make_shared<live::RunningRig>();
  return open_rig(uri.size() > 4 ? uri.substr(4) : "rig.toml", session.scene, *options.stop,
                  *options.clock, options.kinds, options.play, session.cameras, session.rig,
                  may_take_gles(session.backend));
}

calibration_file::CalibrationChoice choose_calibration(const SessionOptions& options,
                                                       const Session& session) {
  const capture::SourceInfo& info = session.source->info();
  return calibration_file::choose_calibration({.option = options.calibration,
                                               .scene = session.scene.calibration,
                                               .source = info.calibration,
                                               .inline_tables = info.camera_tables,
                                               .reported = info.reported,
                                               .scene_file = session.scene.path,
                                               .source_file = info.file});
}

/// Learned from frames without a pose, the background has no place, which it needs where the camera
/// moves and beside a room.
Result<void> check_place(const Session& session, FrameRange learned, bool has_room,
                         const model::StaticBackground& background) {
  const bool moves = session.poses && session.poses->info().moves;
  if (background.world_from_view || !(moves || has_room)) return {};
  return Error{
      ErrorCode::kData,
      fmt::format(
          "{}, but the pose is not known at any of the frames {}-{}, so that what is learned "
          "has no place: learn from frames with poses, or use a scanned one alone",
          moves ? "the camera moves" : "the background is joined with a room", learned.first,
          learned.second)};
}

/// The pictures stay in the session; the setup sees them.
void add_room(Session& session, const model::PlacedRoom& placed,
              const geometry::Pose& world_from_base, Crew& crew) {
  const model::RoomFaces& faces =
      session.rooms.emplace_back(model::make_faces(placed.room.panorama, crew));
  render::BackgroundModel model;
  model.camera = faces.camera;
  for (const geometry::Pose& base_from_face : faces.base_from_face)
    model.world_from_face.push_back(world_from_base * base_from_face);
  model.depth_m = faces.depth_m, model.depth_sigma_m = faces.depth_sigma_m;
  model.color = faces.color, model.color_factor = faces.color_factor;
  session.setup.background_models.push_back(std::move(model));
}

/// A scanned room, or several joined ones, placed by the scene, or where its own frames had poses.
Result<void> use_room(Session& session, const std::filesystem::path& folder) {
  const scene::Scene& scene = session.scene;
  auto rooms = model::load_rooms(folder);
  if (!rooms) return at_key(session, "background.model", std::move(rooms).error());
  const model::RoomManifest& first = rooms->front().room.manifest;
  geometry::Pose world_from_base;
  if (scene.background.world_from_base)
    world_from_base = *scene.background.world_from_base;
  else if (first.world_from_base)
    world_from_base = *first.world_from_base;
  else if (scene.pose_source == scene::PoseSource::kPanTilt)
    world_from_base = scene.camera.world_from_base;
  else
    return at_key(session, "background.model",
                  {ErrorCode::kFormat,
                   folder.string() +
                       " is a room, whose origin is the foot of the pan-tilt unit: say where that "
                       "stands by background.world_from_base"});
  if (session.setup.vignetting.is_none()) session.setup.vignetting = first.vignetting;
  if (rooms->size() + (scene.background.learn ? 1 : 0) > render::kMostModels)
    return at_key(session, "background.learn",
                  {ErrorCode::kFormat,
                   folder.string() + " joins as many rooms as can be drawn: remove learn"});
  Crew crew;
  session.rooms.reserve(rooms->size());
  for (const model::PlacedRoom& placed : *rooms)
    add_room(session, placed, world_from_base * placed.first_from_base, crew);
  return {};
}

/// One view of the room, from a folder.
Result<model::StaticBackground> loaded_background(const Session& session,
                                                  const std::filesystem::path& folder) {
  MIXRIG_ASSIGN(auto background, model::load_static_background(folder));
  const bool moves = session.poses && session.poses->info().moves;
  if (session.setup.lens_moves && !moves) return background;
  if (moves && !background.world_from_view)
    return Error{ErrorCode::kData,
                 "background " + folder.string() +
                     " does not say from where it was learned, and the camera moves: scan it "
                     "again from a take with poses"};
  if (!moves && !(background.view == session.setup.view))
    return Error{ErrorCode::kData, "background " + folder.string() + " was learned in the view " +
                                       view_text(background.view) + ", this take's is " +
                                       view_text(session.setup.view) +
                                       ": scan it again with this rig and size"};
  return background;
}

/// One view of the room, from frames of the source.
Result<model::StaticBackground> learned_background(Session& session, FrameRange frames,
                                                   bool has_room, const ProgressFn& progress) {
  auto learned = learn_background(*session.source, session.setup, frames, session.backend, progress,
                                  session.poses.get());
  if (!learned) return at_key(session, "background.learn", std::move(learned).error());
  if (auto fine = check_place(session, frames, has_room, *learned); !fine)
    return at_key(session, "background.learn", std::move(fine).error());
  return learned;
}

/// Places the background for a camera that stands still while its lens zooms: it is drawn again for
/// each lens, from the camera's place.
Result<void> place_still_background(Session& session) {
  model::StaticBackground& b = *session.background;
  const bool own = !session.scene.background.model;
  const bool on_floor = session.scene.pose_source == scene::PoseSource::kFloor;
  const bool by_source =
      scene::kind_of(session.scene.pose_source).world == scene::PoseWorld::kOfFrames;
  if (b.world_from_view && (by_source || (own && !on_floor))) return {};
  if (by_source)
    return Error{ErrorCode::kData,
                 "background " + session.scene.background.model->string() +
                     " does not say from where it was learned, and the lens zooms: scan it again "
                     "from a take with poses"};
  geometry::Pose world_from_target;  // pose = "floor" is made after this, in the same way
  if (on_floor && b.floor) world_from_target = world_from_camera_on_floor(*b.floor);
  if (session.poses) world_from_target = session.poses->pose_of({}).world_from_target;
  b.world_from_view =
      world_from_target * (own && b.world_from_view ? *b.world_from_view : geometry::Pose{});
  return {};
}

/// The learned view of a camera that moves, or beside a room, drawn for each pose.
void use_wide_view(Session& session) {
  const model::StaticBackground& b = *session.background;
  session.wide_color = learned_colors(b.color, b.color_sigma);
  session.setup.background_models.push_back(
      {b.view, {*b.world_from_view}, b.depth_m, b.depth_sigma_m, session.wide_color});
}

}  // namespace

geometry::Pinhole resized(const geometry::Pinhole& view, Size size) {
  const double sx = static_cast<double>(size.width) / view.size_px.width;
  const double sy = static_cast<double>(size.height) / view.size_px.height;
  // Pixel centres are whole numbers, so the corner of the picture is at -0.5 at every size.
  return {size, view.fx_px * sx, view.fy_px * sy, (view.cx_px + 0.5) * sx - 0.5,
          (view.cy_px + 0.5) * sy - 0.5};
}

namespace {

/// Warns of a depth camera that hardly anybody mounts so far from the colour camera.
void check_mounting(const capture::SourceInfo& info) {
  constexpr double kFar_m = 1;
  const auto check = [&](const char* camera, const geometry::Pose& target_from) {
    const double away_m = target_from.translation_m.norm();
    if (away_m > kFar_m)
      log_warning("session",
                  fmt::format("{}: the cameras \"target\" and \"{}\" stand {:.2f} m apart: if "
                              "that is wrong, correct translation_m, which is in metres",
                              info.name, camera, away_m));
  };
  check("tof", info.target_from_tof);
  if (info.tof2) check("tof2", info.tof2->target_from_tof);
}

}  // namespace

Result<render::CompositorSetup> setup_of(const capture::SourceInfo& info,
                                         std::optional<Size> view_size) {
  check_mounting(info);
  render::CompositorSetup setup;
  setup.lens_moves = info.lens != nullptr;
  setup.target = info.target, setup.vignetting = info.vignetting;
  setup.view = info.view ? *info.view : geometry::ideal_view(info.target);
  if (view_size) {
    if (view_size->empty() || view_size->width > 16384 || view_size->height > 16384)
      return Error{ErrorCode::kUsage, "--size: a view has 1 to 16384 pixels a side"};
    setup.view = resized(setup.view, *view_size);
  }
  setup.tof = info.tof;
  setup.target_from_tof = info.target_from_tof;
  setup.depth_is_distance = info.depth_kind == capture::DepthKind::kDistance;
  setup.noise = info.noise;
  if (const auto& tof2 = info.tof2)
    setup.tof2 = render::SecondTof{tof2->model, tof2->target_from_tof,
                                   tof2->kind == capture::DepthKind::kDistance, tof2->noise};
  return setup;
}

FrameRange Session::default_frames() const {
  const int frames = source->info().frames;
  const auto& model = scene.background.model;
  if (!scene.background.learn || (model && !model::is_room(*model))) return {1, frames};
  const auto [first, last] = *scene.background.learn;
  if (last >= frames && first > 1) return {1, first - 1};
  return {last + 1, frames};
}

Result<std::unique_ptr<Session>> open_session(const SessionOptions& options) {
  auto session = std::make_unique<Session>();
  session->backend = options.backend;
  session->extra_poses = options.extra_poses;
  MIXRIG_ASSIGN(session->scene, scene::load_scene(options.scene));
  MIXRIG_TRY(find_scene_lamps(session->scene));
  MIXRIG_ASSIGN(session->source, open_any_source(options, *session));
  session->calibration = choose_calibration(options, *session);
  MIXRIG_ASSIGN(session->source,
                capture::with_calibration(std::move(session->source), session->calibration.file));
  session->source = capture::without_wrapped_depth(std::move(session->source));
  MIXRIG_ASSIGN(session->setup, setup_of(session->source->info(), options.view_size));
  if (const auto& learn = session->scene.background.learn) {
    if (auto fine = check_empty_frames(session->source->info(), *learn); !fine)
      return at_key(*session, "background.learn", std::move(fine).error());
  }
  session->meshes = mesh_arrays(session->scene);
  set_scene(session->scene, session->meshes, session->setup);
  add_set(*session);
  MIXRIG_TRY(check_poses(*session));
  return session;
}

Result<void> prepare_background(Session& session, const ProgressFn& progress) {
  const scene::Background& wanted = session.scene.background;
  const bool has_room = wanted.model && model::is_room(*wanted.model);
  if (has_room) MIXRIG_TRY(use_room(session, *wanted.model));
  if (wanted.model && !has_room) {
    if (wanted.learn)
      return at_key(session, "background.learn",
                    {ErrorCode::kFormat, wanted.model->string() +
                                             " is the background of one view: remove learn or "
                                             "model; only a scanned room is joined with frames"});
    MIXRIG_ASSIGN(session.background, loaded_background(session, *wanted.model));
  } else if (wanted.learn) {
    MIXRIG_ASSIGN(session.background,
                  learned_background(session, *wanted.learn, has_room, progress));
  }
  if (session.background) {
    const model::StaticBackground& b = *session.background;
    const bool moves = session.poses && session.poses->info().moves;
    if (session.setup.lens_moves && !moves && !has_room)
      MIXRIG_TRY(place_still_background(session));
    if ((moves && b.world_from_view) || has_room || session.setup.lens_moves)
      use_wide_view(session);
    else
      session.setup.background = {b.depth_m, b.depth_sigma_m, b.color, b.color_sigma};
  }
  if (session.scene.pose_source == scene::PoseSource::kFloor &&
      !(session.background && session.background->floor))
    return Error{ErrorCode::kFormat,
                 session.scene.path.string() + ": camera.pose = \"floor\": " +
                     (session.background ? "no floor was found in the background"
                                         : "there is no view of the empty room to find it in") +
                     ": use pose = \"identity\" or learn from empty frames that show the floor"};
  return {};
}

}  // namespace mixrig::session
