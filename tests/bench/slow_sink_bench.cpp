// SPDX-License-Identifier: Apache-2.0
// A live run with one sink that sleeps two seconds now and then: does it delay the compositor or
// the other sink? usage: slow_sink_bench SCENE RIG.TOML SECONDS
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <mutex>
#include <thread>

#include "hal/base/quantile_sketch.h"
#include "host/run/loop/run.h"

namespace mixrig {
namespace {

std::atomic<bool> g_asleep = false;

/// Sleeps two seconds, then takes frames for two seconds, and so on.
class SleepySink final : public output::CompositeSink {
 public:
  std::string_view name() const override { return "sleepy"; }
  render::OutputMask wanted(int) const override { return render::kColor; }
  Result<void> write(const output::CompositePtr&) override {
    constexpr HostTime kNever{};
    const HostTime now = clock_.now();
    if (next_sleep_ == kNever) next_sleep_ = now + std::chrono::seconds(2);
    if (now < next_sleep_) return {};
    g_asleep = true;
    std::this_thread::sleep_for(std::chrono::seconds(2));
    g_asleep = false;
    next_sleep_ = clock_.now() + std::chrono::seconds(2);
    return {};
  }
  Result<void> finish() override { return {}; }

 private:
  SystemClock clock_;
  HostTime next_sleep_{};
};

/// Records the times of frames that were composited while the other sink slept, and of the rest.
class WatchingSink final : public output::CompositeSink {
 public:
  std::string_view name() const override { return "watching"; }
  render::OutputMask wanted(int) const override { return render::kColor; }
  Result<void> write(const output::CompositePtr& composite) override {
    const std::lock_guard lock(mutex);
    (g_asleep ? asleep_ms : awake_ms).add(composite->frame_ms);
    return {};
  }
  Result<void> finish() override { return {}; }

  static std::mutex mutex;
  static measure::QuantileSketch asleep_ms, awake_ms;
};
std::mutex WatchingSink::mutex;
measure::QuantileSketch WatchingSink::asleep_ms, WatchingSink::awake_ms;

int bench(const char* scene, const std::string& rig, int seconds) {
  SystemClock clock;
  std::atomic<bool> stop = false;
  session::SessionOptions words;
  words.scene = scene;
  words.source = "rig:" + rig;
  words.clock = &clock;
  words.stop = &stop;
  const auto session = session::open_session(words);
  if (!session) return std::fprintf(stderr, "%s\n", session.error().context.c_str()), 1;
  session::RunParts parts;
  parts.stop = &stop;
  parts.sinks.push_back(std::make_unique<SleepySink>());
  parts.sinks.push_back(std::make_unique<WatchingSink>());
  std::thread timer([&] {
    std::this_thread::sleep_for(std::chrono::seconds(seconds));
    stop = true;
  });
  const auto report = session::run(**session, {}, clock, {}, std::move(parts));
  timer.join();
  if (!report) return std::fprintf(stderr, "%s\n", report.error().context.c_str()), 1;
  std::fputs(session::to_table(*report).c_str(), stdout);
  for (const auto& sink : report->sinks)
    std::printf("sink %s: %llu written, %llu dropped\n", sink.name.c_str(),
                static_cast<unsigned long long>(sink.written),
                static_cast<unsigned long long>(sink.dropped));
  const auto& awake = WatchingSink::awake_ms;
  const auto& asleep = WatchingSink::asleep_ms;
  std::printf("compositor, other sink awake:  %llu frames, p50 %.2f ms, p99 %.2f ms\n",
              static_cast<unsigned long long>(awake.count()), awake.quantile(0.5),
              awake.quantile(0.99));
  std::printf("compositor, other sink asleep: %llu frames, p50 %.2f ms, p99 %.2f ms\n",
              static_cast<unsigned long long>(asleep.count()), asleep.quantile(0.5),
              asleep.quantile(0.99));
  return 0;
}

}  // namespace
}  // namespace mixrig

int main(int argc, char** argv) {
  if (argc != 4) {
    std::fputs("usage: slow_sink_bench SCENE RIG.TOML SECONDS\n", stderr);
    return 2;
  }
  return mixrig::bench(argv[1], argv[2], std::atoi(argv[3]));
}
