// SPDX-License-Identifier: Apache-2.0
// mixrig record: live devices into a take.
#include <cstdio>
#include <memory>

#include "hal/linux/service_notify.h"
#include "host/app/live_source.h"
#include "host/app/rig_json.h"
#include "host/rig/record.h"
#include "host/rig/rig_config.h"
#include "host/tools/command.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

constexpr Duration kNotifyEvery = std::chrono::seconds(1);

struct Words {
  std::string rig = "rig.toml", out, format = "mkv";
  double duration_s = 10, keep_free_mb = 512;
};

Result<nlohmann::json> record(const Words& words) {
  MIXRIG_ASSIGN(const rig::RigConfig config, rig::read_rig(words.rig));
  SystemClock clock;
  MIXRIG_ASSIGN(rig::Devices devices,
                rig::open_devices(config, rig::DeviceOpener(clock, app::open_playable)));
  rig::RecordOptions options;
  options.out = words.out;
  options.duration = Duration(static_cast<long>(words.duration_s * 1e9));
  options.least_free_bytes = static_cast<std::uint64_t>(words.keep_free_mb * 1048576.0);
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
                rig::record(session, config, devices, options, StopOnSignal::flag(), clock));
  std::printf("%s: %d frames, %llu left out, ended: %s\n", words.out.c_str(), report.frames,
              static_cast<unsigned long long>(report.left_out), report.ended.c_str());
  nlohmann::json json = app::to_json(report.session);
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
  command
      ->add_option("--keep-free", words->keep_free_mb,
                   "megabytes of the disk to leave; the take ends, whole, before")
      ->capture_default_str()
      ->check(CLI::Range(0.0, 1e9));
  command->add_option("--format", words->format, "of the streams")
      ->capture_default_str()
      ->check(CLI::IsMember({"mkv", "png"}));
  command->callback([&context, words] { context.action = [words] { return record(*words); }; });
}

}  // namespace mixrig::tools
