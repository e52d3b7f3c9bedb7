// SPDX-License-Identifier: Apache-2.0
#include "host/tools/room/map_jobs.h"

#include <cstdio>

#include <nlohmann/json.hpp>

#include "extras/map/learn/map_track.h"
#include "hal/base/partial_path.h"
#include "host/tools/command.h"

namespace mixrig::tools {

Result<nlohmann::json> track_in_map(const MapTrackArguments& arguments) {
  session::MapTrackOptions options;
  options.map = arguments.map, options.take = arguments.take;
  options.calibration = arguments.calibration, options.threads = arguments.threads;
  options.world_from_room = arguments.world_from_room;
  MIXRIG_ASSIGN(const session::MapTrack track, session::track_map(options));
  const nlohmann::json& json = track.report;
  std::printf("%d pictures, %.1f %% without a pose, %.0f pictures a second\n",
              json["frames"].get<int>(), json["lost_pct"].get<double>(), json["fps"].get<double>());
  if (json.contains("rms_mm")) {
    const std::string of = json.contains("aligned")
                               ? "camera after " + json["aligned"].get<std::string>() + " alignment"
                               : "target camera";
    std::printf("error of the %s: %.2f mm RMS, 95 %% within %.2f mm, %.4f deg RMS\n", of.c_str(),
                json["rms_mm"].get<double>(), json["p95_mm"].get<double>(),
                json["rms_deg"].get<double>());
  }
  if (track.lost)
    return Error{ErrorCode::kData, arguments.take +
                                       ": the map explains none of its pictures: is it a take of "
                                       "this room, and is the camera calibrated?"};
  if (!arguments.tum.empty()) MIXRIG_TRY(write_file(arguments.tum, track.tum));
  return with_end(json, arguments.tum, as_trajectory(arguments.tum));
}

Result<nlohmann::json> join_maps(const MapAlignArguments& arguments) {
  MIXRIG_ASSIGN(const nlohmann::json report,
                session::join_maps(arguments.map, arguments.other, arguments.out));
  std::printf("time offset   t_A = t_B %+.6f s  (sigma %.6f s)\n",
              report["time_offset_s"].get<double>(), report["time_offset_sigma_s"].get<double>());
  std::printf("rotation      sigma %.4f deg\nscale         %.5f  (sigma %.2f %%)\n",
              report["rotation_sigma_deg"].get<double>(), report["scale"].get<double>(),
              report["scale_sigma_pct"].get<double>());
  return with_end(report, arguments.out,
                  "mixrig track --map " + arguments.out + " --take TAKE poses.txt");
}

Result<nlohmann::json> place_map(const MapAlignArguments& arguments) {
  session::MapRoomOptions options;
  options.map = arguments.map, options.room = arguments.other, options.out = arguments.out;
  options.calibration = arguments.calibration, options.threads = arguments.threads;
  MIXRIG_ASSIGN(const nlohmann::json report, session::place_map(options));
  const auto number = [&](const char* key) { return report[key].get<double>(); };
  std::printf("%.0f of %.0f key pictures agree, %.0f of %.0f points are on the room's surface\n",
              number("keys_agree"), number("keys"), number("points_agree"), number("points"));
  std::printf("place         sigma %.2f mm, %.4f deg\n", number("sigma_mm"), number("sigma_deg"));
  std::printf("scale         %.5f m per unit  (sigma %.2f %%)\n", number("metres_per_unit"),
              number("scale_sigma_pct"));
  return with_end(report, arguments.out,
                  "mixrig track --map " + arguments.out + " --take TAKE poses.txt");
}

}  // namespace mixrig::tools
