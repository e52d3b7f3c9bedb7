// SPDX-License-Identifier: Apache-2.0
#include "hal/linux/service_notify.h"

#include <array>
#include <cstdlib>
#include <string>

#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

namespace mixrig::device {
namespace {

class ServiceNotify : public ::testing::Test {
 protected:
  ~ServiceNotify() override {
    ::unsetenv("NOTIFY_SOCKET");
    if (manager_ >= 0) ::close(manager_);
    ::unlink(path_.c_str());
  }
  void listen() {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    path_.copy(address.sun_path, sizeof address.sun_path - 1);
    manager_ = ::socket(AF_UNIX, SOCK_DGRAM, 0);
    ASSERT_EQ(::bind(manager_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  std::string path_ = "/tmp/mixrig_notify_" + std::to_string(::getpid());
  int manager_ = -1;
};

TEST_F(ServiceNotify, SendsTheStateToTheServiceManager) {
  listen();
  ::setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  EXPECT_TRUE(notify_service("WATCHDOG=1"));
  std::array<char, 64> heard{};
  EXPECT_EQ(::recv(manager_, heard.data(), heard.size(), MSG_DONTWAIT), 10);
  EXPECT_STREQ(heard.data(), "WATCHDOG=1");
}

TEST_F(ServiceNotify, DoesNothingWithoutAServiceManager) {
  EXPECT_FALSE(notify_service("READY=1"));
  ::setenv("NOTIFY_SOCKET", path_.c_str(), 1);
  EXPECT_FALSE(notify_service("READY=1"));
  ::setenv("NOTIFY_SOCKET", std::string(300, '/').c_str(), 1);
  EXPECT_FALSE(notify_service("READY=1"));
}

}  // namespace
}  // namespace mixrig::device
