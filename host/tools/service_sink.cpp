// SPDX-License-Identifier: Apache-2.0
#include "host/tools/service_sink.h"

#include <cstdlib>

#include <fmt/format.h>

#include "hal/linux/service_notify.h"

namespace mixrig::tools {
namespace {

constexpr Duration kTellEvery = std::chrono::seconds(1);

class ServiceSink final : public output::CompositeSink {
 public:
  explicit ServiceSink(const Clock& clock) : clock_(clock) {}

  std::string_view name() const override { return "service"; }
  render::OutputMask wanted(int) const override { return render::kColor; }
  Result<void> write(const output::CompositePtr& composite) override {
    const HostTime now = clock_.now();
    if (told_ && now - *told_ < kTellEvery) return {};
    told_ = now;
    device::notify_service(
        fmt::format("READY=1\nWATCHDOG=1\nSTATUS=frame {} composited in {:.1f} ms",
                    composite->capture->number, composite->frame_ms));
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  const Clock& clock_;
  std::optional<HostTime> told_;
};

}  // namespace

std::unique_ptr<output::CompositeSink> make_service_sink(const Clock& clock) {
  if (std::getenv("NOTIFY_SOCKET") == nullptr) return nullptr;
  return std::make_unique<ServiceSink>(clock);
}

}  // namespace mixrig::tools
