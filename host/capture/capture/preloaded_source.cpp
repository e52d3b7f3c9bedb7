// SPDX-License-Identifier: Apache-2.0
#include "host/capture/capture/preloaded_source.h"

#include <cmath>
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

/// Repeats a source.
class RepeatedSource final : public CaptureSource {
 public:
  RepeatedSource(std::unique_ptr<CaptureSource> source, int frames)
      : source_(std::move(source)), info_(source_->info()), frames_(info_.frames) {
    info_.frames = frames;
    info_.has_truth = false;
  }

  const SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, Capture& capture) override {
    if (number < 1 || number > info_.frames) return false;
    const int rounds = (number - 1) / frames_;
    MIXRIG_ASSIGN(const bool there, source_->read((number - 1) % frames_ + 1, capture));
    if (!there || rounds == 0) return there;
    const double later_s = rounds * (frames_ / info_.rate_hz);
    capture.number = number;
    capture.time_s += later_s;
    capture.mid_exposure += Duration(std::llround(1e9 * later_s));
    return true;
  }
  Result<void> read_truth(int /*number*/, Truth& /*truth*/) override {
    return Error{ErrorCode::kUsage, info_.name + ": a recording that is repeated has no truth"};
  }

 private:
  std::unique_ptr<CaptureSource> source_;
  SourceInfo info_;
  const int frames_;
};

}  // namespace

std::unique_ptr<CaptureSource> repeated(std::unique_ptr<CaptureSource> source, int frames) {
  return std::make_unique<RepeatedSource>(std::move(source), frames);
}

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
