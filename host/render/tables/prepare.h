// SPDX-License-Identifier: Apache-2.0
// What both back ends compute alike on the host: tables of a take, transforms of a frame.
// Poses are combined in double and rounded to float once they are relative to the camera.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include <glm/glm.hpp>

#include "hal/base/image.h"
#include "host/render/contract/compositor.h"
#include "host/render/contract/passes.h"
#include "host/render/contract/to_glm.h"
#include "host/render/tables/contact_shade.h"
#include "host/render/tables/room_ambient.h"
#include "host/render/tables/room_shade.h"

namespace mixrig::render {

/// Normal as three signed bytes, n = xyz / 127; (0,0,0) is unknown. GL_RGBA8_SNORM takes it as is.
struct PackedNormal {
  std::int8_t x = 0, y = 0, z = 0, w = 0;
};

/// Tables that hold for a take. Built once; plain images, so that a GPU can take them as textures.
struct Tables {
  Size tof_size, plate_size, view_size;
  Image<glm::vec2> tof_ray;       ///< (x/z, y/z) of a ToF pixel; NaN where the lens has no ray
  bool lens_moves = false;        ///< as CompositorSetup::lens_moves
  bool may_hide_objects = false;  ///< the same, or there are none to hide
  bool plate_is_view = false;   ///< ideal lens, view = plate, no vignetting: plate_px is empty then
  Image<float> plate_gain;      ///< of each view pixel, for linear light; empty without vignetting
  Image<glm::vec2> plate_px;    ///< plate pixel of a view pixel; may lie outside: clamp to edge
  bool has_background = false;  ///< the images below are empty without
  /// Foreground is w > abs(this), 1/m. Where no background was learned it is that around, negative,
  /// or infinite: what is farther is in doubt.
  Image<float> key_limit_w;
  /// Of depth_at_color_edges(), where there are objects and learned colours; else empty.
  Image<float> edge_depth_m;
  /// Of light_surface(), where lamps light objects; else depth is empty.
  Image<float> light_depth_m;
  Image<PackedNormal> background_normal;  ///< camera axes, towards the camera
  CorrectParams correct;
  WarpParams warp;
  float tof_footprint_px = 1;  ///< view pixels that a ToF pixel spans, at least 1
  Size tof2_size;              ///< of the second depth camera; empty without
};

/// Tables of pass agree.
struct AgreeTables {
  AgreeParams params;
  Image<glm::vec2> other_px;  ///< through its lens, for each pixel of AgreeParams::other; NaN: none
};

/// Tables of a second depth camera, and of what each of the two says of the other.
struct SecondTables {
  Tables tof;  ///< of passes correct and warp
  AgreeTables first, second;
};

/// (x/z, y/z) of each pixel of a depth camera; NaN where its lens has no ray. Pure.
Image<glm::vec2> tof_rays(const geometry::CameraModel& tof);

/// CorrectParams::bends_part of a depth camera. Pure.
float bends_part(const geometry::CameraModel& tof);
/// CorrectParams::stray_px_m2 of a depth camera. Pure.
float stray_px_m2(const geometry::CameraModel& tof);

/// Precondition: validate(setup) holds.
Tables make_tables(const CompositorSetup& setup);

/// Precondition: validate(setup) holds, and the setup has a second depth camera.
SecondTables make_second_tables(const CompositorSetup& setup);
/// What of them depends on the view and on the pose before it.
void set_view(const CompositorSetup& setup, SecondTables& tables);

/// What of the tables depends on the view and on the pose of the ToF camera before it.
void set_view(const CompositorSetup& setup, Tables& tables);
/// Plate pixels of a row of the view, view.size_px.width of them; (0, 0) where the lens sees
/// nothing. Pure.
void plate_row(const geometry::CameraModel& target, const geometry::Pinhole& view, int y,
               glm::vec2* out);

/// Brings setup and tables from one frame's lens to the next. Allocates nothing.
class LensFollower {
 public:
  /// `setup` as the session made it: frames without a lens of their own have its lens.
  explicit LensFollower(const CompositorSetup& setup);
  /// Sets target, view and target_from_tof of `setup`, and of `tables` what depends on them but for
  /// plate_px. False where the lens is that of the frame before: then nothing is touched.
  bool follow(const std::optional<geometry::LensState>& lens, CompositorSetup& setup,
              Tables& tables);
  /// Pose of the centre of projection, for a pose of the target camera's frame.
  geometry::Pose world_from_pupil(const geometry::Pose& world_from_target) const;

