// SPDX-License-Identifier: Apache-2.0
// Pass background: draws the background models as the camera sees them from its pose.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "hal/base/parallel.h"
#include "host/render/cpu/plate/correct.h"
#include "host/render/cpu/plate/srgb.h"
#include "host/render/cpu/simd.h"
#include "host/render/cpu/warp/warp.h"
#include "host/render/tables/background_model.h"

namespace mixrig::render::cpu {

/// Use of the drawn background.
enum class DrawnFor {
  /// For the compositor: also the key's limit, normals for light, and images of the drawn colours.
  kComposites,
  kPictures,  ///< for a caller that wants depth and colours only: half the memory
};

/// The background at the last pose, in images of the view's size. What no model saw, or only hidden
/// behind another surface, is unknown: depth 0, colour negative, no limit. Where several models saw
/// a surface, sigma, normal and colour come from the one that saw it from nearest, most centrally.
class MovingBackground {
 public:
  /// Reads the models' images now and borrows nothing.
  MovingBackground(Crew& crew, const CompositorSetup& setup,
                   DrawnFor drawn_for = DrawnFor::kComposites);
  /// Draws the depth. Colours stay those of earlier draws until draw_color().
  void draw(Crew& crew, const geometry::Pose& world_from_camera);
  /// Draws the depth and tables.key_limit_w. Without `with_light` the frame shows no objects, and
  /// wrapped depth is kept. Precondition: made for composites.
  void draw(Crew& crew, const geometry::Pose& world_from_camera, Tables& tables,
            bool with_light = true);
  /// Takes the view of `setup`, whose size must not change, for later draws. Allocates nothing.
  void see_through(const CompositorSetup& setup);
  bool has_color() const { return has_color_; }
  /// Depth of the view, with planes where light is computed on planes (light_surface.h).
  ImageView<const float> light_depth_m() const {
    return light_depth_m_.empty() ? depth_m_.view() : light_depth_m_.view();
  }
  /// Draws the colour of `count` <= kMostColumns pixels of a row: every `step`-th from x0 on.
  /// Called for the few pixels that depth cannot decide. Any thread, for different pixels.
  /// Precondition: has_color(), made for composites.
  void draw_color(int x0, int y, int count, int step = 1);
  /// Writes the linear colours of out.size() <= kMostColumns pixels of row y from x0 on, negative
  /// where unknown. Any thread. Precondition: has_color().
  void colors(int x0, int y, std::span<Rgbf> out) const;
  static constexpr int kMostColumns = 128;
  /// Writes normals, as in Tables::background_normal, of out.size() <= kMostColumns pixels of row
  /// y: every `step`-th from x0 on. Called for the few pixels that a shadow can reach. Any thread.
  /// Precondition: made for composites.
  void normals(int x0, int y, std::span<PackedNormal> out, int step = 1) const;
  /// The images; valid for the life of this object, changed by draws.
  BackgroundView view() const { return {depth_m_, {}, color_, color_sigma_}; }

 private:
  struct Run;
  /// Pixels of a view row: (x0, y) and every `step`-th after it.
  struct Pixels {
    int x0 = 0, y = 0, count = 0, step = 1;
  };
  enum class Find;
  struct Face {
    geometry::Pose world_from_face;
    TofGrid grid;
    FacePose pose{};           ///< of the last draw
    glm::mat3 from_camera{1};  ///< rotation of the last draw
    glm::vec3 camera_m{0};     ///< position of the camera in axes of the face
  };
  /// Tables and memory of one background model.
  struct Part {
    ModelTables tables;
    std::vector<Face> faces;
    WarpScratch scratch;
    /// Lookup tables: faces one below the other, each with a border of one unknown pixel.
    /// Linear; x: the colour's sigma, 65535 where unknown; empty without colour.
    Image<Rgbx16> color;
    int color_factor = 1;  ///< its resolution relative to the other tables, along each axis
    Image<float> w;        ///< inverse depth, 0 unknown
    /// The following are empty unless made for composites.
    Image<float> sigma_m;          ///< sigma of the depth
    Image<PackedNormal> normal;    ///< in axes of the first face
    std::int32_t first_plane = 0;  ///< index of its plane number 0 among the planes of all parts
  };
  static Part make_part(Crew& crew, const CompositorSetup& setup, const BackgroundModel& from,
                        DrawnFor drawn_for);
  void find(const Pixels& pixels, Run& run) const;
  void find_in(std::size_t part, const Pixels& pixels, Find what, Run& run) const;
  void keep_better(const Run& other, Run& run) const;
  bool shows(const Run& run, std::size_t i) const;
  void find_colors(const Pixels& pixels, Rgbf* color, float* sigma) const;
  static void colors_of(const Part& part, const Run& run, std::array<Rgbx16, kMostColumns>& out);
  void draw_surfaces(Crew& crew, const geometry::Pose& world_from_camera);
  void find_depth(int y);
  void find_spread(int y);
  void limit_row(int y, float* column_most_w, float* limit_w) const;
  void place_planes();
  void find_planes(const Run& run, std::int32_t* plane) const;
  void light_row(int y);

  KeyParams key_;
  NoiseParams noise_;
  std::vector<Part> parts_;
  int limit_radius_px_ = 1;  ///< largest of the models
  bool has_color_ = false;
  Image<float> w_;  ///< inverse depth of the view, with kViewMargin
  Image<float> depth_m_;
  /// The following are empty unless made for composites.
  /// One row a worker: the largest w_ within the radius, along columns.
  Image<float> column_most_w_;
  Image<float> depth_sigma_m_;  ///< one value for 2x2 pixels
  /// The following are empty unless light is computed on planes.
  /// One value for 2x2 pixels: index into plane_w_, negative if wrapped.
  Image<std::int32_t> plane_;
  /// planes_in_camera() of all parts, one vector a coordinate.
  std::array<std::vector<float>, 3> plane_w_;
  Image<float> light_depth_m_;
  Image<Rgbf> color_;
  Image<float> color_sigma_;
};

}  // namespace mixrig::render::cpu
