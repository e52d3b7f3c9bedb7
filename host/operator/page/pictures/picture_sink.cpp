// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/pictures/picture_sink.h"

#include <utility>

#include "host/math/image_io/jpeg_write.h"
#include "host/output/report/picture.h"

namespace mixrig::page {
namespace {

Image<Rgb8> gray(ImageView<const std::uint8_t> matte) {
  Image<Rgb8> out(matte.size);
  for (int y = 0; y < matte.size.height; ++y)
    for (int x = 0; x < matte.size.width; ++x) {
      const std::uint8_t v = matte.row(y)[x];
      out.row(y)[x] = {v, v, v};
    }
  return out;
}

}  // namespace

Image<Rgb8> PictureSink::depth(ImageView<const float> depth_m) {
  constexpr float kFollow = 0.1F;
  const auto [near_m, far_m] = report::depth_range(depth_m);
  const bool first = far_m_ <= 0;
  near_m_ = first ? near_m : near_m_ + kFollow * (near_m - near_m_);
  far_m_ = first ? far_m : far_m_ + kFollow * (far_m - far_m_);
  return report::depth_picture(depth_m, near_m_, far_m_);
}

Result<void> PictureSink::put(View view, const output::Composite& composite,
                              ImageView<const Rgb8> picture) {
  constexpr int kQuality = 80;
  pictures_->give(view, picture, composite.capture->number, composite.capture->mid_exposure);
  if (!pictures_->is_looked_at(view)) return {};
  auto made = std::make_shared<Picture>();
  MIXRIG_ASSIGN(made->jpeg, image_io::encode_jpeg(picture, kQuality));
  made->frame = composite.capture->number;
  made->mid_exposure = composite.capture->mid_exposure;
  pictures_->put(view, std::move(made));
  return {};
}

Result<void> PictureSink::write(const output::CompositePtr& composite) {
  const render::FrameOutput& images = composite->images;
  const auto has = [&](View view, render::OutputMask needs) {
    return pictures_->is_wanted(view) && (images.wanted & needs) == needs;
  };
  if (has(View::kComposite, render::kColor))
    MIXRIG_TRY(put(View::kComposite, *composite, images.color));
  if (has(View::kPlate, 0))
    MIXRIG_TRY(put(View::kPlate, *composite, plate_of(*composite->capture)));
  if (has(View::kKey, render::kState))
    MIXRIG_TRY(put(View::kKey, *composite, report::key_picture(images.state)));
  if (has(View::kDepth, render::kMixedDepth))
    MIXRIG_TRY(put(View::kDepth, *composite, depth(images.mixed_depth_m)));
  if (has(View::kLight, render::kLight))
    MIXRIG_TRY(put(View::kLight, *composite, report::light_picture(images.light)));
  if (has(View::kMatte, render::kMatte))
    MIXRIG_TRY(put(View::kMatte, *composite, gray(images.matte)));
  return {};
}

}  // namespace mixrig::page
