// SPDX-License-Identifier: Apache-2.0
#include "host/capture/preloaded_source.h"

#include <utility>

namespace mixrig::capture {
namespace {

class PreloadedSource final : public CaptureSource {
 public:
  PreloadedSource(std::unique_ptr<CaptureSource> source, std::vector<Capture> captures)
      : source_(std::move(source)), captures_(std::move(captures)) {}

  const SourceInfo& info() const override { return source_->info(); }
  Result<bool> read(int number, Capture& capture) override {
    if (number < 1 || number > static_cast<int>(captures_.size())) return false;
    capture = captures_[static_cast<std::size_t>(number) - 1];
    return true;
  }
  Result<void> read_truth(int number, Truth& truth) override {
    Capture again;
    MIXRIG_TRY(source_->read(number, again));
    return source_->read_truth(number, truth);
  }

 private:
  std::unique_ptr<CaptureSource> source_;
  const std::vector<Capture> captures_;
};

}  // namespace

Result<std::unique_ptr<CaptureSource>> preloaded(std::unique_ptr<CaptureSource> source) {
  const int frames = source->info().frames;
  if (frames == kEndless)
    return Error{ErrorCode::kUsage, source->info().name + " has no end: it cannot be loaded"};
  std::vector<Capture> captures;
  captures.reserve(static_cast<std::size_t>(frames));
  for (int number = 1; number <= frames; ++number) {
    captures.emplace_back();
    MIXRIG_ASSIGN(const bool there, source->read(number, captures.back()));
    if (there) continue;
    captures.pop_back();
    break;
  }
  return std::unique_ptr<CaptureSource>(
      std::make_unique<PreloadedSource>(std::move(source), std::move(captures)));
}

}  // namespace mixrig::capture
