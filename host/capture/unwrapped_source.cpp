// SPDX-License-Identifier: Apache-2.0
#include "host/capture/unwrapped_source.h"

#include <utility>

#include "host/depth/wrapped_depth.h"

namespace mixrig::capture {
namespace {

class UnwrappedSource final : public CaptureSource {
 public:
  explicit UnwrappedSource(std::unique_ptr<CaptureSource> source)
      : source_(std::move(source)),
        wrapped_(source_->info().tof, source_->info().depth_kind == DepthKind::kDistance) {}

  const SourceInfo& info() const override { return source_->info(); }
  Result<bool> read(int number, Capture& capture) override {
    MIXRIG_ASSIGN(const bool there, source_->read(number, capture));
    const Size size = source_->info().tof.size_px();
    if (there && capture.depth_m.size() == size && capture.amplitude.size() == size)
      wrapped_.remove(capture.depth_m, capture.amplitude);
    return there;
  }
  Result<void> read_truth(int number, Truth& truth) override {
    return source_->read_truth(number, truth);
  }
  RenderedHead* head() override { return source_->head(); }
  std::optional<SourceReport> report() const override { return source_->report(); }

 private:
  std::unique_ptr<CaptureSource> source_;
  depth::WrappedDepth wrapped_;
};

}  // namespace

std::unique_ptr<CaptureSource> without_wrapped_depth(std::unique_ptr<CaptureSource> source) {
  if (!source->info().amplitude_is_light) return source;
  return std::make_unique<UnwrappedSource>(std::move(source));
}

}  // namespace mixrig::capture
