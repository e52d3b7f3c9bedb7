// SPDX-License-Identifier: Apache-2.0
// Converts reports of the rig to JSON.
#pragma once

#include <nlohmann/json.hpp>

#include "host/capture/capture/source_report.h"

namespace mixrig::report {

inline nlohmann::json to_json(const capture::SourceReport& report) {
  nlohmann::json streams = nlohmann::json::array();
  for (const capture::StreamReport& stream : report.streams) {
    nlohmann::json pairing = {{"missing", stream.pairing.missing},
                              {"relocks", stream.pairing.relocks},
                              {"clock_doubts", stream.pairing.clock_doubts}};
    for (int i = 0; i < sync::kPairStatuses; ++i) {
      const auto status = static_cast<sync::PairStatus>(i);
      pairing[std::string(sync::name(status))] = stream.pairing.of(status);
    }
    streams.push_back({{"name", stream.name},
                       {"uri", stream.uri},
                       {"state", std::string(device::name(stream.health.state))},
                       {"frames", stream.health.frames},
                       {"lost", stream.health.lost},
                       {"incomplete", stream.health.incomplete},
                       {"overrun", stream.health.overrun},
                       {"link_errors", stream.health.link_errors},
                       {"returns", stream.health.returns},
                       {"drift_ppm", stream.drift_ppm},
                       {"residual_mean_ms", stream.residual_mean_ms},
                       {"residual_sd_ms", stream.residual_sd_ms},
                       {"pairing", pairing}});
  }
  return {{"streams", streams},
          {"sets", report.sets},
          {"incomplete_sets", report.incomplete_sets},
          {"dropped_sets", report.dropped_sets},
          {"dropped_events", report.dropped_events},
          {"ticks", report.ticks},
          {"ticks_lost", report.ticks_lost},
          {"trigger_restarts", report.trigger_restarts},
          {"trigger_errors", report.trigger_errors},
          {"edges",
           {{"seen", report.edges.edges},
            {"lost", report.edges.lost},
            {"doubled", report.edges.doubled},
            {"filled_ticks", report.edges.filled},
            {"offset_mean_ms", report.edges.offset_mean_ms},
            {"offset_sd_ms", report.edges.offset_sd_ms},
            {"offset_max_ms", report.edges.offset_max_ms}}},
          {"sets_without_angle", report.sets_without_angle},
          {"pan_tilt_samples", report.pan_tilt_samples},
          {"pan_tilt_errors", report.pan_tilt_errors}};
}

}  // namespace mixrig::report
