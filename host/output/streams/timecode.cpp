// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/timecode.h"

#include <algorithm>
#include <cmath>
#include <ctime>
#include <utility>

namespace mixrig::output {
namespace {

constexpr std::int64_t kDay_s = 24 * 3600;

std::int64_t wrapped(std::int64_t number, std::int64_t of) { return (number % of + of) % of; }

}  // namespace

Timecode timecode_of(std::int64_t number, unsigned per_second) {
  const std::int64_t rate = per_second;
  const auto of_day = static_cast<std::uint64_t>(wrapped(number, kDay_s * rate));
  const std::uint64_t second = of_day / per_second;
  return {static_cast<unsigned>(second / 3600), static_cast<unsigned>(second / 60 % 60),
          static_cast<unsigned>(second % 60), static_cast<unsigned>(of_day % per_second)};
}

TimecodeCounter::TimecodeCounter(double rate_hz, DayAtZero day_at_zero)
    : rate_hz_(rate_hz),
      per_second_(static_cast<unsigned>(std::max(1L, std::lround(rate_hz)))),
      day_at_zero_(std::move(day_at_zero)) {}

Timecode TimecodeCounter::next(HostTime mid_exposure) {
  const Duration day = day_at_zero_ ? day_at_zero_(mid_exposure) : Duration();
  if (!first_ || day != day_) {
    first_ = mid_exposure, day_ = day;
    const Duration of_day = day_at_zero_ ? day + mid_exposure.time_since_epoch() : Duration();
    first_number_ = std::llround(seconds(of_day) * per_second_);
  }
  const std::int64_t later = std::llround(seconds(mid_exposure - *first_) * rate_hz_);
  return timecode_of(first_number_ + later, per_second_);
}

Duration local_day_at_zero(std::int64_t epoch_ns, HostTime now) {
  constexpr std::int64_t kNs = 1'000'000'000;
  const auto since_1970_s =
      static_cast<std::time_t>((epoch_ns + now.time_since_epoch().count()) / kNs);
  std::tm local{};
  localtime_r(&since_1970_s, &local);
  return Duration(wrapped(epoch_ns + local.tm_gmtoff * kNs, kDay_s * kNs));
}

DayAtZero local_day_by(EpochReader epoch) {
  return [held = HeldEpoch(std::move(epoch))](HostTime now) mutable {
    return local_day_at_zero(held.at(now), now);
  };
}

}  // namespace mixrig::output
