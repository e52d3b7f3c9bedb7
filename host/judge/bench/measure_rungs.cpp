// SPDX-License-Identifier: Apache-2.0
#include "host/judge/bench/contender.h"

namespace mixrig::bench {

void add_errors(const measure::Errors& errors, bool depth, const std::vector<Measure>& measures,
                Row& row) {
  if (depth) {
    row.bad_pct = errors.depth_bad_pct;
    row.band_bad_pct = errors.band_bad_pct;
    row.mae_mm = errors.depth_mae_mm;
  }
  for (const Measure& measure : measures)
    if (const auto value = measure.of(errors)) row.more.emplace_back(measure.key, *value);
}

Result<std::vector<Row>> measure_all(const std::vector<ContenderPtr>& contenders,
                                     std::size_t frames, int rounds, const std::string& what,
                                     const ProgressFn& progress) {
  std::vector<std::vector<float>> times_ms(contenders.size());
  const int total = rounds * static_cast<int>(frames) + static_cast<int>(frames);
  int done = 0;
  const auto step = [&] {
    if (progress) progress(what, ++done, total);
  };
  for (const ContenderPtr& contender : contenders) {
    // Not counted: memory is touched and shaders are built in it.
    if (auto fine = contender->time(0); !fine) return fine.error();
  }
  for (int round = 0; round < rounds; ++round)
    for (std::size_t f = 0; f < frames; ++f, step())
      for (std::size_t k = 0; k < contenders.size(); ++k) {
        const std::size_t i = (k + f) % contenders.size();
        MIXRIG_ASSIGN(const float ms, contenders[i]->time(f));
        times_ms[i].push_back(ms);
      }
  for (std::size_t f = 0; f < frames; ++f, step())
    for (const ContenderPtr& contender : contenders) MIXRIG_TRY(contender->judge(f));
  std::vector<Row> rows;
  for (std::size_t i = 0; i < contenders.size(); ++i) {
    rows.push_back(contenders[i]->row());
    if (times_ms[i].front() >= 0) rows.back().times_ms = std::move(times_ms[i]);
  }
  return rows;
}

}  // namespace mixrig::bench
