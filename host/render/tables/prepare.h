// SPDX-License-Identifier: Apache-2.0
// Host computations that both back ends share: tables of a take, transforms of a frame. Poses are
// combined in double and rounded to float once they are relative to the camera.
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

/// A normal as signed bytes, n = xyz / 127; (0,0,0) is unknown. Layout of GL_RGBA8_SNORM.
struct PackedNormal {
  std::int8_t x = 0, y = 0, z = 0, w = 0;
};

/// Tables that hold for a take. Built once; plain images, so that a GPU can use them as textures.
struct Tables {
  Size tof_size, plate_size, view_size;
  Image<glm::vec2> tof_ray;  ///< (x/z, y/z) of a ToF pixel; NaN where the lens has no ray
  bool lens_moves = false;   ///< CompositorSetup::lens_moves
  /// CompositorSetup::may_hide_objects, or the setup has none to hide.
  bool may_hide_objects = false;
  bool plate_is_view = false;  ///< ideal lens, view = plate, no vignetting; plate_px is then empty
  /// Factor of linear light for each view pixel; empty without vignetting.
  Image<float> plate_gain;
  /// Plate pixel of each view pixel; outside the plate, clamp to its edge.
  Image<glm::vec2> plate_px;
  bool has_background = false;  ///< false: the images below are empty
  /// Foreground has w > abs(limit), 1/m. Where no background was learned it is the limit of what
  /// lies around, negative, or infinite: what is farther there is in doubt.
  Image<float> key_limit_w;
  /// 1/m, where no background was learned: what has less w lies behind all that is around, as a
  /// reflection does, and so is background. 0 elsewhere.
  Image<float> hole_behind_w;
  /// Depth by depth_at_color_edges(), metres; empty without objects or learned colours.
  Image<float> edge_depth_m;
  /// Depth by light_surface(), metres; empty unless lamps or contact shadows light objects.
  Image<float> light_depth_m;
  Image<PackedNormal> background_normal;  ///< in camera axes, towards the camera
  CorrectParams correct;
  WarpParams warp;
  float tof_footprint_px = 1;  ///< view pixels that a ToF pixel spans, at least 1
  Size tof2_size;              ///< size of the second depth camera; empty without one
};

/// Tables of pass agree for one depth camera, compared with the other.
struct AgreeTables {
  AgreeParams params;
  /// Pixel through the other's lens of each pixel of AgreeParams::other; NaN: none.
  Image<glm::vec2> other_px;
};

/// Tables of a second depth camera, and of the comparison of both cameras.
struct SecondTables {
  Tables tof;  ///< tables of the second camera for passes correct and warp
  AgreeTables first, second;
};

/// (x/z, y/z) of each pixel of a depth camera; NaN where its lens has no ray. Pure.
Image<glm::vec2> tof_rays(const geometry::CameraModel& tof);

/// Computes CorrectParams::bends_part for a depth camera. Pure.
float bends_part(const geometry::CameraModel& tof);
/// Computes CorrectParams::stray_px_m2 for a depth camera. Pure.
float stray_px_m2(const geometry::CameraModel& tof);

/// Builds the tables of a take. Precondition: validate(setup) holds.
Tables make_tables(const CompositorSetup& setup);

/// Builds the second camera's tables. Precondition: validate(setup) holds, setup.tof2 is set.
SecondTables make_second_tables(const CompositorSetup& setup);
/// Updates the tables that depend on the view or on the second depth camera's pose.
void set_view(const CompositorSetup& setup, SecondTables& tables);

/// Updates the tables that depend on the view or on the ToF camera's pose.
void set_view(const CompositorSetup& setup, Tables& tables);
/// Writes the plate pixels of row `y` of the view, view.size_px.width of them; (0, 0) where the
/// lens has no pixel. Pure.
void plate_row(const geometry::CameraModel& target, const geometry::Pinhole& view, int y,
               glm::vec2* out);

/// Updates setup and tables when a frame has another lens. Allocates nothing.
class LensFollower {
 public:
  /// `setup` holds the lens of frames that bring none.
  explicit LensFollower(const CompositorSetup& setup);
  /// Sets target, view and target_from_tof of `setup`, and what depends on them in `tables` except
  /// plate_px. Returns false, and changes nothing, where the lens is that of the frame before.
  bool follow(const std::optional<geometry::LensState>& lens, CompositorSetup& setup,
              Tables& tables);
  /// Pose of the centre of projection for a pose of the target camera's frame.
  geometry::Pose world_from_pupil(const geometry::Pose& world_from_target) const;

