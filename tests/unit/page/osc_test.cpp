// SPDX-License-Identifier: Apache-2.0
// OSC of control surfaces: the effect of each address, the feedback, and who receives answers.
#include "host/output/datagrams/osc.h"

#include <atomic>

#include <arpa/inet.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

#include "host/operator/page/osc/osc_commands.h"
#include "host/operator/page/server.h"
#include "host/operator/page/state_json.h"
#include "tests/support/progress.h"
#include "tests/unit/page/fake_operator.h"

namespace mixrig::page {
namespace {

using nlohmann::json;
using stream::OscArgument;
using stream::OscReceived;

json made_state() {
  State state;
  state.objects.push_back({.name = "old crate"});
  state.lamps.push_back({.name = "key"});
  state.cameras.push_back({"color", {{"exposure_ms", 5, 1, 40, 1}}});
  return to_json(state, {});
}

template <typename C>
C osc_command(const std::string& address, std::vector<OscArgument> arguments = {}) {
  const auto action = action_of(OscReceived{address, std::move(arguments)}, made_state());
  EXPECT_TRUE(action) << (action ? "" : to_line(action.error()));
  const auto* command = action && *action ? std::get_if<Command>(&**action) : nullptr;
  const auto* wanted = command != nullptr ? std::get_if<C>(command) : nullptr;
  EXPECT_NE(wanted, nullptr) << address;
  return wanted != nullptr ? *wanted : C{};
}

TEST(OscCommands, AreThoseOfThePage) {
  EXPECT_EQ(osc_command<StartRecording>("/mixrig/record").name, "");
  EXPECT_EQ(osc_command<StartRecording>("/mixrig/record", {1.0, std::string("shot 1")}).name,
            "shot 1");
  osc_command<StopRecording>("/mixrig/record", {0.0});
  osc_command<LearnBackground>("/mixrig/learn");
  osc_command<SaveScene>("/mixrig/save");
  EXPECT_FALSE(osc_command<Undo>("/mixrig/undo").again);
  EXPECT_TRUE(osc_command<Undo>("/mixrig/redo").again);
  EXPECT_EQ(osc_command<SetObject>("/mixrig/object/old_crate/hidden").hidden, true) << "toggles";
  EXPECT_EQ(osc_command<SetObject>("/mixrig/object/old_crate/hidden", {false}).name, "old crate");
  EXPECT_EQ(osc_command<SetObject>("/mixrig/object/old_crate/at", {0.25, 0.5}).at->x(), 0.25);
  EXPECT_EQ(osc_command<SetLamp>("/mixrig/lamp/key/on").on, false);
  EXPECT_EQ(osc_command<SetLamp>("/mixrig/lamp/key/intensity", {2.0}).intensity->z(), 2);
  const auto camera = osc_command<SetCamera>("/mixrig/camera/color/exposure_ms", {8.0});
  EXPECT_EQ(camera.values, (std::vector<std::pair<std::string, double>>{{"exposure_ms", 8}}));
  EXPECT_EQ(osc_command<SetFocus>("/mixrig/focus/on").on, true) << "toggles";
  EXPECT_EQ(osc_command<SetFocus>("/mixrig/focus/at", {0.25, 0.5}).at->y(), 0.5);
  EXPECT_EQ(osc_command<SetFocus>("/mixrig/focus/distance_m", {2.0}).distance_m, 2.0);
  osc_command<StartSweep>("/mixrig/sweep");
  osc_command<CancelSweep>("/mixrig/sweep", {0.0});
  const auto view = action_of(OscReceived{"/mixrig/view", {std::string("key")}}, made_state());
  EXPECT_EQ(std::get<output::ShowView>(std::get<output::RunOrder>(**view)).view, View::kKey);
  const auto freeze = action_of(OscReceived{"/mixrig/freeze", {}}, made_state());
  EXPECT_TRUE(std::get<output::FreezePictures>(std::get<output::RunOrder>(**freeze)).on);
  EXPECT_FALSE(action_of(OscReceived{"/mixrig/state", {}}, made_state())->has_value());
}

TEST(OscCommands, WhatCannotBeIsRefused) {
  const auto code = [](const std::string& address, std::vector<OscArgument> arguments) {
    const auto action = action_of(OscReceived{address, std::move(arguments)}, made_state());
    return action ? ErrorCode::kIo : action.error().code;
  };
  EXPECT_EQ(code("/other/record", {}), ErrorCode::kNotFound);
  EXPECT_EQ(code("/mixrig/lamp/fill/on", {}), ErrorCode::kNotFound);
  EXPECT_EQ(code("/mixrig/lamp/key/position_m", {1.0}), ErrorCode::kNotFound);
  EXPECT_EQ(code("/mixrig/lamp/key", {}), ErrorCode::kNotFound);
  EXPECT_EQ(code("/mixrig/lamp/key/intensity", {}), ErrorCode::kUsage);
  EXPECT_EQ(code("/mixrig/lamp/key/intensity", {-1.0}), ErrorCode::kUsage);
  EXPECT_EQ(code("/mixrig/object/old_crate/at", {std::string("left")}), ErrorCode::kUsage);
  EXPECT_EQ(code("/mixrig/record", {1.0, std::string("../x")}), ErrorCode::kUsage);
  EXPECT_EQ(code("/mixrig/view", {std::string("colour")}), ErrorCode::kUsage);
}

/// A control surface: a socket that shares no code with the port.
class Surface {
 public:
  explicit Surface(std::uint16_t port) {
    socket_ = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    const timeval limit{60, 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
    sockaddr_in to{};
    to.sin_family = AF_INET, to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::connect(socket_, reinterpret_cast<sockaddr*>(&to), sizeof(to)), 0);
  }
  Surface(const Surface&) = delete;
  Surface& operator=(const Surface&) = delete;
  ~Surface() { ::close(socket_); }
  void send(const std::string& bytes) const {
    EXPECT_EQ(::send(socket_, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  }
  OscReceived next() const {
    std::array<std::uint8_t, 4096> bytes{};
    const ssize_t n = ::recv(socket_, bytes.data(), bytes.size(), 0);
    const auto read =
        stream::parse_osc({bytes.data(), static_cast<std::size_t>(std::max<ssize_t>(n, 0))});
    return read && !read->empty() ? (*read)[0] : OscReceived{};
  }
  /// Returns the next message to `address`; skips those to other addresses.
  OscReceived next_of(const std::string& address) const {
    for (;;) {
      OscReceived message = next();
      if (message.address == address || message.address.empty()) return message;
    }
  }

 private:
  int socket_ = -1;
};

class OscServer : public ::testing::Test {
 protected:
  OscServer() {
    State state;
    state.lamps.push_back({.name = "key"});
    run_.set(state);
  }
  void start(const std::string& address = "127.0.0.1") {
    auto server = Server::start(run_, orders_, clock_, {"127.0.0.1", 0}, Listen{address, 0});
    ASSERT_TRUE(server) << to_line(server.error());
    server_ = *std::move(server);
  }
  SystemClock clock_;
  FakeOperator run_;
  std::atomic<bool> stop_ = false;
  output::RunOrders orders_{stop_};
  std::unique_ptr<Server> server_;
};

TEST_F(OscServer, AButtonActsAndTheStateIsToldBack) {
  start();
  const Surface one(server_->osc_port()), two(server_->osc_port());
  two.send(stream::OscMessage("/mixrig/state").bytes());
  EXPECT_EQ(std::get<std::string>(two.next_of("/mixrig/view").arguments[0]), "composite");
  one.send(stream::OscMessage("/mixrig/lamp/key/on").add(0).bytes());
  EXPECT_EQ(std::get<double>(one.next_of("/mixrig/lamp/key/on").arguments[0]), 0);
  one.send(stream::OscMessage("/mixrig/view").add(std::string_view("matte")).bytes());
  EXPECT_EQ(std::get<std::string>(two.next_of("/mixrig/view").arguments[0]), "matte");
  EXPECT_EQ(orders_.state().view, View::kMatte);
  State recording = run_.state();
  recording.recording.on = true, recording.recording.name = "shot 1";
  run_.set(recording);
  EXPECT_EQ(std::get<std::string>(two.next_of("/mixrig/take").arguments[0]), "shot 1");
  EXPECT_EQ(std::get<std::string>(two.next_of("/mixrig/tally").arguments[0]), "record");
  two.send(stream::OscMessage("/mixrig/state").bytes());
  EXPECT_EQ(std::get<double>(two.next_of("/mixrig/freeze").arguments.at(0)), 0) << "told anew";
  ASSERT_TRUE(orders_.give(output::FreezePictures{true}));  // by a key of the viewfinder
  EXPECT_EQ(std::get<double>(two.next_of("/mixrig/freeze").arguments.at(0)), 1);
}

TEST_F(OscServer, FaultsAreToldToWhoAskedAndDamagedOnesDropped) {
  start();
  const Surface one(server_->osc_port());
  one.send("no message");
  one.send(stream::OscMessage("/mixrig/learn").bytes());
  const OscReceived fault = one.next_of("/mixrig/error");
  EXPECT_NE(std::get<std::string>(fault.arguments[0]).find("no background"), std::string::npos);
  one.send(stream::OscMessage("/mixrig/nothing").bytes());
  EXPECT_NE(std::get<std::string>(one.next_of("/mixrig/error").arguments[0]).find("nothing under"),
            std::string::npos);
}

TEST_F(OscServer, BeyondTheLoopbackATokenIsNeeded) {
  start("0.0.0.0");
  const std::string text = server_->osc_text();
  const std::size_t from = text.find("begin with /");
  ASSERT_NE(from, std::string::npos) << text;
  const std::string prefix = text.substr(from + 11, 33);
  const Surface one(server_->osc_port());
  one.send(stream::OscMessage("/mixrig/lamp/key/on").add(0).bytes());
  one.send(stream::OscMessage("/" + std::string(32, '0') + "/mixrig/lamp/key/on").add(0).bytes());
  one.send(stream::OscMessage(prefix + "/mixrig/lamp/key/on").add(0).bytes());
  EXPECT_EQ(std::get<double>(one.next_of("/mixrig/lamp/key/on").arguments[0]), 0);
  EXPECT_EQ(run_.commands().size(), 1U) << "the others were dropped";
}

TEST(OscListen, IsParsed) {
  EXPECT_EQ(parse_osc_listen("").value().port, kDefaultOscPort);
  EXPECT_EQ(parse_osc_listen("9000").value().port, 9000);
  EXPECT_EQ(parse_osc_listen("9000").value().address, "127.0.0.1");
  EXPECT_EQ(parse_osc_listen("0.0.0.0:0").value().address, "0.0.0.0");
  for (const char* bad : {"70000", "x", "1.2.3.4:x"}) EXPECT_FALSE(parse_osc_listen(bad)) << bad;
}

}  // namespace
}  // namespace mixrig::page
