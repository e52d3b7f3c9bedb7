// SPDX-License-Identifier: Apache-2.0
// The command `mixrig trigger` with the firmware in its own process.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "board_server.h"
#include "firmware/port/sim/sim_line.h"
#include "hal/linux/serial_byte_stream.h"
#include "hal/wire/trigger/mcu_trigger.h"
#include "run_command.h"

namespace mixrig::test {
namespace {

/// The firmware's process behind a socket. (FlashCommand uses a pty instead.)
class SimProcess {
 public:
  SimProcess()
      : port_("unix:" + (folder_ / "line").string()),
        child_({MIXRIG_TRIGGER_SIM, "--socket", folder_ / "line"}, 2 * kCommandLimit_s,
               folder_ / "log") {
    up_ = wait_until([this] { return std::filesystem::exists(folder_ / "line"); });
  }
  const std::string& port() const { return port_; }
  bool up() const { return up_; }
  std::filesystem::path file(const std::string& name) const { return folder_ / name; }

 private:
  TemporaryFolder folder_;
  std::string port_;
  ChildProcess child_;
  bool up_ = false;
};

class TriggerCommand : public ::testing::Test {
 protected:
  void SetUp() override { ASSERT_TRUE(sim_.up()); }
  Outcome trigger(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), "trigger");
    arguments.insert(arguments.end(), {"--port", sim_.port()});
    return run_mixrig(arguments);
  }
  /// Runs the command and returns its report.
  nlohmann::json report(std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), {"--json", sim_.file("report.json")});
    const Outcome outcome = trigger(arguments);
    EXPECT_EQ(outcome.status, 0) << outcome.err;
    EXPECT_EQ(outcome.err, "");
    return nlohmann::json::parse(read_bytes(sim_.file("report.json")));
  }
  void expect_refusal(const Outcome& outcome, int status, const std::string& text) {
    EXPECT_EQ(outcome.status, status) << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_TRUE(outcome.says(text)) << outcome.err;
  }

  SimProcess sim_;
};

TEST_F(TriggerCommand, status_of_a_fresh_controller_has_no_faults) {
  const Outcome outcome = trigger({"status", "--self-test"});
  ASSERT_EQ(outcome.status, 0) << outcome.err;
  for (const char* text : {"firmware 0.1.0", "idle", "no faults", "self-test passed"})
    EXPECT_TRUE(outcome.says(text)) << text << "\n" << outcome.out;
  const auto json = report({"status"});
  EXPECT_EQ(json["state"], "idle");
  EXPECT_EQ(json["version"], "0.1.0");
  EXPECT_EQ(json["channels"].size(), 0u);
  EXPECT_EQ(json["faults"]["tick_missed"], 0);
}

TEST_F(TriggerCommand, channels_are_set_keep_running_without_the_host_and_stop) {
  EXPECT_EQ(report({"set", "0", "--divider", "4"})["channels"].size(), 1u);
  const auto channels =
      report({"set", "3", "--divider", "10", "--phase", "2.5", "--width", "5", "--active-low"});
  EXPECT_EQ(channels["channels"][1], (nlohmann::json{{"channel", 3},
                                                     {"divider", 10},
                                                     {"phase_ms", 2.5},
                                                     {"width_ms", 5.0},
                                                     {"active_low", true}}));
  EXPECT_EQ(report({"start"})["state"], "running");
  const auto running = report({"status"});  // another process, later
  EXPECT_EQ(running["state"], "running");
  EXPECT_EQ(running["channels"].size(), 2u);
  expect_refusal(trigger({"set", "0", "--divider", "5"}), 1, "stop it first");
  EXPECT_EQ(report({"stop"})["state"], "idle");
  EXPECT_EQ(report({"set", "0", "--divider", "0"})["channels"].size(), 1u);
}

