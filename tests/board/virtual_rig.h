// SPDX-License-Identifier: Apache-2.0
// A whole virtual rig: the trigger firmware fires a colour and a ToF camera, and a GPIO line of the
// host receives the colour camera's trigger; there are also a pan-tilt unit and two free-running
// cameras.
#pragma once

#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "hal/device/pan_tilt.h"
#include "tests/board/nodes.h"
#include "tests/board/sim_chip.h"
#include "tests/board/tof_device.h"
#include "tests/board/trigger_peer.h"
#include "tests/support/turning_room.h"

namespace mixrig::board {

inline constexpr int kColorLine = 0, kDepthLine = 1, kDivider = 4, kEdgesLine = 3;

inline constexpr Size kColorSize{160, 90};

struct VirtualRig {
  static constexpr double kDrift_ppm = 120;

  SimChip chip;
  UvcDevice color{kColorSize};
  TofDevice depth{{160, 120}, 0};
  PtuPeer head{std::chrono::microseconds(1042)};  // 9600 baud
  TriggerPeer trigger{kDrift_ppm, [this](int line, std::uint32_t tick) { fire(line, tick); }};
  AcmDevice trigger_line{"Trigger controller", trigger}, head_line{"Pan-tilt unit", head};
  VhciPort color_port{0, color}, depth_port{1, depth}, trigger_port{2, trigger_line},
      head_port{3, head_line};
  std::string color_node;
  test::TurningRoom room{140, 79.5};  ///< what the colour camera sees after show_room()

  ~VirtualRig();
  /// Returns false, with a test failure, if a device does not appear.
  bool plug();
  bool plug_color();
  bool plug_depth();
  bool plug_head();
  /// Called on the trigger's thread at the rising edge of a trigger line, before its camera is
  /// fired, with the angles of the head; it shows the camera what it sees. The camera is delayed
  /// until it returns.
  using Look = std::function<void(int line, device::PanTiltAngles at, HostTime now)>;
  /// Sets the callback for the following edges. Thread-safe.
  void set_look(Look look);
  /// From now on the colour camera sees the room at the head's angle when it is fired.
  void show_room();
  /// Writes rig.toml. Errors show as a missing file.
  void write_config(const std::string& path) const;

 private:
  void fire(int line, std::uint32_t tick);
  void look(int line);
  std::mutex mutex_;  ///< guards look_
  Look look_;
};

}  // namespace mixrig::board
