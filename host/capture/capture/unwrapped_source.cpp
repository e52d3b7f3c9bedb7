// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/unwrapped_source.h"

#include <optional>
#include <utility>

#include "host/capture/depth/wrapped_depth.h"

namespace mixrig::capture {
namespace {

class UnwrappedSource final : public CaptureSource {
 public:
  explicit UnwrappedSource(std::unique_ptr<CaptureSource> source) : source_(std::move(source)) {
    const SourceInfo& info = source_->info();
    if (info.amplitude_is_light)
      wrapped_.emplace(info.tof, info.depth_kind == DepthKind::kDistance);
    if (info.tof2 && info.tof2->amplitude_is_light)
      wrapped2_.emplace(info.tof2->model, info.tof2->kind == DepthKind::kDistance);
  }

  const SourceInfo& info() const override { return source_->info(); }
  Result<bool> read(int number, Capture& capture) override {
    MIXRIG_ASSIGN(const bool there, source_->read(number, capture));
    if (!there) return false;
    const SourceInfo& info = source_->info();
    if (wrapped_) remove(*wrapped_, info.tof.size_px(), capture.depth_m, capture.amplitude);
    if (wrapped2_)
      remove(*wrapped2_, info.tof2->model.size_px(), capture.depth2.depth_m,
             capture.depth2.amplitude);
    return true;
  }
  Result<void> read_truth(int number, Truth& truth) override {
    return source_->read_truth(number, truth);
  }
  void share_plates(PlateForms forms) override { source_->share_plates(forms); }
  RenderedRig rendered() override { return source_->rendered(); }
  std::optional<SourceReport> report() const override { return source_->report(); }

 private:
  static void remove(depth::WrappedDepth& wrapped, Size size, Image<float>& depth_m,
                     const Image<float>& amplitude) {
    if (depth_m.size() == size && amplitude.size() == size) wrapped.remove(depth_m, amplitude);
  }

  std::unique_ptr<CaptureSource> source_;
  std::optional<depth::WrappedDepth> wrapped_, wrapped2_;  ///< for cameras whose amplitude is light
};

}  // namespace

std::unique_ptr<CaptureSource> without_wrapped_depth(std::unique_ptr<CaptureSource> source) {
  const SourceInfo& info = source->info();
  if (!info.amplitude_is_light && !(info.tof2 && info.tof2->amplitude_is_light)) return source;
  return std::make_unique<UnwrappedSource>(std::move(source));
}

}  // namespace mixrig::capture
