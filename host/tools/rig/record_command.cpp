// SPDX-License-Identifier: Apache-2.0
// mixrig record: records live devices into a take.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <memory>

#include <nlohmann/json.hpp>

#include "hal/base/output_folder.h"
#include "hal/linux/service_notify.h"
#include "host/capture/live/rig/rig_config.h"
#include "host/capture/live/session/record.h"
#include "host/capture/open/open_source.h"
#include "host/output/report/rig_json.h"
#include "host/tools/command.h"
#include "host/tools/extras.h"
#include "host/tools/options.h"
#include "host/tools/stop_on_signal.h"

namespace mixrig::tools {
namespace {

constexpr Duration kNotifyEvery = std::chrono::seconds(1);

struct RecordArguments {
  std::string rig = "rig.toml", out, format = "mkv";
  double duration_s = 10, keep_free_mb = 512;
  double segment_minutes = 0, segment_gb = 0, disk_share_pct = 100;
  bool force = false, drop_oldest = false;
};

/// Bytes of the disk that holds the folder, or would hold it; 0 where they are not known.
std::uint64_t disk_bytes(std::filesystem::path folder) {
  std::error_code error;
  folder = std::filesystem::absolute(folder, error);
  while (!std::filesystem::exists(folder, error) && folder.has_relative_path())
    folder = folder.parent_path();
  const auto space = std::filesystem::space(folder, error);
  return error ? 0 : space.capacity;
}

/// Errors: kUsage for options that need segments.
Result<live::Segments> segments_of(const RecordArguments& arguments) {
  live::Segments segments;
  segments.length = Duration(static_cast<long>(arguments.segment_minutes * 60e9));
  segments.bytes = static_cast<std::uint64_t>(arguments.segment_gb * 1e9);
  segments.drop_oldest = arguments.drop_oldest;
  const bool is_limited = arguments.disk_share_pct < 100;
  if (!segments.any() && (is_limited || arguments.drop_oldest))
    return Error{ErrorCode::kUsage,
                 "--disk-share and --drop-oldest are for a recording in segments: add "
                 "--segment-minutes or --segment-gb"};
  if (segments.any() && arguments.force)
    return Error{ErrorCode::kUsage,
                 "--force replaces a take, and segments are added to those in '" + arguments.out +
                     "': leave it out"};
  if (is_limited)
    segments.most_bytes = static_cast<std::uint64_t>(
        0.01 * arguments.disk_share_pct * static_cast<double>(disk_bytes(arguments.out)));
  return segments;
}

void print(const RecordArguments& arguments, const live::RecordReport& report) {
  if (report.takes > 1)
    std::printf("%s: %d takes written, %d deleted\n", arguments.out.c_str(), report.takes,
                report.deleted);
  std::printf("%s: %d frames, %llu left out, %llu dropped, ended: %s\n", arguments.out.c_str(),
              report.frames, static_cast<unsigned long long>(report.left_out),
              static_cast<unsigned long long>(report.session.dropped_sets), report.ended.c_str());
}

Result<nlohmann::json> record(const RecordArguments& arguments) {
  MIXRIG_ASSIGN(const live::Segments segments, segments_of(arguments));
  if (!segments.any()) {
    MIXRIG_TRY(check_output_folder(arguments.out, "take.toml",
                                   arguments.force ? Force::kYes : Force::kNo));
  }
  MIXRIG_ASSIGN(const live::RigConfig config, live::read_rig(arguments.rig));
  SystemClock clock;
  MIXRIG_ASSIGN(live::Devices devices,
                live::open_devices(config, session::device_opener(config, source_kinds(), clock)));
  live::RecordOptions options;
  options.out = arguments.out;
  options.segments = segments;
  options.duration = Duration(static_cast<long>(arguments.duration_s * 1e9));
  options.least_free_bytes = static_cast<std::uint64_t>(arguments.keep_free_mb * 1048576.0);
  options.format =
      arguments.format == "png" ? take::StreamFormat::kPng : take::StreamFormat::kMatroska;
  Progress progress("recording, seconds",
                    std::max(1, static_cast<int>(std::ceil(arguments.duration_s))));
  HostTime notified{};
  options.progress = [&](double share) {
    progress.step(static_cast<int>(share * arguments.duration_s));
    if (clock.now() - notified < kNotifyEvery) return;
    notified = clock.now();
    device::notify_service("READY=1\nWATCHDOG=1");  // only while frames come
  };
  live::LiveSession session(config, devices, clock);
  const StopOnSignal signals;
  MIXRIG_ASSIGN(const live::RecordReport report,
                live::record(session, config, devices, options, StopOnSignal::flag(), clock));
  print(arguments, report);
  nlohmann::json json = report::to_json(report.session);
  json["frames"] = report.frames;
  json["left_out"] = report.left_out;
  json["ended"] = report.ended;
  json["takes"] = report.takes, json["deleted"] = report.deleted;
  return with_end(std::move(json), arguments.out, "mixrig info " + arguments.out);
}

}  // namespace

void add_record_command(Command app, Context& context) {
  auto arguments = std::make_shared<RecordArguments>();
  Command command = app.add_subcommand("record", "record a take from the devices of a rig");
  command.add_option("OUT", arguments->out, "folder of the take").required();
  command.add_option("--rig", arguments->rig, "rig.toml").show_default();
  command
      .add_option("--duration", arguments->duration_s,
                  "seconds; Ctrl-C ends it earlier; 0: until Ctrl-C")
      .show_default()
      .range(0.0, 86400.0);
  command
      .add_option("--keep-free", arguments->keep_free_mb,
                  "megabytes of disk to keep free; the take ends, complete, before that")
      .show_default()
      .range(0.0, 1e9);
  command.add_option("--format", arguments->format, "of the streams")
      .show_default()
      .one_of({"mkv", "png"});
  command
      .add_option("--segment-minutes", arguments->segment_minutes,
                  "minutes of a take; then the next one follows: OUT/0001, OUT/0002, ..., read as "
                  "one; 0: one take")
      .show_default()
      .range(0.0, 1440.0);
  command.add_option("--segment-gb", arguments->segment_gb, "GB of a take; 0: any")
      .show_default()
      .range(0.0, 1e6);
  command
      .add_option("--disk-share", arguments->disk_share_pct,
                  "percent of the disk for segments; recording ends there")
      .show_default()
      .range(1.0, 100.0);
  command.add_flag("--drop-oldest", arguments->drop_oldest,
                   "delete the oldest segment where space is short");
  command.add_flag("--force", arguments->force, "replace a take that OUT holds");
  command.callback(
      [&context, arguments] { context.action = [arguments] { return record(*arguments); }; });
}

}  // namespace mixrig::tools
