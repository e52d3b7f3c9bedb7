// SPDX-License-Identifier: Apache-2.0
#include "host/output/report/canvas.h"

#include <numbers>

#include <cairo/cairo-svg.h>
#include <cairo/cairo.h>

namespace mixrig::report {
namespace {

cairo_status_t append(void* text, const unsigned char* data, unsigned size) {
  static_cast<std::string*>(text)->append(reinterpret_cast<const char*>(data), size);
  return CAIRO_STATUS_SUCCESS;
}

}  // namespace

struct Canvas::State {
  Size size;
  std::string svg;  // before the surface, which writes into it
  cairo_surface_t* surface;
  cairo_t* context;

  State(Size s, CanvasKind kind)
      : size(s),
        surface(kind == CanvasKind::kSvg
                    ? cairo_svg_surface_create_for_stream(append, &svg, s.width, s.height)
                    : cairo_image_surface_create(CAIRO_FORMAT_RGB24, s.width, s.height)),
        context(cairo_create(surface)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    cairo_destroy(context);
    cairo_surface_destroy(surface);
  }

  void ink(Rgb8 c) const { cairo_set_source_rgb(context, c.r / 255.0, c.g / 255.0, c.b / 255.0); }
  /// Row of 0x00RRGGBB words.
  std::uint32_t* row(int y) const {
    return reinterpret_cast<std::uint32_t*>(cairo_image_surface_get_data(surface) +
                                            static_cast<std::ptrdiff_t>(y) *
                                                cairo_image_surface_get_stride(surface));
  }
};

Canvas::Canvas(Size size, Rgb8 paper, CanvasKind kind)
    : state_(std::make_unique<State>(size, kind)) {
  state_->ink(paper);
  cairo_paint(state_->context);
  cairo_select_font_face(state_->context, "sans-serif", CAIRO_FONT_SLANT_NORMAL,
                         CAIRO_FONT_WEIGHT_NORMAL);
}
Canvas::Canvas(Canvas&&) noexcept = default;
Canvas& Canvas::operator=(Canvas&&) noexcept = default;
Canvas::~Canvas() = default;

void Canvas::picture(int x, int y, ImageView<const Rgb8> picture) {
  cairo_surface_flush(state_->surface);
  for (int v = std::max(0, -y); v < std::min(picture.size.height, state_->size.height - y); ++v) {
    std::uint32_t* out = state_->row(y + v);
    for (int u = std::max(0, -x); u < std::min(picture.size.width, state_->size.width - x); ++u) {
      const Rgb8 p = picture.row(v)[u];
      out[x + u] =
          static_cast<std::uint32_t>(p.r) << 16 | static_cast<std::uint32_t>(p.g) << 8 | p.b;
    }
  }
  cairo_surface_mark_dirty(state_->surface);
}

void Canvas::text(Point at, const std::string& words, double height_px, Rgb8 ink, Align align) {
  state_->ink(ink);
  cairo_set_font_size(state_->context, height_px);
  cairo_text_extents_t extents;
  cairo_text_extents(state_->context, words.c_str(), &extents);
  const double share = align == Align::kLeft ? 0.0 : align == Align::kCenter ? 0.5 : 1.0;
  cairo_move_to(state_->context, at.x - share * extents.x_advance, at.y);
  cairo_show_text(state_->context, words.c_str());
}

void Canvas::vertical_text(Point at, const std::string& words, double height_px, Rgb8 ink) {
  cairo_save(state_->context);
  cairo_translate(state_->context, at.x, at.y);
  cairo_rotate(state_->context, -std::numbers::pi / 2);
  text({0, 0}, words, height_px, ink, Align::kCenter);
  cairo_restore(state_->context);
}

void Canvas::line(const std::vector<Point>& points, double width_px, Rgb8 ink) {
  state_->ink(ink);
  cairo_set_line_width(state_->context, width_px);
  cairo_new_path(state_->context);  // text leaves a current point behind
  for (const Point& p : points) cairo_line_to(state_->context, p.x, p.y);
  cairo_stroke(state_->context);
}

void Canvas::dot(Point at, double radius_px, Rgb8 ink) {
  state_->ink(ink);
  cairo_new_path(state_->context);
  cairo_arc(state_->context, at.x, at.y, radius_px, 0, 2 * std::numbers::pi);
  cairo_fill(state_->context);
}

Image<Rgb8> Canvas::finish() {
  cairo_surface_flush(state_->surface);
  Image<Rgb8> out(state_->size);
  for (int y = 0; y < out.height(); ++y) {
    const std::uint32_t* in = state_->row(y);
    for (int x = 0; x < out.width(); ++x)
      out.row(y)[x] = {static_cast<std::uint8_t>(in[x] >> 16),
                       static_cast<std::uint8_t>(in[x] >> 8), static_cast<std::uint8_t>(in[x])};
  }
  return out;
}

std::string Canvas::finish_svg() {
  cairo_surface_finish(state_->surface);
  return state_->svg;
}

}  // namespace mixrig::report
