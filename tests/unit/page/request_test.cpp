// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/request.h"

#include <set>

#include <gtest/gtest.h>

namespace mixrig::page {
namespace {

const std::string kToken = "0123456789abcdef0123456789abcdef";

Request get(const std::string& host) {
  Request request;
  request.target = "/api/v1/state";
  request.host = host;
  return request;
}

int status_of(const Guard& guard, const Request& request) {
  const auto refused = refuse(guard, request);
  return refused ? refused->status : 200;
}

TEST(PageGuard, OnTheLoopbackAddressOnlyItsOwnNamesAreServed) {
  for (const char* host : {"localhost", "127.0.0.1:8437", "[::1]:8437", "localhost:1"})
    EXPECT_EQ(status_of({}, get(host)), 200) << host;
  for (const char* host : {"evil.example", "127.0.0.1.evil.example", "localhost.evil.example:8437",
                           "[::1].evil.example", "10.0.0.1", "evil@localhost", "[::2]"})
    EXPECT_EQ(status_of({}, get(host)), 403) << host;
  EXPECT_EQ(status_of({}, get("")), 400);
}

TEST(PageGuard, OtherSitesAreRefused) {
  Request request = get("127.0.0.1:8437");
  for (const char* origin : {"http://evil.example", "null", "http://127.0.0.1:8438",
                             "https://127.0.0.1:8437", "http://127.0.0.1:8437.evil.example"}) {
    request.origin = origin;
    EXPECT_EQ(status_of({}, request), 403) << origin;
  }
  request.origin = "http://127.0.0.1:8437";
  EXPECT_EQ(status_of({}, request), 200);
  for (const char* site : {"cross-site", "same-site"}) {
    request.fetch_site = site;
    EXPECT_EQ(status_of({}, request), 403) << site;
  }
  request.target = "/";  // a link may lead here
  request.origin.clear();
  EXPECT_EQ(status_of({}, request), 200);
}

TEST(PageGuard, AChangeNeedsATypeThatNoFormCanSend) {
  Request request = get("localhost");
  request.method = Method::kPost;
  for (const char* type :
       {"", "text/plain", "application/x-www-form-urlencoded",
        "multipart/form-data; boundary=application/json", "text/plain; application/json"}) {
    request.content_type = type;
    EXPECT_EQ(status_of({}, request), 415) << type;
  }
  for (const char* type :
       {"application/json", "application/json; charset=utf-8", "model/gltf-binary"}) {
    request.content_type = type;
    EXPECT_EQ(status_of({}, request), 200) << type;
  }
  request.method = Method::kOther;
  EXPECT_EQ(status_of({}, request), 200);
}

TEST(PageGuard, ATokenIsAskedForWhereThereIsOne) {
  const Guard guard{kToken};
  Request request = get("rig.local:8437");
  EXPECT_EQ(status_of(guard, request), 401);
  request.authorization = "Bearer " + kToken;
  EXPECT_EQ(status_of(guard, request), 200);
  for (const std::string& wrong :
       {std::string("Bearer "), "Bearer " + kToken + "0", "Bearer " + kToken.substr(1),
        "Basic " + kToken, std::string("Bearer 1123456789abcdef0123456789abcdef")}) {
    request.authorization = wrong;
    EXPECT_EQ(status_of(guard, request), 401) << wrong;
  }
  request.authorization.clear();
  request.cookie = "a=b; mixrig_token=" + kToken + "; c=d";
  EXPECT_EQ(status_of(guard, request), 200);
  request.cookie = "xmixrig_token=" + kToken;
  EXPECT_EQ(status_of(guard, request), 401);
  // The cookie alone does not let another site in.
  request.cookie = "mixrig_token=" + kToken;
  request.origin = "http://evil.example";
  EXPECT_EQ(status_of(guard, request), 403);
}

TEST(PageGuard, TheFirstVisitGetsACookieThatOtherSitesCannotUse) {
  const Guard guard{kToken};
  Request request = get("rig.local:8437");
  EXPECT_FALSE(first_visit(guard, request));
  request.target = "/?token=" + kToken;
  const auto visit = first_visit(guard, request);
  ASSERT_TRUE(visit);
  EXPECT_EQ(visit->status, 303);
  EXPECT_EQ(visit->headers[0], std::pair(std::string("Location"), std::string("/")));
  EXPECT_EQ(visit->headers[1].second,
            "mixrig_token=" + kToken + "; Path=/; HttpOnly; SameSite=Lax");
  request.target = "/?token=" + kToken.substr(1) + "0";
  EXPECT_EQ(first_visit(guard, request)->status, 401);
  EXPECT_FALSE(first_visit({}, request));
}

TEST(PageGuard, HttpsIsTheOriginOfTheProxyOfThisMachineAlone) {
  const Guard guard{kToken, "rig.example"};
  Request request = get("rig.example");
  request.from_here = true;
  EXPECT_EQ(status_of(guard, request), 401) << "this machine needs the token, too";
  request.cookie = "mixrig_token=" + kToken;
  request.origin = "https://rig.example";
  EXPECT_EQ(status_of(guard, request), 200);
  for (const char* origin : {"http://rig.example", "https://evil.example", "https://rig.example:1"})
    EXPECT_EQ((request.origin = origin, status_of(guard, request)), 403) << origin;
  request.origin = "https://rig.example";
  request.from_here = false;
  EXPECT_EQ(status_of(guard, request), 403) << "another machine names the proxy's host";
  request.target = "/?token=" + kToken;
  EXPECT_EQ(first_visit(guard, request)->headers[1].second.find("Secure"), std::string::npos);
  request.from_here = true;
  EXPECT_NE(first_visit(guard, request)->headers[1].second.find("; Secure"), std::string::npos);
}

TEST(PageGuard, TokensHave128BitsAndDiffer) {
  std::set<std::string> tokens;
  for (int i = 0; i < 100; ++i) tokens.insert(random_token());
  EXPECT_EQ(tokens.size(), 100U);
  for (const std::string& token : tokens) {
    EXPECT_EQ(token.size(), 32U);
    EXPECT_EQ(token.find_first_not_of("0123456789abcdef"), std::string::npos);
  }
}

TEST(PagePath, IsCutAtSlashesAndThenDecoded) {
  using Parts = std::vector<std::string>;
  EXPECT_EQ(path_of("/"), Parts{});
  EXPECT_EQ(path_of("/api/v1/objects/a%2Fb%20c?x=%zz"), (Parts{"api", "v1", "objects", "a/b c"}));
  EXPECT_EQ(path_of("/a/?b/c"), Parts{"a"});
  for (const char* bad :
       {"", "a", "http://localhost/", "*", "/a//b", "//a", "/%", "/%4", "/%zz", "/a%00b", "/%0"})
    EXPECT_FALSE(path_of(bad)) << bad;
  EXPECT_FALSE(path_of("/" + std::string(600, 'a')));
}

TEST(PageRefusal, BytesThatAreNoTextStayJson) {
  EXPECT_EQ(refusal(400, "a\"\xFF").body, "{\"error\":\"a\\\"\xEF\xBF\xBD\"}");
  EXPECT_EQ(refusal(Error{ErrorCode::kUnsupported, "no"}).status, 409);
  EXPECT_EQ(refusal(Error{ErrorCode::kNotFound, "no"}).status, 404);
}

}  // namespace
}  // namespace mixrig::page
