// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/events.h"

#include <gtest/gtest.h>

#include "host/operator/page/state_json.h"

namespace mixrig::page {
namespace {

using nlohmann::json;

json ask(Subscriptions& subscriptions, const json& data, const json& state) {
  const json message{{"type", "request"}, {"id", 7}, {"data", data}};
  return json::parse(subscriptions.answer(message.dump(), state, 12.5));
}

class Events : public ::testing::Test {
 protected:
  json state() const { return to_json(run_, page_); }
  State run_;
  PageState page_;
  Subscriptions subscriptions_;
};

TEST_F(Events, AChangeIsToldOnceToWhoSubscribed) {
  const json answer = ask(
      subscriptions_, {{"action", "subscribe"}, {"properties", {"/view", "/recording"}}}, state());
  EXPECT_EQ(answer["type"], "response");
  EXPECT_EQ(answer["id"], 7);
  EXPECT_TRUE(answer["data"]["success"]);
  EXPECT_EQ(answer["data"]["values"]["/view"], "composite");
  EXPECT_TRUE(subscriptions_.changed(state()).empty());
  page_.view = View::kKey;
  page_.frozen = true;  // nobody asked for it
  EXPECT_EQ(subscriptions_.changed(state()), std::vector<std::string>{"view"});
  EXPECT_TRUE(subscriptions_.changed(state()).empty());
  (void)ask(subscriptions_, {{"action", "unsubscribe"}, {"properties", {"/view"}}}, state());
  page_.view = View::kLight;
  EXPECT_TRUE(subscriptions_.changed(state()).empty());
  const json list = ask(subscriptions_, {{"action", "listSubscriptions"}}, state());
  EXPECT_EQ(list["data"]["properties"], json::array({"/recording"}));
}

TEST_F(Events, AllPropertiesAreListedAndMeantByAStar) {
  const json list = ask(subscriptions_, {{"action", "listProperties"}}, state());
  const json all = ask(subscriptions_, {{"action", "subscribe"}, {"properties", {"*"}}}, state());
  EXPECT_EQ(list["data"]["properties"], all["data"]["properties"]);
  EXPECT_EQ(list["data"]["properties"].size(), state().size());
  const json now = state();
  for (const auto& [part, value] : now.items()) EXPECT_TRUE(is_part(part)) << part;
}

TEST_F(Events, TheHostsClockIsTold) {
  EXPECT_EQ(ask(subscriptions_, {{"action", "time"}}, state())["data"]["host_ms"], 12.5);
}

TEST_F(Events, WrongMessagesAreAnsweredAndChangeNothing) {
  for (const char* message :
       {"", "x", "[]", "7", "{}", R"({"type":"request"})", R"({"type":"request","data":[]})",
        R"({"type":"event","data":{"action":"time"}})", R"({"type":"request","data":{"action":7}})",
        R"({"type":"request","data":{"action":"subscribe"}})",
        R"({"type":"request","data":{"action":"subscribe","properties":[]}})",
        R"({"type":"request","data":{"action":"subscribe","properties":["/nothing"]}})",
        R"({"type":"request","data":{"action":"subscribe","properties":["view"]}})",
        R"({"type":"request","data":{"action":"subscribe","properties":["/view",1]}})",
        "\xFF\xFE"}) {
    const json answer = json::parse(subscriptions_.answer(message, state(), 0));
    EXPECT_FALSE(answer["data"]["success"].get<bool>()) << message;
    EXPECT_FALSE(answer["data"]["error"].get<std::string>().empty()) << message;
  }
  EXPECT_FALSE(subscriptions_.has("view"));
}

TEST_F(Events, StateThatIsNoNumberOrTextStaysJson) {
  run_.fps = std::numeric_limits<double>::infinity();
  run_.delay_ms = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(state()["picture"]["fps"], 0);
  EXPECT_EQ(state()["picture"]["delay_ms"], 0);
}

}  // namespace
}  // namespace mixrig::page