 private:
  const geometry::CameraModel target_;
  const geometry::Pinhole view_;
  const geometry::Pose target_from_tof_, target_from_tof2_;
  geometry::Pinhole pinhole_;  ///< lens of the last frame
  geometry::Lens::Coefficients distortion_;
  double pupil_shift_m_ = 0;
};

/// Tables::key_limit_w and Tables::hole_behind_w.
struct KeyLimit {
  Image<float> w, behind_w;
};
/// Limit of the key as inverse depth (1/m): the nearest background within `radius_px`, moved
/// towards the camera by the key's threshold. Where the background is unknown it is the limit
/// around, negative, or infinity. Pure, public for tests.
KeyLimit key_limit(const BackgroundView& background, const KeyParams& key, const NoiseParams& noise,
                   int radius_px);
/// Normal of a depth map at (u, v): of the plane through the inverse depths of 5x5 places, half of
/// `radius_px` apart. Pure.
PackedNormal normal_at(ImageView<const float> depth_m, const geometry::Pinhole& view, int u, int v,
                       int radius_px);
/// Normals of a whole depth map, as normal_at(). Pure, public for tests.
Image<PackedNormal> normals(ImageView<const float> depth_m, const geometry::Pinhole& view,
                            int radius_px);

/// Radius of a disc of the lamp's area.
double disc_radius_m(const geometry::Lamp& lamp);
/// Vectors from a lamp's centre to the middles of its sides, in world axes (panel_axes()). A lamp
/// that shines in all directions is a square that faces along `toward`.
std::array<glm::dvec3, 2> half_sides_m(const geometry::Lamp& lamp, const glm::dvec3& toward);

/// A lamp, or one of the four parts of a panel.
struct LampPart {
  geometry::Lamp lamp;
  int part_of = 0;  ///< index in geometry::Light::lamps
  bool is_part = false;
};
/// Splits each panel into 2x2 panels of a quarter of its light, in order: one map renders the
/// penumbra of a small panel better. Lamps stay whole if the parts exceed kMostLamps.
std::vector<LampPart> parts_of_lamps(const std::vector<geometry::Lamp>& lamps);

/// Half-open pixel rectangle.
struct Rect {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  bool empty() const { return x0 >= x1 || y0 >= y1; }
};

/// One mesh of one object, placed in a frame.
struct Draw {
  const MeshView* mesh = nullptr;
  int object = 0;
  bool casts_shadow = true;
  VirtualParams params;
};

/// Everything that depends on the pose. Lamps do not move in the world: virtual pixels are reused
/// while pose and objects stay, shadow maps while the objects and the map size
/// (`lamps[i].map_size_texel`) stay.
struct FrameParams {
  bool glossy = false;  ///< any mesh is not matte
  bool emits = false;   ///< any mesh has emission
  /// Pose, view, objects or light changed since the last update(); true at first.
  bool pose_changed = true;
  bool maps_changed = true;  ///< shadow maps must be redrawn
  bool room_changed = true;  ///< `room_share` was built since the last update()
  KeyPassParams key;
  LightParams light;
  RoomShadeParams room;
  std::span<const float> room_share;  ///< RoomShade::share
  std::vector<LampParams> lamps;      ///< lamps of the setup, with panels split (parts_of_lamps)
  /// Whole lamps with maps of people; empty: people cast no shadows.
  std::vector<LampParams> people_lamps;
  RoomShadeParams people_grid;  ///< where people's shadows are sampled; no cells: everywhere
  std::vector<std::vector<glm::mat4>> lamp_from_object;  ///< [lamp][object], for drawing the maps
  std::vector<ContactParams> contacts;
  std::span<const HiddenShares> contact_hidden;  ///< kContactNodes^3 for each of `contacts`
  std::vector<Draw> draws;
  Rect virtual_rect;            ///< view pixels that virtual objects may touch
  float nearest_virtual_w = 0;  ///< 1/m: no virtual object is nearer
};