 private:
  const geometry::CameraModel target_;
  const geometry::Pinhole view_;
  const geometry::Pose target_from_tof_, target_from_tof2_;
  geometry::Pinhole pinhole_;  ///< of the last frame's lens
  geometry::Lens::Coefficients distortion_;
  double pupil_shift_m_ = 0;
};

/// Nearest background within `radius_px`, moved towards the camera by the key threshold, as
/// inverse depth; where the background is unknown that around it, negative, or infinity.
/// Pure, for tests.
Image<float> key_limit(const BackgroundView& background, const KeyParams& key,
                       const NoiseParams& noise, int radius_px);
/// Normal of a depth map by the plane through the inverse depths of 5x5 places around a pixel, half
/// of `radius_px` apart. Pure.
PackedNormal normal_at(ImageView<const float> depth_m, const geometry::Pinhole& view, int u, int v,
                       int radius_px);
/// Normals of a depth map by planes through its inverse depth. Pure, for tests.
Image<PackedNormal> normals(ImageView<const float> depth_m, const geometry::Pinhole& view,
                            int radius_px);

/// Of a disc of the lamp's area.
double disc_radius_m(const geometry::Lamp& lamp);
/// From the middle of a lamp to those of its sides, world: along geometry::panel_axes(). A lamp
/// that shines to all sides is a square that faces along `toward`.
std::array<glm::dvec3, 2> half_sides_m(const geometry::Lamp& lamp, const glm::dvec3& toward);

/// A lamp, or a part of it.
struct LampPart {
  geometry::Lamp lamp;
  int part_of = 0;  ///< which of geometry::Light::lamps
  bool is_part = false;
};
/// Each panel as 2x2 panels of a quarter of its light, in the order of the lamps: the penumbra of a
/// small one is nearer to what one map a lamp can tell. Whole where that were more than kMostLamps.
std::vector<LampPart> parts_of_lamps(const std::vector<geometry::Lamp>& lamps);

/// Half-open pixel rectangle.
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
};

/// One mesh of one object, in a frame.
struct Draw {
  const MeshView* mesh = nullptr;
  int object = 0;
  bool casts_shadow = true;
  VirtualParams params;
};

/// All that depends on the pose. Lamps stand still in the world: while the pose and the objects
/// stay, so do virtual pixels; shadow maps stay while the objects and their size do
/// (`lamps[i].map_size_texel`).
struct FrameParams {
  bool glossy = false;       ///< any mesh is not matte
  bool emits = false;        ///< any mesh has emission
  bool pose_changed = true;  ///< or view, objects or light, since the last update(); true at first
  bool maps_changed = true;  ///< shadow maps must be drawn again
  bool room_changed = true;  ///< `room_share` was made since the last update()
  KeyPassParams key;
  LightParams light;
  RoomShadeParams room;
  std::span<const float> room_share;     ///< RoomShade::share
  std::vector<LampParams> lamps;         ///< of the setup; panels in parts (parts_of_lamps)
  std::vector<LampParams> people_lamps;  ///< whole, with maps of people; empty: they cast none
  RoomShadeParams people_grid;           ///< where they are looked for; no cells: everywhere
  std::vector<std::vector<glm::mat4>> lamp_from_object;  ///< [lamp][object], to draw the maps
  std::vector<ContactParams> contacts;
  std::span<const HiddenShares> contact_hidden;  ///< kContactNodes^3 of each of `contacts`
  std::vector<Draw> draws;
  Rect virtual_rect;            ///< view pixels that virtual objects may touch
  float nearest_virtual_w = 0;  ///< 1/m: none of them is nearer
};

/// The background where there is one, else the capture volume.
KeyBy key_by(const CompositorSetup& setup);

/// Moves the first objects of `setup`. False where they stand there already. Pure but for `setup`.
bool place_objects(std::span<const geometry::Pose> world_from_object, CompositorSetup& setup);

/// Sets the light of `setup`. False where it is the same. Pure but for `setup`.
bool set_light(const std::optional<FrameLight>& light, CompositorSetup& setup);

/// Of a setup, since a frame was last prepared by it.
struct SetupChanges {
  bool view = false;     ///< as the lens has it
  bool objects = false;  ///< objects stand elsewhere
  bool light = false;    ///< as geometry::Light, but for places of lamps
};

/// Keeps what is needed to bring lamps and objects into camera axes; borrows `setup`.
class FramePreparer {
 public:
  explicit FramePreparer(const CompositorSetup& setup);
  /// Brings `params` to this pose, and to the setup's view where that has changed. Allocates on the
  /// first call only, which finds out what the real room hides of the lamps where the setup has no
  /// first pose.
  void update(const geometry::Pose& world_from_target, const SetupChanges& changes = {});
  /// Changes that count in the next update(): the objects are not drawn meanwhile.
  void note(const SetupChanges& changes);
  const FrameParams& params() const { return params_; }
  const geometry::Pose& world_from_camera() const { return last_pose_; }  ///< of that update()

