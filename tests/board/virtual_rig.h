// SPDX-License-Identifier: Apache-2.0
// A whole virtual rig: the trigger firmware fires a colour and a ToF camera, and a GPIO line of the
// host receives the colour camera's trigger; there are also a pan-tilt unit and two free-running
// cameras.
#pragma once

#include <atomic>
#include <memory>
#include <string>
#include <vector>

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
  /// False, with a test failure, when something did not appear.
  bool plug();
  bool plug_color();
  bool plug_depth();
  bool plug_head();
  /// From now on the colour camera sees the room at the head's angle when it is fired.
  void show_room() { shows_room_ = true; }
  /// Writes rig.toml. Errors show as a missing file.
  void write_config(const std::string& path) const;

 private:
  void fire(int line, std::uint32_t tick);
  std::vector<std::uint8_t> room_now();
  std::atomic<bool> shows_room_ = false;
};

}  // namespace mixrig::board
