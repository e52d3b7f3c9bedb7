// SPDX-License-Identifier: Apache-2.0
// Parts of a run's state as the operator's page has them. Any threads.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include "host/operator/page/operator.h"
#include "host/run/session/session.h"

namespace mixrig::session {

std::vector<page::CameraState> cameras_of(const Session& session);
std::vector<page::StreamState> streams_of(const Session& session);
/// `zoomed`, `focused`: a lens was moved since the calibration.
page::CalibrationState calibration_of(const Session& session, bool zoomed, bool focused);
/// `clicked` as output::RunState::focus_px.
page::FocusState focus_of(const std::optional<scene::FocusSettings>& focus,
                          const std::optional<glm::ivec2>& clicked, Size view);
/// Of the first folder above it that is there.
std::optional<double> free_gb(std::filesystem::path folder);

}  // namespace mixrig::session
