// SPDX-License-Identifier: Apache-2.0
// Pass virtual: draws coverage, depth, normal and albedo of the virtual objects in the view.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <new>
#include <span>
#include <type_traits>
#include <vector>

#include "hal/base/give_back.h"
#include "hal/base/parallel.h"
#include "host/render/cpu/plate/srgb.h"
#include "host/render/cpu/virtual/raster.h"
#include "host/render/tables/prepare.h"

namespace mixrig::render::cpu {

/// kSampleTurnPx, in samples.
inline constexpr float kSampleTurn = kSampleTurnPx * kVirtualSamples;

inline constexpr int kPixelSamples = kVirtualSamples * kVirtualSamples;
static_assert(kPixelSamples == 4);
/// Positions of a pixel's samples, in samples from the first of the unrotated grid.
inline constexpr std::array<float, kPixelSamples> kSampleColumn = {kSampleTurn, 1 + kSampleTurn,
                                                                   -kSampleTurn, 1 - kSampleTurn};
inline constexpr std::array<float, kPixelSamples> kSampleRow = {-kSampleTurn, kSampleTurn,
                                                                1 - kSampleTurn, 1 + kSampleTurn};

/// Share of a surface that all samples of a pixel show, and of one that a single sample shows.
inline constexpr int kWholeShare = 64, kSampleShare = kWholeShare / kPixelSamples;

/// Gloss of a pixel, 255 = 1.
struct GlossBytes {
  std::uint8_t metallic = 0, roughness = 0, specular = 0, unused = 0;
};

/// Memory for images up to a largest size, whose pages are untouched until used: a growing image of
/// a moving camera needs no allocation.
template <typename T>
class RoomFor {
 public:
  void make(Size most) {
    constexpr std::size_t kAlign = 64;
    most_ = most.area();
    const std::size_t bytes = (most_ * sizeof(T) + kAlign) / kAlign * kAlign;
    pixels_.reset(static_cast<T*>(std::aligned_alloc(kAlign, bytes)));
    if (!pixels_) throw std::bad_alloc();
  }
  /// Discards the content. Precondition: `size` has no more pixels than make() was given.
  void reset(Size size) {
    assert(size.area() <= most_);
    width_ = size.width;
  }
  T* row(int y) const { return pixels_.get() + static_cast<std::ptrdiff_t>(y) * width_; }

 private:
  struct Free {
    void operator()(T* p) const { std::free(p); }
  };
  static_assert(std::is_trivially_copyable_v<T>);
  std::unique_ptr<T[], Free> pixels_;
  std::size_t most_ = 0;
  int width_ = 0;
};

/// A surface that a pixel shows beside its nearest one.
struct OtherSurface {
  std::int32_t x;
  float w;              ///< of its nearest sample, 1/m
  PackedNormal normal;  ///< its w: share of the pixel, kWholeShare = 1
  GlossBytes gloss;
  Rgbx16 albedo, emission;  ///< premultiplied by its samples
  Rgbx16 lit;               ///< shaded, without people
};

/// The other surfaces of a layer's pixels; few pixels have one. Each row is filled by one thread.
class OtherSurfaces {
 public:
  void make(Size most) {
    rows_.make(most);
    count_.assign(static_cast<std::size_t>(most.height), 0);
  }
  /// Clears it for the pixels of `rect`.
  void reset(const Rect& rect) {
    rows_.reset({rect.x1 - rect.x0, rect.y1 - rect.y0});
    first_ = rect.y0;
    std::fill(count_.begin(), count_.end(), 0);
  }
  /// Adds a surface. Precondition: row y is in the rectangle, and this pixel has none yet.
  void add(int y, const OtherSurface& surface) {
    int& count = count_[static_cast<std::size_t>(y - first_)];
    rows_.row(y - first_)[count++] = surface;
  }
  /// The surfaces of a row, sorted by x.
  std::span<OtherSurface> row(int y) const {
    return {rows_.row(y - first_),
            static_cast<std::size_t>(count_[static_cast<std::size_t>(y - first_)])};
  }

 private:
  RoomFor<OtherSurface> rows_;
  std::vector<int> count_;
  int first_ = 0;
};

/// Shading of the nearest surfaces without people, kept so that each frame only computes what
/// people hide. Pixel (0, 0) is the first of the layer's `rect`.
struct ShadedAlone {
  RoomFor<Rgbx16> albedo, color;
  std::vector<RoomFor<float>> lamp_light;  ///< luminance that each whole lamp gives, not exposed
  Image<std::uint8_t>
      in_shadow;  ///< of each tile of the view: people darkened it in the last frame
  bool any_in_shadow = false;
};

/// View-sized images; pixels outside `rect` are not covered. Empty in a scene without objects. Rows
/// that no rectangle has reached yet take no memory (make_layer_image).
struct VirtualLayer {
  Rect rect;
  Image<std::uint8_t> coverage;  ///< 255 = all
  Image<float> w;                ///< of the nearest sample, 1/m; 0 where not covered
  Image<PackedNormal> normal;    ///< of the nearest surface, camera axes; its w: its share of the
                                 ///< pixel, kWholeShare = 1
  Image<Rgbx16> color;           ///< premultiplied linear albedo; pass light shades it in place
  Image<GlossBytes> gloss;       ///< empty if no object is glossy
  Image<Rgbx16> emission;        ///< premultiplied; empty if no object emits
  OtherSurfaces others;          ///< missing in `color` until pass light
  ShadedAlone alone;             ///< if people cast shadows

  /// Allocates for a view.
  void reset(Size size, bool glossy, bool emits);
};

/// Makes an image of a layer, all zeros.
template <typename T>
void make_layer_image(Size view_size, Image<T>& image) {
  image.reset(view_size);
  give_back_as_zeros(image);
}

inline constexpr int kSharpMargin = 1;

/// Memory of the pass, reused from frame to frame.
struct VirtualScratch {
  VirtualScratch(const FrameParams& params, Size view_size, int threads);
  struct Item {
    Triangle triangle;  ///< empty box: not drawn
    std::uint32_t draw, first_index;
  };
  std::vector<std::vector<glm::vec3>> positions_m;  ///< of each draw, in camera axes
  std::vector<Item> items;
  /// Sample rows of each item's box, apart from the items because every band reads all of them.
  struct Rows {
    int begin = 0, end = 0;
  };
  std::vector<Rows> item_rows;
  /// Attributes of a triangle over its samples, all times inverse depth.
  struct Surface {
    std::array<Affine, 3> normal;  ///< camera axes, any length
    Affine u, v;
  };
  std::vector<Surface> surfaces;  ///< of the items that are drawn
  std::vector<bool> fits;         ///< of each draw: resolve_lanes() can handle its mesh
  Image<float> sample_w;          ///< kBandRows of the view at 2x2 samples, one band a thread
  Image<std::uint32_t> sample_item;
  Image<std::uint8_t> sharp;  ///< coverage before soften_edges(), with a margin of kSharpMargin
};

/// Draws all objects into `layer`, whose images have the view's size.
void draw_virtual(Crew& crew, const FrameParams& params, VirtualScratch& scratch,
                  VirtualLayer& layer);

}  // namespace mixrig::render::cpu
