// SPDX-License-Identifier: Apache-2.0
#include "host/room/background/frame_views.h"

#include <algorithm>
#include <array>
#include <span>

#include "hal/base/srgb.h"
#include "host/room/background/frame_lens.h"

namespace mixrig::session {

Result<FrameViews> FrameViews::make(const render::CompositorSetup& setup, BackendChoice backend) {
  render::CompositorSetup empty = setup;
  empty.objects.clear();
  empty.light.lamps.clear();
  empty.background = {};
  empty.background_models.clear();
  empty.capture_box.reset();
  empty.backdrop.reset();
  empty.people_cast_shadows = false;
  empty.focus.reset();  // the room is learned and watched as the camera sees it
  FrameViews views;
  MIXRIG_ASSIGN(views.compositor_, make_compositor(empty, backend));
  views.output_.wanted = render::kColor | render::kWarpedDepth;
  return views;
}

Result<const render::FrameOutput*> FrameViews::of(const capture::Capture& capture) {
  MIXRIG_TRY(compositor_->compose(
      {capture.plate, capture.depth_m, {}, frame_lens(capture), {}, capture.depth2.depth_m},
      output_));
  return &output_;
}

WideFrame::WideFrame(const render::CompositorSetup& setup, const WideView& wide, Crew& crew)
    : setup_(setup), wide_(wide), crew_(crew), color_(wide.camera.size_px) {
  setup_.view = wide.camera;
  setup_.target = {wide.camera, {}}, setup_.vignetting = {};
  setup_.background = {};
}

void WideFrame::draw(const geometry::Pinhole& view, const geometry::Pose& world_from_view,
                     const Image<Rgb8>& seen, ImageView<const float> depth_m) {
  Image<Rgbx8> color(seen.size());
  for (int y = 0; y < color.height(); ++y)
    std::transform(seen.row(y), seen.row(y) + color.width(), color.row(y), [](const Rgb8& p) {
      return Rgbx8{p.r, p.g, p.b, 0};
    });
  setup_.background_models = {{view, {world_from_view}, depth_m, {}, color}};
  render::cpu::MovingBackground drawn(crew_, setup_, render::cpu::DrawnFor::kPictures);
  setup_.background_models.clear();
  color = {};  // `drawn` has read it
  drawn.draw(crew_, wide_.world_from_camera);
  take_over(drawn);
}

void WideFrame::take_over(const render::cpu::MovingBackground& drawn) {
  constexpr int kColumns = render::cpu::MovingBackground::kMostColumns;
  depth_m_.reset(color_.size());
  const ImageView<const float> drawn_m = drawn.view().depth_m;
  crew_.rows(color_.height(), 16, [&](int begin, int end) {
    std::array<Rgbf, kColumns> colors;
    for (int y = begin; y < end; ++y)
      for (int x0 = 0; x0 < color_.width(); x0 += kColumns) {
        const int count = std::min(kColumns, color_.width() - x0);
        drawn.colors(x0, y, std::span(colors).first(static_cast<std::size_t>(count)));
        for (int i = 0; i < count; ++i) {
          const Rgbf& c = colors[static_cast<std::size_t>(i)];
          depth_m_.row(y)[x0 + i] = c.r < 0 ? 0 : drawn_m.row(y)[x0 + i];
          color_.row(y)[x0 + i] = {srgb_byte_from_linear(c.r), srgb_byte_from_linear(c.g),
                                   srgb_byte_from_linear(c.b)};
        }
      }
  });
}

}  // namespace mixrig::session
