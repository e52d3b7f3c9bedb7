// SPDX-License-Identifier: Apache-2.0
// Sets values of live cameras for an operator: in force at once, and written into rig.toml.
#pragma once

#include <atomic>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "hal/device/camera.h"
#include "host/operator/page/operator.h"
#include "host/run/controls/edit_history.h"
#include "host/run/session/session.h"

namespace mixrig::session {

/// One change at a time.
class CameraDesk {
 public:
  /// Both must outlive it.
  CameraDesk(const Session& session, EditHistory& history) : session_(session), history_(history) {}

  /// Sets values; a preview is not written. Errors: those of page::Operator::apply().
  Result<void> apply(const page::SetCamera& set);
  /// Sets what previews have changed back.
  Result<void> discard();
  /// Whether zoom or focus of a lens was moved in this run.
  bool zoomed() const { return zoomed_; }
  bool focused() const { return focused_; }

 private:
  using Values = std::vector<std::pair<device::CameraControl, double>>;
  void keep_settled(const std::string& camera, device::CameraControl control);
  Values take_settled(const std::string& camera, const Values& changed);

  const Session& session_;
  EditHistory& history_;
  /// Values before previews.
  std::map<std::pair<std::string, device::CameraControl>, double> settled_;
  std::atomic<bool> zoomed_ = false, focused_ = false;
};

}  // namespace mixrig::session
