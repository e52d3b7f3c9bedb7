// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/token_file.h"

#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "host/operator/page/server.h"
#include "tests/support/progress.h"
#include "tests/support/refusal.h"
#include "tests/support/temporary_folder.h"
#include "tests/unit/page/fake_operator.h"
#include "tests/unit/page/raw_client.h"

namespace mixrig::page {
namespace {

std::string first_line_of(const std::filesystem::path& path) {
  std::ifstream in(path);
  std::string text;
  std::getline(in, text);
  return text;
}

TEST(PageToken, ATokenWithAFileIsNeededHereAndRenewedWhenTheFileIsRemoved) {
  const test::TemporaryFolder folder;
  const auto path = folder.path() / "token";
  SystemClock clock;
  FakeOperator run;
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  Listen listen{"127.0.0.1", 0};
  listen.token_file = path;
  const auto server = Server::start(run, orders, clock, listen);
  ASSERT_TRUE(server) << server.error().context;
  EXPECT_EQ((*server)->url().find("token"), std::string::npos) << "logs keep the address";
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms{0600});
  const std::string old = first_line_of(path);
  EXPECT_EQ(old.size(), 32U);
  const auto request = [&](const std::string& token) {
    return "GET /api/v1/state HTTP/1.1\r\nHost: 127.0.0.1\r\nAuthorization: Bearer " + token +
           "\r\n\r\n";
  };
  const auto status = [&](const std::string& token) {
    RawClient client((*server)->port());
    client.send(request(token));
    return client.response().status;
  };
  EXPECT_EQ(status(std::string(32, '0')), 401);
  RawClient open((*server)->port());
  open.send(request(old));
  EXPECT_EQ(open.response().status, 200);
  std::filesystem::remove(path);
  EXPECT_EQ(open.read_all(), "") << "a renewed token ends what is connected";
  EXPECT_EQ(status(old), 401);
  EXPECT_EQ(status(first_line_of(path)), 200);
  std::ofstream(folder.path() / "own") << "a-token_of_MY_own";
  std::filesystem::permissions(folder.path() / "own", std::filesystem::perms{0600});
  std::filesystem::rename(folder.path() / "own", path);
  EXPECT_TRUE(test::comes_true([&] { return status("a-token_of_MY_own") == 200; }));
}

TEST(PageToken, AChangeIsToldOnce) {
  const test::TemporaryFolder folder;
  TokenFile file(folder / "token");
  ASSERT_TRUE(file.read());
  EXPECT_FALSE(file.changed());
  folder.write("token", "short\n");
  const auto changed = file.changed();
  ASSERT_TRUE(changed);
  EXPECT_TRUE(test::refused(*changed, {"16 to 128", "a new one is made"}));
  EXPECT_FALSE(file.changed()) << "a warning comes once";
}

TEST(PageToken, ATokenThatOthersMayReadOrIsNoneIsOneLine) {
  const test::TemporaryFolder folder;
  const std::string path = folder.path() / "token";
  const auto refused = [&](const char* text, unsigned mode, const char* says) {
    std::ofstream(path) << text;
    std::filesystem::permissions(path, std::filesystem::perms{mode});
    return test::refused(TokenFile(path).read(), {path, says}, ErrorCode::kUsage);
  };
  EXPECT_TRUE(refused("0123456789abcdef", 0640, "chmod 600"));
  EXPECT_TRUE(refused("0123456789abcde", 0600, "16 to 128"));
  EXPECT_TRUE(refused("0123456789abcdef;x", 0600, "16 to 128"));
  EXPECT_TRUE(refused(std::string(129, 'a').c_str(), 0600, "16 to 128"));
  EXPECT_TRUE(
      test::refused(TokenFile(folder.path() / "none" / "token").read(), {"cannot be written"}));
  std::filesystem::remove(path);
  ASSERT_EQ(::mkfifo(path.c_str(), 0600), 0);
  EXPECT_TRUE(test::refused(TokenFile(path).read(), {"is no file"}));
}

}  // namespace
}  // namespace mixrig::page
