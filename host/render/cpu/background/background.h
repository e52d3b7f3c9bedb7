// SPDX-License-Identifier: Apache-2.0
// Pass background: the background model as the camera sees it from its pose.
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

/// What the background is drawn for.
enum class DrawnFor {
  kComposites,  ///< limit of the key, normals for light, images of the colours that are drawn
  kPictures,    ///< depth, and colours that are given away: half the memory
};

/// The background at the last pose, images of the view's size. What no model ever saw, or saw
/// hidden behind another surface, is unknown: depth 0, colour negative, no limit. Where several
/// models hold a surface, spread, normal and colour are those of the one that saw it nearest to the
/// middle of a face, and from nearest.
class MovingBackground {
 public:
  /// Reads the model's images now and borrows nothing.
  MovingBackground(Crew& crew, const CompositorSetup& setup,
                   DrawnFor drawn_for = DrawnFor::kComposites);
  /// Draws the depth. Colours are those of earlier draws until draw_color().
  void draw(Crew& crew, const geometry::Pose& world_from_camera);
  /// The same and tables.key_limit_w. Without `with_light` the frame shows no objects: depth that
  /// has wrapped around stays. Precondition: made for composites.
  void draw(Crew& crew, const geometry::Pose& world_from_camera, Tables& tables,
            bool with_light = true);
  /// Takes the view of `setup`, of the same size, for the next draws. Allocates nothing.
  void see_through(const CompositorSetup& setup);
  bool has_color() const { return has_color_; }
  /// As of the view, but on planes where light falls on such (light_surface.h).
  ImageView<const float> light_depth_m() const {
    return light_depth_m_.empty() ? depth_m_.view() : light_depth_m_.view();
  }
  /// Draws the colour of `count` <= kMostColumns pixels of a row, of every `step`-th from x0 on.
  /// Few pixels need it: those that depth cannot decide. Any thread, different pixels.
  /// Precondition: has_color(), made for composites.
  void draw_color(int x0, int y, int count, int step = 1);
  /// Colours of at most kMostColumns pixels of a row from (x0, y) on, linear, negative where they
  /// are unknown. Any thread. Precondition: has_color().
  void colors(int x0, int y, std::span<Rgbf> out) const;
  static constexpr int kMostColumns = 128;
  /// Normals of at most kMostColumns pixels of a row from (x0, y) on, as Tables::background_normal
  /// has them. Few pixels need them: those that a shadow can reach. Any thread. Precondition: made
  /// for composites. `step`: of every so many pixels.
  void normals(int x0, int y, std::span<PackedNormal> out, int step = 1) const;
  /// Valid for the life of this; changed by the draws.
  BackgroundView view() const { return {depth_m_, {}, color_, color_sigma_}; }

 private:
  struct Run;
  /// The pixel (x0, y) of the view and every `step`-th after it along the row.
  struct Pixels {
    int x0 = 0, y = 0, count = 0, step = 1;
  };
  enum class Find;
  struct Face {
    geometry::Pose world_from_face;
    TofGrid grid;
    FacePose pose{};           ///< of the last draw
    glm::mat3 from_camera{1};  ///< the same
    glm::vec3 camera_m{0};     ///< in axes of the face
  };
  /// One of the models.
  struct Part {
    ModelTables tables;
    std::vector<Face> faces;
    WarpScratch scratch;
    /// Lookup tables: the faces below one another, each with a border of one pixel that knows
    /// nothing.
    Image<Rgbx16> color;   ///< x: the spread, 65535 where unknown; empty without colour
    int color_factor = 1;  ///< its pixels a pixel of the other tables, along a side
    Image<float> w;        ///< inverse depth, 0 unknown
    /// Of composites.
    Image<float> sigma_m;          ///< spread of the depth
    Image<PackedNormal> normal;    ///< axes of the first face
    std::int32_t first_plane = 0;  ///< of the planes of all parts, where number 0 of it lies
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
  Image<float> w_;  ///< with kViewMargin
  Image<float> depth_m_;
  /// Of composites.
  Image<float> column_most_w_;  ///< of each worker a row: the largest w_ within the radius, down
  Image<float> depth_sigma_m_;  ///< of squares of pixels
  /// Where light falls on planes; else empty.
  Image<std::int32_t> plane_;  ///< of squares of pixels: number in the next one, negative: wrapped
  std::array<std::vector<float>, 3> plane_w_;  ///< planes_in_camera() of all parts
  Image<float> light_depth_m_;
  Image<Rgbf> color_;
  Image<float> color_sigma_;
};

}  // namespace mixrig::render::cpu