/// What the key compares with: the background if there is one, else the capture volume.
KeyBy key_by(const CompositorSetup& setup);

/// Moves the first objects of `setup`. Returns whether any pose changed. Pure but for `setup`.
bool place_objects(std::span<const geometry::Pose> world_from_object, CompositorSetup& setup);

/// Sets the light of `setup`. Returns whether it changed. Pure but for `setup`.
bool set_light(const std::optional<FrameLight>& light, CompositorSetup& setup);

/// What has changed in a setup since a frame was last prepared with it.
struct SetupChanges {
  bool view = false;     ///< view, by the lens
  bool objects = false;  ///< poses of objects
  bool light = false;    ///< geometry::Light, except the places of lamps
};

/// Brings lamps and objects into camera axes, frame by frame; borrows `setup`.
class FramePreparer {
 public:
  explicit FramePreparer(const CompositorSetup& setup);
  /// Computes params() for this pose and the setup's view. Allocates on the first call only, which
  /// also finds what the real room hides of the lamps if the setup has no first pose.
  void update(const geometry::Pose& world_from_target, const SetupChanges& changes = {});
  /// Keeps changes for the next update(), for frames that do not draw the objects.
  void note(const SetupChanges& changes);
  const FrameParams& params() const { return params_; }
  /// Pose of the last update().
  const geometry::Pose& world_from_camera() const { return last_pose_; }

 private:
  struct MapFit {  ///< world-fixed frame of a lamp's map
    glm::dmat4 lamp_from_world{1};
    double tan_half = 0;  ///< tangent of half the field of view; 0: no shadow
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
  std::vector<LampPart> parts_;  ///< in the order of FrameParams::lamps
  int map_size_ = 0;
  bool has_room_ = false;
  RoomShade room_;                       ///< built at the first pose
  std::optional<AmbientTerms> ambient_;  ///< built at the first pose
  glm::vec3 ambient_then_{0};            ///< the setup's ambient light at that time
  struct Contact {
    std::size_t object = 0;
    glm::vec3 albedo{0};
  };
  std::vector<Contact> contacts_;             ///< in the order of FrameParams::contacts
  std::vector<HiddenShares> contact_hidden_;  ///< of all contacts
  std::vector<MapFit> fits_, people_fits_;    ///< of parts_; of the whole lamps
  struct PeopleGridFit {                      ///< in world axes
    glm::dvec3 first_m{0};
    double cell_m = 0;
    glm::ivec3 cells{0};
  };
  PeopleGridFit people_grid_;
  std::vector<glm::dvec3> corners_m_, caster_corners_m_;  ///< world; eight for each object
};

/// Most points of FrameParams::people_grid.
inline constexpr int kMostPeoplePoints = 32768;

/// Light tiles to either side over which a person's normal is measured.
inline int normal_reach_tiles(float tof_footprint_px) {
  return std::max(
      1, static_cast<int>(std::lround(kNormalFootprints * tof_footprint_px / kLightTilePx)));
}

/// View pixels that a ToF pixel spans, at least 1.
inline float tof_footprint_px(const CompositorSetup& setup) {
  return static_cast<float>(std::max(1.0, setup.view.fx_px / setup.tof.pinhole.fx_px));
}
/// Side in pixels (1, 2 or 4, so that it divides a block) of the tiles in which the matte is
/// refined: a window of 5x5 tiles spans the few footprints in which depth is wrong at a border.
inline int matte_tile_px(float tof_footprint_px) {
  const float side = kMatteTileFootprints * tof_footprint_px;
  return side >= 4 ? 4 : side >= 2 ? 2 : 1;
}
/// Radius, view pixels, within which the nearest background limits the key: one ToF footprint.
inline int limit_radius_px(float tof_footprint_px) {
  return static_cast<int>(std::ceil(tof_footprint_px));
}

/// Least matte byte at which a pixel counts as a person.
inline constexpr auto kPersonByte = static_cast<std::uint8_t>(255 * kPersonMatte + 0.5F);

/// Applies an affine matrix to a point.
inline glm::vec3 transform(const glm::mat4& m, const glm::vec3& p) {
  return glm::vec3(m * glm::vec4(p, 1));
}

}  // namespace mixrig::render
