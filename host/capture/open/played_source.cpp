// SPDX-License-Identifier: Apache-2.0
#include "host/capture/open/played_source.h"

#include <utility>

namespace mixrig::session {
namespace {

class PlayedSource final : public capture::CaptureSource {
 public:
  PlayedSource(std::unique_ptr<capture::CaptureSource> source, Clock& clock)
      : source_(std::move(source)), clock_(clock), info_(source_->info()), frames_(info_.frames) {
    constexpr double kUnknownRate_hz = 25;
    period_ = Duration(
        static_cast<Duration::rep>(1e9 / (info_.rate_hz > 0 ? info_.rate_hz : kUnknownRate_hz)));
    info_.frames = capture::kEndless;
    info_.has_truth = info_.true_poses = false;
  }
  const capture::SourceInfo& info() const override { return info_; }
  Result<bool> read(int number, capture::Capture& capture) override {
    MIXRIG_ASSIGN(const bool there, source_->read((number - 1) % frames_ + 1, capture));
    if (!there) return false;
    const HostTime now = clock_.now();
    // After a late read the next captures are not sped up.
    due_ = now > due_ + period_ ? now : due_ + period_;
    clock_.sleep_until(due_);
    capture.number = number;
    capture.mid_exposure = due_;
    return true;
  }
  Result<void> read_truth(int /*number*/, capture::Truth& /*truth*/) override {
    return Error{ErrorCode::kUsage, info_.name + ": a recording that is played has no truth"};
  }

 private:
  std::unique_ptr<capture::CaptureSource> source_;
  Clock& clock_;
  capture::SourceInfo info_;
  const int frames_;
  Duration period_{};
  HostTime due_{};
};

}  // namespace

std::unique_ptr<capture::CaptureSource> played(std::unique_ptr<capture::CaptureSource> source,
                                               Clock& clock) {
  return std::make_unique<PlayedSource>(std::move(source), clock);
}

}  // namespace mixrig::session
