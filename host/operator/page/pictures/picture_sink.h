// SPDX-License-Identifier: Apache-2.0
// Makes the page's pictures from composites.
#pragma once

#include <memory>

#include "host/operator/page/pictures/pictures.h"
#include "host/output/sink/composite_sink.h"

namespace mixrig::page {

/// Requests images only while a client views them. Depth is mixed depth, warm near and cold far, in
/// a range that follows the pictures slowly. JPEG quality: 80.
class PictureSink final : public output::CompositeSink {
 public:
  explicit PictureSink(std::shared_ptr<Pictures> pictures) : pictures_(std::move(pictures)) {}
  std::string_view name() const override { return "page"; }
  bool is_quick() const override { return true; }
  render::OutputMask wanted(int /*number*/) const override { return pictures_->wanted(); }
  Result<void> write(const output::CompositePtr& composite) override;
  Result<void> finish() override { return {}; }

 private:
  Result<void> put(View view, const output::Composite& composite, ImageView<const Rgb8> picture);
  Image<Rgb8> depth(ImageView<const float> depth_m);

  std::shared_ptr<Pictures> pictures_;
  float near_m_ = 0, far_m_ = 0;  ///< 0: not known yet
};

}  // namespace mixrig::page
