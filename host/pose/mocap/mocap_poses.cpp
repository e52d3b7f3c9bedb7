// SPDX-License-Identifier: Apache-2.0
#include "host/pose/mocap/mocap_poses.h"

#include <atomic>
#include <thread>
#include <utility>

#include <fmt/format.h>

#include "hal/base/guarded.h"
#include "hal/base/log.h"

namespace mixrig::pose {
namespace {

constexpr Duration kLook = std::chrono::milliseconds(100);  // how often stop_ is checked

std::string text_of(const std::string& server, const MocapOptions& options) {
  return fmt::format(
      "mocap: {} of {}, {:.0f} ms from exposure to arrival; at mid-exposure, at most {:.0f} ms "
      "after the newest frame",
      options.constellation ? "constellation \"" + options.constellation->name + "\""
      : options.body_id > 0 ? fmt::format("body {}", options.body_id)
                            : std::string("the only body"),
      server, 1e3 * options.delay_s, 1e3 * options.most_ahead_s);
}

class MocapPoses final : public capture::PoseSource {
 public:
  MocapPoses(const std::string& server, MocapOptions options, stream::NatNetReceiver receiver,
             const Clock& clock)
      : PoseSource({"mocap", text_of(server, options)}),
        track_(std::move(options)),
        receiver_(std::move(receiver)),
        clock_(clock),
        thread_(guarded_thread(
            "receiving", [this] { return listen(); },
            [](const Error& error) {
              log_warning("pose",
                          "motion capture: " + to_line(error) + ": no more poses are received");
            })) {}
  ~MocapPoses() override {
    stop_ = true;
    thread_.join();
  }
  MocapPoses(const MocapPoses&) = delete;
  MocapPoses& operator=(const MocapPoses&) = delete;

  capture::CameraPose pose_of(const capture::Capture& capture) override {
    return track_.at(capture.mid_exposure);
  }
  capture::PoseFaults faults() const override { return track_.faults(); }
  std::optional<capture::PoseStream> stream() const override { return track_.stream(); }

 private:
  Result<void> listen() {
    while (!stop_) {
      MIXRIG_ASSIGN(const auto frame, receiver_.next(kLook));
      if (frame) track_.add(*frame, clock_.now());
      track_.set_packets(receiver_.counts());
    }
    return {};
  }

  MocapTrack track_;
  stream::NatNetReceiver receiver_;
  const Clock& clock_;
  std::atomic<bool> stop_ = false;
  std::thread thread_;
};

}  // namespace

Result<std::unique_ptr<capture::PoseSource>> open_mocap_poses(const std::string& server,
                                                              MocapOptions options,
                                                              const Clock& clock) {
  MIXRIG_ASSIGN(const auto address, stream::parse_natnet_address("natnet:" + server));
  MIXRIG_ASSIGN(auto receiver, stream::NatNetReceiver::open(address, {}, clock));
  return std::unique_ptr<capture::PoseSource>(
      std::make_unique<MocapPoses>(server, std::move(options), std::move(receiver), clock));
}

}  // namespace mixrig::pose
