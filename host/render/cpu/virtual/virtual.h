// SPDX-License-Identifier: Apache-2.0
// Pass virtual: coverage, depth, normal and albedo of the virtual objects in the view.
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

inline constexpr float kSampleTurn = kSampleTurnPx * kVirtualSamples;  ///< in samples

inline constexpr int kPixelSamples = kVirtualSamples * kVirtualSamples;
static_assert(kPixelSamples == 4);
/// Where the samples of a pixel lie, in samples from the first of a grid that is not turned.
inline constexpr std::array<float, kPixelSamples> kSampleColumn = {kSampleTurn, 1 + kSampleTurn,
                                                                   -kSampleTurn, 1 - kSampleTurn};
inline constexpr std::array<float, kPixelSamples> kSampleRow = {-kSampleTurn, kSampleTurn,
                                                                1 - kSampleTurn, 1 + kSampleTurn};

/// Gloss of a pixel, 255 = 1.
struct GlossBytes {
  std::uint8_t metallic = 0, roughness = 0, specular = 0, unused = 0;
};

/// Memory for images of a size up to the largest one, of which no page is touched before it is
/// used: what a moving camera outgrows costs no allocation.
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
  /// What was in it is lost. Precondition: no more pixels than there is room for.
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

/// What a pixel shows beside its nearest surface.
struct OtherSurface {
  std::int32_t x;
  float w;              ///< of its nearest sample
  PackedNormal normal;  ///< w: its samples
  GlossBytes gloss;
  Rgbx16 albedo, emission;  ///< premultiplied by its samples
  Rgbx16 lit;               ///< shaded, without people
};

/// Of a layer's pixels: few have one. The rows of a rectangle are filled by one thread each.
class OtherSurfaces {
 public:
  void make(Size most) {
    rows_.make(most);
    count_.assign(static_cast<std::size_t>(most.height), 0);
  }
  /// None in the pixels of `rect`.
  void reset(const Rect& rect) {
    rows_.reset({rect.x1 - rect.x0, rect.y1 - rect.y0});
    first_ = rect.y0;
    std::fill(count_.begin(), count_.end(), 0);
  }
  /// Precondition: row y is in the rectangle, and has none for this pixel.
  void add(int y, const OtherSurface& surface) {
    int& count = count_[static_cast<std::size_t>(y - first_)];
    rows_.row(y - first_)[count++] = surface;
  }
  /// By x.
  std::span<OtherSurface> row(int y) const {
    return {rows_.row(y - first_),
            static_cast<std::size_t>(count_[static_cast<std::size_t>(y - first_)])};
  }

 private:
  RoomFor<OtherSurface> rows_;
  std::vector<int> count_;
  int first_ = 0;
};

/// What is kept of the shading of the nearest surfaces without people, so that only what they hide
/// is found in each frame. Pixel (0, 0) is the first of the layer's `rect`.
struct ShadedAlone {
  RoomFor<Rgbx16> albedo, color;
  std::vector<RoomFor<float>> lamp_light;  ///< luminance that each whole lamp gives, not exposed
  Image<std::uint8_t>
      in_shadow;  ///< of each tile of the view: people darkened it in the last frame
  bool any_in_shadow = false;
};

/// View-sized; what lies outside `rect` is not covered. Empty in a scene without objects. Rows that
/// no rectangle has reached yet take no memory (make_layer_image).
struct VirtualLayer {
  Rect rect;
  Image<std::uint8_t> coverage;  ///< of 255
  Image<float> w;                ///< of the nearest sample; 0 where not covered
  Image<PackedNormal> normal;    ///< of the nearest surface, camera axes; w: its samples
  Image<Rgbx16> color;           ///< premultiplied linear albedo; pass light shades it in place
  Image<GlossBytes> gloss;       ///< empty where no object is glossy
  Image<Rgbx16> emission;        ///< premultiplied; empty where no object emits
  OtherSurfaces others;          ///< until pass light, `color` lacks their share
  ShadedAlone alone;             ///< where people cast shadows

  /// Memory for a view.
  void reset(Size size, bool glossy, bool emits);
};

/// An image of a layer: zeros.
template <typename T>
void make_layer_image(Size view_size, Image<T>& image) {
  image.reset(view_size);
  give_back_as_zeros(image);
}

/// Memory of the pass, kept between frames.
struct VirtualScratch {
  VirtualScratch(const FrameParams& params, Size view_size, int threads);
  struct Item {
    Triangle triangle;  ///< box empty: not drawn
    std::uint32_t draw, first_index;
  };
  std::vector<std::vector<glm::vec3>> positions_m;  ///< of each draw, camera axes
  std::vector<Item> items;
  /// Rows of samples of each item's box: every band looks at all of them.
  struct Rows {
    int begin = 0, end = 0;
  };
  std::vector<Rows> item_rows;
  /// What a triangle shows over its samples, all times inverse depth.
  struct Surface {
    std::array<Affine, 3> normal;  ///< camera axes, of any length
    Affine u, v;
  };
  std::vector<Surface> surfaces;  ///< of the items that are drawn
  std::vector<bool> fits;         ///< of each draw: resolve_lanes() knows all that it shows
  Image<float> sample_w;          ///< kBandRows of the view at 2x2 samples, one a thread
  Image<std::uint32_t> sample_item;
};

/// Draws all objects into `layer`, whose images have the view's size.
void draw_virtual(Crew& crew, const FrameParams& params, VirtualScratch& scratch,
                  VirtualLayer& layer);

}  // namespace mixrig::render::cpu
