// SPDX-License-Identifier: Apache-2.0
// Parts of truth files as JSON. Private to this module.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "studio/rig_of_seed.h"

namespace mixrig::studio_io {

nlohmann::json to_json(const Eigen::Vector3d& v);
nlohmann::json to_json(const geometry::Pose& pose);
nlohmann::json to_json(const studio::Optics& o);
nlohmann::json to_json(const studio::PanTiltUnit& unit);
nlohmann::json to_json(const studio::MocapSystem& system);

}  // namespace mixrig::studio_io
