// SPDX-License-Identifier: Apache-2.0
#include "extras/broadcast/lens/freed_lens.h"

#include <utility>

#include <fmt/format.h>

namespace mixrig::stream {
namespace {

class FreeDLens final : public live::LensReceiver {
 public:
  explicit FreeDLens(FreeDReceiver receiver) : receiver_(std::move(receiver)) {}
  Result<std::optional<geometry::LensEncoders>> next(Duration timeout) override {
    MIXRIG_ASSIGN(const auto packet, receiver_.next(timeout));
    if (!packet) return std::optional<geometry::LensEncoders>();
    return std::optional(geometry::LensEncoders{static_cast<double>(packet->zoom),
                                                static_cast<double>(packet->focus)});
  }
  std::string trouble() const override {
    const StreamCounts& counts = receiver_.counts();
    if (counts.packets > 0 && counts.malformed == 0) return {};
    return fmt::format("{} packets of FreeD came, {} could not be read, {} were of another camera",
                       counts.packets, counts.malformed, counts.foreign);
  }

 private:
  FreeDReceiver receiver_;
};

Result<void> check_freed_lens(const std::string& uri) {
  MIXRIG_TRY(parse_freed_address(uri));
  return {};
}

Result<std::unique_ptr<live::LensReceiver>> open_freed_lens(const std::string& uri) {
  MIXRIG_ASSIGN(const ListenAddress address, parse_freed_address(uri));
  MIXRIG_ASSIGN(auto receiver, FreeDReceiver::open(address));
  return make_freed_lens(std::move(receiver));
}

}  // namespace

live::DeviceKind freed_lens_kind() {
  return {.scheme = "freed",
          .extra = "broadcast",
          .camera_uri = {},
          .depth_uri = {},
          .lens_uri = "freed:[HOST:]PORT[,CAMERA]",
          .make = nullptr,
          .lens = {check_freed_lens, open_freed_lens}};
}

std::unique_ptr<live::LensReceiver> make_freed_lens(FreeDReceiver receiver) {
  return std::make_unique<FreeDLens>(std::move(receiver));
}

}  // namespace mixrig::stream
