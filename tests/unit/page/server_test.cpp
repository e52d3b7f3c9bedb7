// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/server.h"

#include <deque>
#include <regex>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "host/operator/page/hub.h"
#include "tests/support/progress.h"
#include "tests/support/refusal.h"
#include "tests/support/threaded_clock.h"
#include "tests/support/throw_in.h"
#include "tests/unit/page/page_server.h"

namespace mixrig::page {
namespace {

using nlohmann::json;
using test::comes_true;

TEST_F(PageServer, ServesPageAndState) {
  const auto page = ask(get("/"));
  EXPECT_EQ(page.status, 200);
  EXPECT_NE(page.body.find("<title>mixrig"), std::string::npos);
  EXPECT_NE(page.field("Content-Security-Policy").find("default-src 'none'"), std::string::npos);
  const auto state = ask(get("/api/v1/state"));
  EXPECT_EQ(json::parse(state.body)["run"]["scene"], "scene.toml");
  EXPECT_EQ(state.field("Cross-Origin-Resource-Policy"), "same-origin");
  EXPECT_EQ(json::parse(ask(get("/api/v1/lamps")).body)[0]["name"], "lamp 1");
  EXPECT_EQ(ask(get("/api/v1/nothing")).status, 404);
}

TEST_F(PageServer, OneConnectionServesSeveralRequests) {
  RawClient client(server_->port());
  for (int i = 0; i < 3; ++i) {
    client.send(with_body("PUT /api/v1/objects/crate", R"({"at":[0.5,0.5]})"));
    EXPECT_EQ(client.response().status, 200);
  }
  ASSERT_EQ(run_.commands().size(), 3U);
  EXPECT_EQ(std::get<SetObject>(run_.commands()[2]).name, "crate");
}

TEST_F(PageServer, WhatTheRunCannotDoIs409WithOneLine) {
  const auto answer = ask(with_body("POST /api/v1/background/learn", "{}"));
  EXPECT_EQ(answer.status, 409);
  EXPECT_EQ(json::parse(answer.body)["error"], "this run has no background");
}

TEST_F(PageServer, HostileRequestsChangeNothing) {
  const std::string body = R"({"on":false})";
  const std::string put = "PUT /api/v1/lamps/lamp%201";
  EXPECT_EQ(ask(with_body(put, body, "application/json", "Origin: http://evil.example\r\n")).status,
            403);
  EXPECT_EQ(ask(with_body(put, body, "text/plain")).status, 415);
  EXPECT_EQ(ask(with_body(put, body, "application/json", "Sec-Fetch-Site: cross-site\r\n")).status,
            403);
  EXPECT_EQ(ask("GET /api/v1/state HTTP/1.1\r\nHost: evil.example\r\n\r\n").status, 403);
  EXPECT_EQ(ask("GET /api/v1/state HTTP/1.1\r\n\r\n").status, 400);
  EXPECT_EQ(ask(get("/api/v1/state", "Host: evil.example\r\n")).status, 400) << "two Hosts";
  EXPECT_EQ(ask(get("/api/v1/event/websocket")).status, 426);
  EXPECT_EQ(ask(upgrade("Origin: http://evil.example\r\n")).status, 403);
  EXPECT_TRUE(run_.commands().empty());
}

TEST_F(PageServer, OversizedRequestsAreRefusedAndTheServerLives) {
  EXPECT_EQ(ask(get("/", "X: " + std::string(9000, 'x') + "\r\n")).status, 431);
  EXPECT_EQ(ask(with_body("PUT /api/v1/objects/a", std::string(70000, ' '))).status, 413);
  const std::string huge =
      "POST /api/v1/objects/a HTTP/1.1\r\nHost: " + host() +
      "\r\nContent-Type: model/gltf-binary\r\nContent-Length: 99999999999\r\n\r\n";
  EXPECT_EQ(ask(huge).status, 413);
  EXPECT_EQ(ask(get("/" + std::string(600, 'a'))).status, 404);
  EXPECT_EQ(ask(get("/api/v1/state")).status, 200);
  EXPECT_TRUE(run_.commands().empty());
}

TEST_F(PageServer, MalformedRequestsAreRefusedAndTheServerLives) {
  for (const std::string& bytes :
       {std::string("\r\n\r\n\r\n"), std::string("GET\r\n\r\n"), std::string("\0\1\2\3\r\n\r\n", 8),
        std::string("GET / HTTP/9.9\r\n\r\n"), std::string("GET / HTTP/1.1\r\nHost\r\n\r\n"),
        std::string("\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n", 15)}) {
    const auto answer = ask(bytes);
    EXPECT_EQ(answer.status, 400) << bytes;
  }
  for (const char* body : {"{", "[]", "{\"at\":[1]}", "{\"x\":1}"})
    EXPECT_EQ(ask(with_body("PUT /api/v1/objects/a", body)).status, 400) << body;
  EXPECT_EQ(ask(get("/api/v1/state", "Content-Length: 5\r\n") + "12345").status, 400);
  {  // gone in the middle of a request
    RawClient client(server_->port());
    client.send("PUT /api/v1/objects/a HTTP/1.1\r\nHost: " + host() +
                "\r\nContent-Type: application/json\r\nContent-Length: 100\r\n\r\n{\"at\":");
  }
  EXPECT_EQ(ask(get("/api/v1/state")).status, 200);
  EXPECT_TRUE(run_.commands().empty());
}

TEST_F(PageServer, AModelIsGivenToTheRunAsAFile) {
  const std::string bytes(300000, 'g');
  EXPECT_EQ(ask(with_body("POST /api/v1/objects/new", bytes, "model/gltf-binary")).status, 200);
  ASSERT_EQ(run_.commands().size(), 1U);
  const auto add = std::get<AddObject>(run_.commands()[0]);
  EXPECT_EQ(add.name, "new");
  EXPECT_EQ(run_.upload_bytes(), bytes.size());
  EXPECT_FALSE(std::filesystem::exists(add.glb)) << "the temporary file";
}

TEST_F(PageServer, EachPartOfTheStreamTellsItsFrameAndAge) {
  RawClient client(server_->port());
  client.send(get("/api/v1/picture/composite.mjpeg"));
  EXPECT_NE(client.read_to("\r\n\r\n").find("multipart/x-mixed-replace; boundary=frame"),
            std::string::npos);
  for (int number = 10; number < 13; ++number) {
    frame(number);
    const std::string head = client.read_to("\r\n\r\n");
    EXPECT_NE(head.find("X-Frame: " + std::to_string(number)), std::string::npos) << head;
    std::smatch found;
    ASSERT_TRUE(std::regex_search(head, found, std::regex("X-Age-Ms: ([0-9.]+)")));
    EXPECT_GE(std::stod(found[1]), 0);
    ASSERT_TRUE(std::regex_search(head, found, std::regex("Content-Length: ([0-9]+)")));
    const std::string jpeg = client.read_bytes(std::stoul(found[1]));
    EXPECT_EQ(jpeg.substr(0, 2), "\xFF\xD8");
    client.read_bytes(2);
  }
  client.close();
  EXPECT_TRUE(comes_true([&] { return sink_->wanted(1) == 0; })) << "nobody looks any more";
}

TEST_F(PageServer, ASinglePictureIsANewOne) {
  RawClient client(server_->port());
  client.send(get("/api/v1/picture/composite.jpg"));
  ASSERT_TRUE(comes_true([&] { return sink_->wanted(1) != 0; }));
  frame(7);
  const auto picture = client.response();
  EXPECT_EQ(picture.status, 200);
  EXPECT_EQ(picture.field("X-Frame"), "7");
  EXPECT_EQ(picture.field("Content-Type"), "image/jpeg");
}

TEST_F(PageServer, ASlowClientMissesPicturesAndDelaysNobody) {
  RawClient slow(server_->port(), 4096);
  RawClient quick(server_->port());
  for (RawClient* client : {&slow, &quick}) {
    client->send(get("/api/v1/picture/composite.mjpeg"));
    client->read_to("\r\n\r\n");
  }
  constexpr int kFrames = 40;
  for (int number = 1; number <= kFrames; ++number) {  // 300 KB each: more than sockets hold
    frame(number, {512, 384});
    const std::string head = quick.read_to("\r\n\r\n");
    EXPECT_NE(head.find("X-Frame: " + std::to_string(number)), std::string::npos);
    std::smatch found;
    ASSERT_TRUE(std::regex_search(head, found, std::regex("Content-Length: ([0-9]+)")));
    quick.read_bytes(std::stoul(found[1]) + 2);
  }
  int seen = 0, last = 0;
  while (last < kFrames) {
    const std::string head = slow.read_to("\r\n\r\n");
    std::smatch found;
    ASSERT_TRUE(std::regex_search(head, found, std::regex("X-Frame: ([0-9]+)")));
    EXPECT_GT(std::stoi(found[1]), last);
    last = std::stoi(found[1]), ++seen;
    ASSERT_TRUE(std::regex_search(head, found, std::regex("Content-Length: ([0-9]+)")));
    slow.read_bytes(std::stoul(found[1]) + 2);
  }
  EXPECT_LT(seen, kFrames / 2);
}

TEST_F(PageServer, BothOfTwoClientsAreToldWhatOneChanges) {
  RawClient a(server_->port()), b(server_->port());
  for (RawClient* client : {&a, &b}) {
    client->send(upgrade("Origin: http://" + host() + "\r\n"));
    EXPECT_NE(client->read_to("\r\n\r\n").find("101"), std::string::npos);
    EXPECT_NE(client->message().find("websocketOpened"), std::string::npos);
    client->send_message(
        R"({"type":"request","data":{"action":"subscribe","properties":["/lamps","/view"]}})");
    const json answer = json::parse(client->message());
    EXPECT_TRUE(answer["data"]["values"]["/lamps"][0]["on"].get<bool>());
  }
  EXPECT_EQ(ask(with_body("PUT /api/v1/lamps/lamp%201", R"({"on":false})")).status, 200);
  EXPECT_EQ(ask(with_body("PUT /api/v1/view", R"({"view":"matte"})")).status, 200);
  for (RawClient* client : {&a, &b}) {
    const json lamps = json::parse(client->message());
    EXPECT_EQ(lamps["data"]["property"], "/lamps");
    EXPECT_FALSE(lamps["data"]["value"][0]["on"].get<bool>());
    const json view = json::parse(client->message());
    EXPECT_EQ(view["data"]["value"], "matte");
  }
}

TEST_F(PageServer, APictureOfATakeHoldsUpNoChange) {
  RawClient player(server_->port());
  player.send(get("/api/v1/takes/slow/1.jpg"));
  run_.wait_for_slow_picture();
  EXPECT_EQ(ask(with_body("PUT /api/v1/lamps/lamp%201", R"({"on":false})")).status, 200);
  run_.release();
  EXPECT_EQ(player.response().status, 200);
}

TEST(PageHub, PicturesOfTakesThatWaitAreCounted) {
  FakeOperator run;
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  const SystemClock clock;
  Hub hub(run, orders, clock);
  int given = 0;
  std::string refused;
  for (int i = 0; i < 9; ++i)
    hub.get_take_picture({"slow", 1}, [&](const Result<std::string>& jpeg) {
      jpeg ? ++given : (refused += jpeg.error().context, 0);
    });
  EXPECT_EQ(given, 0);
  EXPECT_EQ(refused, "8 pictures of takes are waiting: ask more slowly");
  run.release();
  while (given < 8) hub.io.run_one(), hub.io.restart();
  hub.get_take_picture({"take 1", 1},
                       [&](const Result<std::string>& jpeg) { given += jpeg ? 1 : 0; });
  while (given < 9) hub.io.run_one(), hub.io.restart();
}

TEST_F(PageServer, ALargeMessageEndsItsSocketAlone) {
  RawClient a(server_->port()), b(server_->port());
  for (RawClient* client : {&a, &b}) {
    client->send(upgrade());
    client->read_to("\r\n\r\n");
    EXPECT_FALSE(client->message().empty());
  }
  a.send_message(std::string(5000, 'x'));
  EXPECT_EQ(a.message(), "");
  b.send_message("no json");
  EXPECT_FALSE(json::parse(b.message())["data"]["success"].get<bool>());
}

constexpr std::uint32_t kOtherHost = INADDR_LOOPBACK + 1;

TEST_F(PageServer, TheSeventeenthConnectionTakesThePlaceOfTheOneThatIsIdleLongest) {
  std::deque<RawClient> clients;
  for (int i = 0; i < 17; ++i) {
    clients.emplace_back(server_->port());
    clients.back().send(get("/api/v1/view"));
    EXPECT_EQ(clients.back().response().status, 200) << i;
  }
  clients.front().send(get("/api/v1/view"));
  EXPECT_EQ(clients.front().response().status, 0) << "it was closed";
  clients[1].send(get("/api/v1/view"));
  EXPECT_EQ(clients[1].response().status, 200);
}

TEST_F(PageServer, StreamsKeepTheirPlacesAndAnotherAddressHasItsOwn) {
  std::deque<RawClient> streams;
  for (int i = 0; i < 16; ++i) {
    streams.emplace_back(server_->port(), 0, kOtherHost);
    streams.back().send(get("/api/v1/picture/composite.mjpeg"));
    ASSERT_NE(streams.back().read_to("\r\n\r\n"), "");
  }
  RawClient more(server_->port(), 0, kOtherHost);
  more.send(get("/api/v1/view"));
  EXPECT_EQ(more.response().status, 503);
  EXPECT_EQ(ask(get("/api/v1/view")).status, 200);
  streams.pop_back();
  EXPECT_TRUE(comes_true([&] {
    RawClient next(server_->port(), 0, kOtherHost);
    next.send(get("/api/v1/view"));
    return next.response().status == 200;
  }));
}

/// A host that holds 500 connections: silent, with half a header, with a request.
TEST_F(PageServer, AHostThatHoldsFiveHundredConnectionsLocksNobodyOut) {
  const std::string half = "GET / HTTP/1.1\r\nHost: ";
  for (const std::string& sent : {std::string(), half, get("/api/v1/view")})
    for (const std::uint32_t host : {kOtherHost, std::uint32_t{INADDR_LOOPBACK}}) {
      std::deque<RawClient> clients;
      for (int i = 0; i < 500; ++i) clients.emplace_back(server_->port(), 0, host).send(sent);
      EXPECT_EQ(ask(get("/api/v1/view")).status, 200) << sent;
    }
}

TEST_F(PageServer, AHostOfManyConnectionsEndsNoneOfAnotherAddress) {
  RawClient page(server_->port());
  page.send(get("/api/v1/view"));
  EXPECT_EQ(page.response().status, 200);
  std::deque<RawClient> clients;
  for (int i = 0; i < 500; ++i)
    clients.emplace_back(server_->port(), 0, kOtherHost).send(get("/api/v1/view"));
  EXPECT_EQ(clients.back().response().status, 200) << "the server has taken all of them";
  page.send(get("/api/v1/view"));
  EXPECT_EQ(page.response().status, 200);
}

TEST_F(PageServer, WhatAHandlerThrowsEndsNotTheServer) {
  const test::ThrowIn thrown("a connection");
  auto server = Server::start(run_, orders_, clock_, {"127.0.0.1", 0});
  ASSERT_TRUE(server);
  EXPECT_TRUE(comes_true([] { return test::logged("a connection: no memory is left"); }));
  server_ = *std::move(server);
  EXPECT_EQ(ask(get("/api/v1/view")).status, 200);
}

TEST_F(PageServer, AFrozenPictureStays) {
  RawClient client(server_->port());
  client.send(get("/api/v1/picture/composite.mjpeg"));
  client.read_to("\r\n\r\n");
  frame(1);
  EXPECT_EQ(ask(with_body("PUT /api/v1/freeze", R"({"on":true})")).status, 200);
  EXPECT_EQ(sink_->wanted(2), 0U);
  EXPECT_EQ(ask(get("/api/v1/picture/composite.jpg")).field("X-Frame"), "1");
  EXPECT_EQ(ask(with_body("PUT /api/v1/freeze", R"({"on":false})")).status, 200);
  EXPECT_NE(sink_->wanted(2), 0U);
}

TEST_F(PageServer, EndsWhileClientsAreConnected) {
  RawClient stream(server_->port()), events(server_->port()), idle(server_->port());
  stream.send(get("/api/v1/picture/composite.mjpeg"));
  stream.read_to("\r\n\r\n");
  events.send(upgrade());
  events.read_to("\r\n\r\n");
  server_.reset();
  stream.read_all();
  frame(1);  // the sink may outlive it
}

TEST(PageServerAddress, ATokenIsNeededBeyondTheLoopback) {
  SystemClock clock;
  FakeOperator run;
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  const auto server = Server::start(run, orders, clock, {"0.0.0.0", 0});
  ASSERT_TRUE(server);
  const std::string url = (*server)->url();
  const std::size_t at = url.find("/?token=");
  ASSERT_NE(at, std::string::npos) << url;
  const std::string token = url.substr(at + 8);
  const auto ask = [&](const std::string& target, const std::string& more) {
    RawClient client((*server)->port());
    client.send("GET " + target + " HTTP/1.1\r\nHost: rig.local:1\r\n" + more + "\r\n");
    return client.response();
  };
  EXPECT_EQ(ask("/", "").status, 401);
  EXPECT_EQ(ask("/api/v1/state", "Authorization: Bearer " + std::string(32, '0') + "\r\n").status,
            401);
  EXPECT_EQ(ask("/api/v1/state", "Authorization: Bearer " + token + "\r\n").status, 200);
  const auto first = ask("/?token=" + token, "");
  EXPECT_EQ(first.status, 303);
  const std::string cookie = first.field("Set-Cookie");
  EXPECT_EQ(ask("/", "Cookie: " + cookie.substr(0, cookie.find(';')) + "\r\n").status, 200);
  EXPECT_EQ(ask("/?token=" + std::string(32, '0'), "").status, 401);
}

TEST(PageServerAddress, AProxyIsNamedByItsHost) {
  for (const char* good : {"rig.example", "rig", "rig-2.example:8443", "10.0.0.2"})
    EXPECT_TRUE(check_proxied(good)) << good;
  for (const char* bad : {"https://rig.example", "rig.example/", "rig:", ":80", "a b", "rig:x"})
    EXPECT_TRUE(test::refused(check_proxied(bad), {"--page-proxy", "HOST:PORT"})) << bad;
}

/// Time is the server's clock: whoever sends a header byte by byte is cut off, too.
TEST(PageServerTime, AConnectionWithoutAWholeHeaderEndsAfterFiveSeconds) {
  test::ThreadedClock clock;
  FakeOperator run;
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  const auto server = Server::start(run, orders, clock, {"127.0.0.1", 0});
  ASSERT_TRUE(server);
  RawClient slow((*server)->port()), page((*server)->port());
  const std::string head = "GET /api/v1/view HTTP/1.1\r\nHost: 127.0.0.1\r\n";
  page.send(head + "\r\n");
  ASSERT_EQ(page.response().status, 200) << "the one before was accepted, too";
  slow.send(head);
  clock.advance(std::chrono::milliseconds(4900));
  slow.send("X-Slow: 1\r\n");
  clock.advance(std::chrono::milliseconds(101));
  EXPECT_EQ(slow.read_all(), "");
  page.send(head + "\r\n");
  EXPECT_EQ(page.response().status, 200) << "a permitted one stays";
}

TEST(PageServerAddress, ATakenPortIsOneLine) {
  SystemClock clock;
  FakeOperator run;
  std::atomic<bool> stop = false;
  output::RunOrders orders(stop);
  const auto first = Server::start(run, orders, clock, {"127.0.0.1", 0});
  ASSERT_TRUE(first);
  EXPECT_EQ((*first)->url(), "http://127.0.0.1:" + std::to_string((*first)->port()) + "/");
  const auto second = Server::start(run, orders, clock, {"127.0.0.1", (*first)->port()});
  ASSERT_FALSE(second);
  EXPECT_NE(to_line(second.error()).find("choose another one by --page"), std::string::npos);
}

TEST(PageServerAddress, IsParsed) {
  EXPECT_EQ(parse_listen("").value().port, kDefaultPort);
  EXPECT_EQ(parse_listen("0.0.0.0:0").value().port, 0);
  EXPECT_EQ(parse_listen("localhost:80").value().address, "127.0.0.1");
  EXPECT_EQ(parse_listen("[::1]:8080").value().address, "::1");
  EXPECT_EQ(parse_listen("192.168.1.2").value().port, kDefaultPort);
  for (const char* bad :
       {"x", "1.2.3.4:", "1.2.3.4:x", "1.2.3.4:65536", "1.2.3.4:-1", ":80", "::1:80:"})
    EXPECT_FALSE(parse_listen(bad)) << bad;
}

}  // namespace
}  // namespace mixrig::page