 private:
  struct MapFit {  ///< world-fixed frame of a lamp's map
    glm::dmat4 lamp_from_world{1};
    double tan_half = 0;  ///< of its field; 0: no shadow
    double near_m = 0;    ///< z of the nearest caster
  };
  void fit_objects();
  MapFit fit_map(const geometry::Lamp& lamp, std::span<const glm::dvec3> corners_m) const;
  void fit_people_maps(const geometry::Pose& world_from_target);
  void fit_people_grid();
  void update_people(const glm::dmat4& world_from_camera, const glm::dmat4& camera_from_world);
  static LampParams lamp_params(const geometry::Lamp& lamp, const MapFit& fit, int map_size_texel,
                                const glm::dmat4& world_from_camera,
                                const glm::dmat4& camera_from_world);
  int map_size(const glm::dmat4& camera_from_world) const;
  void update_floor(const glm::dmat4& world_from_camera);
  void find_room(const geometry::Pose& world_from_target);
  void update_room(const geometry::Pose& world_from_target);
  void update_ambient(const geometry::Pose& world_from_target);
  void find_contacts();
  void update_contacts(const geometry::Pose& world_from_target);
  void update_lamps(const glm::dmat4& world_from_camera, const glm::dmat4& camera_from_world);

  const CompositorSetup& setup_;
  FrameParams params_;
  SetupChanges noted_;
  bool has_pose_ = false;
  geometry::Pose last_pose_;
  std::vector<LampPart> parts_;  ///< as FrameParams::lamps
  int map_size_ = 0;
  bool has_room_ = false;
  RoomShade room_;                       ///< of the first pose
  std::optional<AmbientTerms> ambient_;  ///< the same
  glm::vec3 ambient_then_{0};            ///< that of the setup when they were found
  struct Contact {
    std::size_t object = 0;
    glm::vec3 albedo{0};
  };
  std::vector<Contact> contacts_;             ///< as FrameParams::contacts
  std::vector<HiddenShares> contact_hidden_;  ///< of all of them
  std::vector<MapFit> fits_, people_fits_;    ///< of parts_, of the lamps
  struct PeopleGridFit {                      ///< along the world's axes
    glm::dvec3 first_m{0};
    double cell_m = 0;
    glm::ivec3 cells{0};
  };
  PeopleGridFit people_grid_;
  std::vector<glm::dvec3> corners_m_, caster_corners_m_;  ///< world, eight an object
};

/// Of FrameParams::people_grid, at most.
inline constexpr int kMostPeoplePoints = 32768;

/// Tiles to either side over which a person's normal is measured.
inline int normal_reach_tiles(float tof_footprint_px) {
  return std::max(
      1, static_cast<int>(std::lround(kNormalFootprints * tof_footprint_px / kLightTilePx)));
}

/// View pixels that a ToF pixel spans, at least 1.
inline float tof_footprint_px(const CompositorSetup& setup) {
  return static_cast<float>(std::max(1.0, setup.view.fx_px / setup.tof.pinhole.fx_px));
}
/// Side of the tiles in which the matte is refined, in pixels (1, 2 or 4: it divides a block): the
/// window of 5x5 tiles spans the few footprints in which depth is wrong at a border.
inline int matte_tile_px(float tof_footprint_px) {
  const float side = kMatteTileFootprints * tof_footprint_px;
  return side >= 4 ? 4 : side >= 2 ? 2 : 1;
}
/// Whether the plate's colours place the borders of the warp: where it is finer than the depth.
inline bool color_places_borders(float tof_footprint_px) { return tof_footprint_px > 1; }
/// View pixels between the taps that tell whether people are measured all around.
inline int inside_tap_px(float tof_footprint_px) {
  return std::max(kBlockPx / 2,
                  static_cast<int>(std::lround(kInsideFootprints * tof_footprint_px)));
}
/// View pixels around one in which the nearest background limits the key: one ToF footprint.
inline int limit_radius_px(float tof_footprint_px) {
  return static_cast<int>(std::ceil(tof_footprint_px));
}

/// Least matte byte that shows a person.
inline constexpr auto kPersonByte = static_cast<std::uint8_t>(255 * kPersonMatte + 0.5F);

/// Vertex in camera or lamp axes.
inline glm::vec3 transform(const glm::mat4& m, const glm::vec3& p) {
  return glm::vec3(m * glm::vec4(p, 1));
}

}  // namespace mixrig::render
