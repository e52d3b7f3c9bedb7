// SPDX-License-Identifier: Apache-2.0
// mixrig trigger: state, channels, start and stop of the trigger controller; its ticks live.
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>

#include <nlohmann/json.hpp>

#include "hal/linux/serial_byte_stream.h"
#include "hal/wire/trigger/mcu_trigger.h"
#include "host/capture/sync/clock_map.h"
#include "host/tools/command.h"

namespace mixrig::tools {
namespace {

using device::McuTrigger;
using std::chrono::microseconds;

struct TriggerArguments {
  std::string port = "/dev/ttyUSB0";
  int channel = 0;
  int divider = 0;
  double phase_ms = 0, width_ms = 1;
  bool active_low = false, self_test = false, every_tick = false;
  double duration_s = 0;
};

Result<std::unique_ptr<McuTrigger>> open_trigger(const TriggerArguments& arguments, Clock& clock) {
  MIXRIG_ASSIGN(auto stream, device::open_byte_stream(arguments.port));
  return McuTrigger::open(std::move(stream), clock, arguments.port);
}

const char* state_text(device::TriggerState state) {
  static constexpr const char* kTexts[] = {"idle", "armed", "running"};
  return kTexts[static_cast<int>(state)];
}

void print_info(const device::TriggerInfo& info) {
  std::printf("firmware %s on %s, clock: %s, last reset: %s, image %08x, unit %s\n",
              info.version.c_str(), info.uri.c_str(), info.clock.c_str(), info.reset_cause.c_str(),
              info.image_crc, info.unique_id.c_str());
}

void print_status(const device::TriggerStatus& status) {
  std::printf("%s, tick %llu, up %.1f s, round trip %.2f ms\n", state_text(status.state),
              static_cast<unsigned long long>(status.tick), seconds(status.now.time_since_epoch()),
              milliseconds(status.answered - status.asked));
  std::printf("tick interrupt: at most %.1f us late, %.1f us long\n",
              seconds(status.late_max) * 1e6, seconds(status.cost_max) * 1e6);
  bool any = false;
  for (const device::TriggerFault& fault : status.faults) {
    if (fault.count == 0) continue;
    any = true;
    std::printf("  %-18s %6llu  %s\n", fault.name.c_str(),
                static_cast<unsigned long long>(fault.count), fault.meaning.c_str());
  }
  if (!any) std::printf("no faults\n");
}

Result<nlohmann::json> print_channels(McuTrigger& trigger) {
  nlohmann::json channels = nlohmann::json::array();
  for (int i = 0; i < trigger.info().channels; ++i) {
    MIXRIG_ASSIGN(const device::TriggerChannel channel, trigger.channel(i));
    if (channel.divider == 0) continue;
    std::printf("  channel %2d: %.4g Hz, phase %.1f ms, width %.1f ms, active %s\n", i,
                1 / (seconds(trigger.info().tick) * channel.divider), milliseconds(channel.phase),
                milliseconds(channel.width), channel.active_low ? "low" : "high");
    channels.push_back({{"channel", i},
                        {"divider", channel.divider},
                        {"phase_ms", milliseconds(channel.phase)},
                        {"width_ms", milliseconds(channel.width)},
                        {"active_low", channel.active_low}});
  }
  return channels;
}

nlohmann::json status_json(const device::TriggerInfo& info, const device::TriggerStatus& status) {
  nlohmann::json faults;
  for (const device::TriggerFault& fault : status.faults) faults[fault.name] = fault.count;
  return {{"uri", info.uri},
          {"version", info.version},
          {"clock", info.clock},
          {"reset_cause", info.reset_cause},
          {"state", state_text(status.state)},
          {"tick", status.tick},
          {"late_max_us", seconds(status.late_max) * 1e6},
          {"cost_max_us", seconds(status.cost_max) * 1e6},
          {"round_trip_ms", milliseconds(status.answered - status.asked)},
          {"faults", faults}};
}

Result<nlohmann::json> show_status(const TriggerArguments& arguments) {
  SystemClock clock;
  MIXRIG_ASSIGN(const auto trigger, open_trigger(arguments, clock));
  MIXRIG_ASSIGN(const device::TriggerStatus status, trigger->status());
  print_info(trigger->info());
  print_status(status);
  nlohmann::json report = status_json(trigger->info(), status);
  MIXRIG_ASSIGN(report["channels"], print_channels(*trigger));
  if (arguments.self_test) {
    MIXRIG_ASSIGN(const auto failed, trigger->self_test());
    report["self_test_failed"] = failed;
    for (const std::string& name : failed) std::printf("self-test failed: %s\n", name.c_str());
    if (!failed.empty()) {
      return Error{ErrorCode::kDevice,
                   "self-test of the trigger controller failed: " + failed.front()};
    }
    std::printf("self-test passed\n");
  }
  return report;
}

Result<Duration> whole_slots(double ms, const char* option) {
  const double slots = ms * 10;
  if (!(std::abs(slots - std::round(slots)) < 1e-6) || ms < 0 || ms > 6000) {
    return Error{ErrorCode::kUsage,
                 std::string(option) + " takes milliseconds in steps of 0.1, 0 to 6000"};
  }
  return Duration(microseconds(static_cast<std::int64_t>(std::round(slots)) * 100));
}

Result<nlohmann::json> set_channel(const TriggerArguments& arguments) {
  device::TriggerChannel channel{arguments.divider, {}, {}, arguments.active_low};
  MIXRIG_ASSIGN(channel.phase, whole_slots(arguments.phase_ms, "--phase"));
  MIXRIG_ASSIGN(channel.width, whole_slots(arguments.width_ms, "--width"));
  SystemClock clock;
  MIXRIG_ASSIGN(const auto trigger, open_trigger(arguments, clock));
  MIXRIG_TRY(trigger->configure(arguments.channel, channel));
  nlohmann::json report;
  MIXRIG_ASSIGN(report["channels"], print_channels(*trigger));
  return report;
}

Result<nlohmann::json> start_or_stop(const TriggerArguments& arguments, bool start) {
  SystemClock clock;
  MIXRIG_ASSIGN(const auto trigger, open_trigger(arguments, clock));
  if (start) {
    MIXRIG_TRY(trigger->start());
  } else {
    MIXRIG_TRY(trigger->stop());
  }
  MIXRIG_ASSIGN(const device::TriggerStatus status, trigger->status());
  print_status(status);
  return status_json(trigger->info(), status);
}

/// One line per second: tick number, reports received, relation of the clocks.
Result<nlohmann::json> monitor(const TriggerArguments& arguments) {
  SystemClock clock;
  MIXRIG_ASSIGN(const auto trigger, open_trigger(arguments, clock));
  print_info(trigger->info());
  sync::ClockMap map;
  const HostTime begin = clock.now();
  HostTime next_status = begin, next_line = begin + std::chrono::seconds(1);
  std::array<device::TriggerTick, 64> ticks;
  std::uint64_t got = 0;
  device::TriggerStatus status;
  const auto wanted = Duration(static_cast<std::int64_t>(arguments.duration_s * 1e9));
  while (arguments.duration_s <= 0 || clock.now() - begin < wanted) {
    MIXRIG_ASSIGN(const std::size_t n, trigger->read_ticks(ticks, std::chrono::milliseconds(20)));
    got += n;
    for (std::size_t i = 0; i < n && arguments.every_tick; ++i) {
      std::printf("tick %llu at %.6f s, channels %04x\n",
                  static_cast<unsigned long long>(ticks[i].tick),
                  seconds(ticks[i].at.time_since_epoch()), ticks[i].channels);
    }
    if (clock.now() >= next_status) {
      next_status += std::chrono::milliseconds(100);
      MIXRIG_ASSIGN(status, trigger->status());
      map.add(status.now, status.asked, status.answered);
    }
    if (clock.now() < next_line) continue;
    next_line += std::chrono::seconds(1);
    std::printf("%s, tick %llu, reports %llu, clock %+.2f ppm, known to %.0f us\n",
                state_text(status.state), static_cast<unsigned long long>(status.tick),
                static_cast<unsigned long long>(got), map.drift_ppm(),
                seconds(map.bound(status.now).value_or(Duration{0})) * 1e6);
    std::fflush(stdout);
  }
  print_status(status);
  nlohmann::json report = status_json(trigger->info(), status);
  report["reports"] = got;
  report["drift_ppm"] = map.drift_ppm();
  return report;
}

using Action = Result<nlohmann::json> (*)(const TriggerArguments&);

Command add_action(Command parent, Context& context,
                   const std::shared_ptr<TriggerArguments>& arguments, const char* name,
                   const char* what, Action action) {
  Command command = parent.add_subcommand(name, what);
  command.add_option("--port", arguments->port, "serial port, or unix:SOCKET");
  command.callback([&context, arguments, action] {
    context.action = [arguments, action] { return action(*arguments); };
  });
  return command;
}

}  // namespace

void add_trigger_command(Command app, Context& context) {
  auto arguments = std::make_shared<TriggerArguments>();
  Command trigger = app.add_subcommand("trigger", "the controller that triggers the cameras");
  trigger.require_subcommand();
  Command status =
      add_action(trigger, context, arguments, "status", "state, channels and faults", show_status);
  status.add_flag("--self-test", arguments->self_test, "run the self-test of the controller");
  Command set =
      add_action(trigger, context, arguments, "set", "set a stopped channel", set_channel);
  set.add_option("CHANNEL", arguments->channel, "0 to 15").required();
  set.add_option("--divider", arguments->divider, "of 100 Hz: 4 gives 25 Hz; 0 turns it off")
      .required();
  set.add_option("--phase", arguments->phase_ms, "ms after the tick");
  set.add_option("--width", arguments->width_ms, "ms that the pulse lasts");
  set.add_flag("--active-low", arguments->active_low, "the idle level of the line is high");
  add_action(trigger, context, arguments, "start", "run all channels",
             [](const TriggerArguments& w) { return start_or_stop(w, true); });
  add_action(trigger, context, arguments, "stop", "stop; lines go inactive",
             [](const TriggerArguments& w) { return start_or_stop(w, false); });
  Command watch =
      add_action(trigger, context, arguments, "monitor", "ticks and clock, live", monitor);
  watch.add_option("--seconds", arguments->duration_s, "how long; until Ctrl-C if not given")
      .range(0.0, 86400.0);
  watch.add_flag("--ticks", arguments->every_tick, "print every tick");
}

}  // namespace mixrig::tools
