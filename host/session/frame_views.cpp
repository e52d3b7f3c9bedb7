// SPDX-License-Identifier: Apache-2.0
#include "host/session/frame_views.h"

#include <algorithm>

#include "hal/base/srgb.h"
#include "host/session/frame_lens.h"

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
  tables_.view_size = wide.camera.size_px;
  tables_.key_limit_w.reset(wide.camera.size_px);
}

void WideFrame::draw(const geometry::Pinhole& view, const geometry::Pose& world_from_view,
                     const render::FrameOutput& seen) {
  color_seen_.reset(seen.color.size());
  for (int y = 0; y < color_seen_.height(); ++y)
    std::transform(seen.color.row(y), seen.color.row(y) + color_seen_.width(), color_seen_.row(y),
                   [](const Rgb8& p) {
                     return Rgbx8{p.r, p.g, p.b, 0};
                   });
  setup_.background_models = {{view, {world_from_view}, seen.warped_depth_m, {}, color_seen_}};
  render::cpu::MovingBackground drawn(crew_, setup_, render::cpu::Normals::kSkip);
  drawn.draw(crew_, wide_.world_from_camera, tables_);
  take_over(drawn);
}

void WideFrame::take_over(render::cpu::MovingBackground& drawn) {
  constexpr int kColumns = render::cpu::MovingBackground::kMostColumns;
  depth_m_.reset(color_.size());
  crew_.rows(color_.height(), 16, [&](int begin, int end) {
    for (int y = begin; y < end; ++y) {
      for (int x = 0; x < color_.width(); x += kColumns)
        drawn.draw_color(x, y, std::min(kColumns, color_.width() - x));
      const render::BackgroundView view = drawn.view();
      for (int x = 0; x < color_.width(); ++x) {
        const Rgbf c = view.color.row(y)[x];
        depth_m_.row(y)[x] = c.r < 0 ? 0 : view.depth_m.row(y)[x];
        color_.row(y)[x] = {srgb_byte_from_linear(c.r), srgb_byte_from_linear(c.g),
                            srgb_byte_from_linear(c.b)};
      }
    }
  });
}

}  // namespace mixrig::session
