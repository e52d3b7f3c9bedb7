// SPDX-License-Identifier: Apache-2.0
// Any bytes from the trigger controller: the host's link and flashing must terminate, with an
// answer or an error.
#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>

#include "hal/wire/flash/flash_image.h"
#include "hal/wire/flash/stm32_rom.h"
#include "hal/wire/trigger/mcu_trigger.h"
#include "tests/fuzz/target.h"

namespace {

using namespace mixrig;

/// Delivers the given bytes, a few per read, then nothing; a read without bytes advances the clock.
class Script final : public device::ByteStream {
 public:
  Script(std::span<const std::uint8_t> bytes, ManualClock& clock) : left_(bytes), clock_(clock) {}
  Result<std::size_t> read(std::span<std::uint8_t> out, Duration timeout) override {
    const std::size_t n = std::min({out.size(), left_.size(), std::size_t{40}});
    if (n == 0) clock_.advance(std::max(timeout, Duration{1'000'000}));
    std::copy_n(left_.begin(), n, out.begin());
    left_ = left_.subspan(n);
    return n;
  }
  Result<void> write(std::span<const std::uint8_t>) override { return {}; }

 private:
  std::span<const std::uint8_t> left_;
  ManualClock& clock_;
};

void open_trigger(std::span<const std::uint8_t> bytes) {
  ManualClock clock;
  auto opened = device::McuTrigger::open(std::make_unique<Script>(bytes, clock), clock, "fuzz");
  if (!opened) return;
  std::array<device::TriggerTick, 16> ticks;
  (void)(*opened)->status();
  (void)(*opened)->read_ticks(ticks, std::chrono::milliseconds(1));
  (void)(*opened)->channel(3);
  (void)(*opened)->self_test();
}

void flash(std::span<const std::uint8_t> bytes) {
  ManualClock clock;
  Script stream(bytes, clock);
  device::Stm32Rom rom(stream, clock);
  const auto quiet = [](const char*, std::size_t, std::size_t) {};
  auto info = rom.connect();
  if (!info) return;
  (void)device::read_previous(rom, *info, 1000, quiet);
  const std::array<std::uint8_t, 1000> image{};
  (void)device::write_flash(rom, *info, image, quiet);
}

}  // namespace

MIXRIG_FUZZ_TARGET(mcu_host) {
  if (size == 0) return 0;
  const std::span bytes(data + 1, size - 1);
  (data[0] & 1) != 0 ? open_trigger(bytes) : flash(bytes);
  return 0;
}
