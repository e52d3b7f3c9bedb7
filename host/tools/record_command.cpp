// SPDX-License-Identifier: Apache-2.0
// mixrig record: live devices into a take.
#include <atomic>
#include <csignal>
#include <cstdio>
#include <memory>

#include "hal/linux/service_notify.h"
#include "host/rig/record.h"
#include "host/rig/rig_config.h"
#include "host/tools/command.h"
#include "host/tools/rig_json.h"

namespace mixrig::tools {
namespace {

constexpr Duration kNotifyEvery = std::chrono::seconds(1);
std::atomic<bool> g_stop = false;
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler sets it");

/// SIGINT and SIGTERM end the recording with a whole take; the old handlers come back after it.
class StopOnSignal {
 public:
  StopOnSignal() {
    g_stop = false;
    old_int_ = std::signal(SIGINT, [](int) { g_stop = true; });
    old_term_ = std::signal(SIGTERM, [](int) { g_stop = true; });
  }
  ~StopOnSignal() {
    std::signal(SIGINT, old_int_);
    std::signal(SIGTERM, old_term_);
  }
  StopOnSignal(const StopOnSignal&) = delete;
  StopOnSignal& operator=(const StopOnSignal&) = delete;

 private:
  void (*old_int_)(int);
  void (*old_term_)(int);
};

struct Words {
  std::string rig = "rig.toml", out, format = "mkv";
  double duration_s = 10;
};

Result<nlohmann::json> record(const Words& words) {
  MIXRIG_ASSIGN(const rig::RigConfig config, rig::read_rig(words.rig));
  SystemClock clock;
  MIXRIG_ASSIGN(rig::Devices devices, rig::open_devices(config, clock));
  rig::RecordOptions options;
  options.out = words.out;
  options.duration = Duration(static_cast<long>(words.duration_s * 1e9));
  options.format = words.format == "png" ? take::StreamFormat::kPng : take::StreamFormat::kMatroska;
  Progress progress("recording", 1000);
  HostTime notified{};
  options.progress = [&](double share) {
    progress.step(static_cast<int>(share * 1000));
    if (clock.now() - notified < kNotifyEvery) return;
    notified = clock.now();
    device::notify_service("READY=1\nWATCHDOG=1");  // only while frames come
  };
  rig::LiveSession session(config, devices, clock);
  const StopOnSignal signals;
  MIXRIG_ASSIGN(const rig::RecordReport report,
                rig::record(session, config, devices, options, g_stop, clock));
  std::printf("%s: %d frames, %llu left out, ended: %s\n", words.out.c_str(), report.frames,
              static_cast<unsigned long long>(report.left_out), report.ended.c_str());
  nlohmann::json json = session_json(report.session);
  json["frames"] = report.frames;
  json["left_out"] = report.left_out;
  json["ended"] = report.ended;
  return json;
}

}  // namespace

void add_record_command(CLI::App& app, Context& context) {
  auto words = std::make_shared<Words>();
  CLI::App* command = app.add_subcommand("record", "record a take from the devices of a rig");
  command->add_option("OUT", words->out, "folder of the take")->required();
  command->add_option("--rig", words->rig, "rig.toml")->capture_default_str();
  command->add_option("--duration", words->duration_s, "seconds; Ctrl-C ends it earlier")
      ->capture_default_str()
      ->check(CLI::Range(0.1, 86400.0));
  command->add_option("--format", words->format, "of the streams")
      ->capture_default_str()
      ->check(CLI::IsMember({"mkv", "png"}));
  command->callback([&context, words] { context.action = [words] { return record(*words); }; });
}

}  // namespace mixrig::tools
