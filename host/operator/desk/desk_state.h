// SPDX-License-Identifier: Apache-2.0
// Parts of a run's state for the operator's page. Thread-safe.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "host/operator/page/operator.h"
#include "host/run/session/session.h"

namespace mixrig::session {

std::vector<page::CameraState> cameras_of(const Session& session);
std::vector<page::StreamState> streams_of(const Session& session);
/// `zoomed`, `focused`: the lens was moved since the calibration.
page::CalibrationState calibration_of(const Session& session, bool zoomed, bool focused);
/// `clicked`: output::RunState::focus_px.
page::FocusState focus_of(const std::optional<scene::FocusSettings>& focus,
                          const std::optional<glm::ivec2>& clicked, Size view);
/// Free space, GB, at the first existing folder at or above `folder`.
std::optional<double> free_gb(std::filesystem::path folder);

}  // namespace mixrig::session