TEST_F(TriggerCommand, monitor_reports_ticks_and_clock) {
  report({"set", "0", "--divider", "2"});
  report({"start"});
  const auto json = report({"monitor", "--seconds", "1"});
  EXPECT_EQ(json["state"], "running");
  EXPECT_GT(json["reports"], 0);
  EXPECT_GE(json["tick"], json["reports"].get<int>() - 1);
  const Outcome ticks = trigger({"monitor", "--seconds", "0.5", "--ticks"});
  EXPECT_EQ(ticks.status, 0) << ticks.err;
  EXPECT_TRUE(ticks.says("channels 0001")) << ticks.out;
}

TEST_F(TriggerCommand, wrong_values_are_usage_and_change_nothing) {
  expect_refusal(trigger({"set", "16", "--divider", "1"}), 2, "channels 0 to 15");
  expect_refusal(trigger({"set", "0", "--divider", "601"}), 2, "0 (off) to 600");
  expect_refusal(trigger({"set", "0", "--divider", "1", "--phase", "0.05"}), 2, "steps of 0.1");
  expect_refusal(trigger({"set", "0", "--divider", "1", "--width", "10"}), 2, "its period");
  expect_refusal(trigger({"set", "0", "--divider", "1", "--width", "0"}), 2, "at least 0.1 ms");
  expect_refusal(trigger({"set", "--divider", "1"}), 2, "CHANNEL");
  expect_refusal(trigger({}), 2, "trigger");
  EXPECT_EQ(report({"status"})["channels"].size(), 0u);
}

TEST(TriggerCommandAlone, a_missing_port_is_one_error_line) {
  for (const char* port : {"unix:/nonexistent/socket", "/nonexistent/tty"}) {
    const Outcome outcome = run_mixrig({"trigger", "status", "--port", port});
    EXPECT_EQ(outcome.status, 2) << outcome.err;
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_TRUE(outcome.says("/nonexistent/")) << outcome.err;
  }
}

TEST(TriggerCommandAlone, no_answer_is_a_failure_with_one_error_line) {
  const TemporaryFolder folder;
  std::string error;
  const auto unserved = sim::SimLine::open_pty(folder / "port", error);
  ASSERT_TRUE(unserved) << error;
  const Outcome outcome = run_mixrig({"trigger", "status", "--port", folder / "port"});
  EXPECT_EQ(outcome.status, 1);
  EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
  EXPECT_TRUE(outcome.says("no answer from the trigger controller")) << outcome.err;
}

/// Firmware with another message table: it answers Hello, whose layout never changes.
class OtherFirmware {
 public:
  std::vector<std::uint8_t> step(std::span<const std::uint8_t> from_host) {
    std::vector<std::uint8_t> sent;
    for (const std::uint8_t byte : from_host) {
      if (decoder_.push(byte) != protocol::FrameEvent::kFrame) continue;
      protocol::HelloReply hello;
      hello.table_hash = protocol::kTableHash ^ 1;
      hello.version = {9, 8, 7};
      std::array<std::uint8_t, protocol::kMaxBody> body{
          static_cast<std::uint8_t>(protocol::Verdict::kTableMismatch)};
      const std::size_t size = 1 + protocol::write_message(hello, std::span(body).subspan(1));
      std::array<std::uint8_t, protocol::kMaxWire> wire;
      const auto type = static_cast<std::uint8_t>(decoder_.type() | protocol::kReplyBit);
      const std::size_t n =
          protocol::encode_frame(type, decoder_.sequence(), {body.data(), size}, wire);
      sent.insert(sent.end(), wire.begin(), wire.begin() + static_cast<std::ptrdiff_t>(n));
    }
    return sent;
  }

 private:
  protocol::FrameDecoder decoder_;
};

TEST(TriggerCommandAlone, firmware_of_another_version_is_refused_and_named) {
  const TemporaryFolder folder;
  const PtyServer<OtherFirmware> server(folder / "port");
  for (const char* what : {"status", "start", "monitor"}) {
    const Outcome outcome = run_mixrig({"trigger", what, "--port", folder / "port"});
    EXPECT_EQ(outcome.status, 1);
    EXPECT_EQ(outcome.error_lines(), 1) << outcome.err;
    EXPECT_TRUE(outcome.says("(firmware 9.8.7) runs firmware of another version: mixrig flash"))
        << outcome.err;
  }
}

}  // namespace
}  // namespace mixrig::test
