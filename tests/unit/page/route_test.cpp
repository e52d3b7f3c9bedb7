// SPDX-License-Identifier: Apache-2.0
#include "host/operator/page/route.h"

#include <numbers>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

namespace mixrig::page {
namespace {

int status_of(const Route& route) {
  const auto* answer = std::get_if<Answer>(&route);
  return answer != nullptr ? answer->status : 200;
}

TEST(PageRoute, FilesAndStateAndPictures) {
  EXPECT_EQ(std::get<GetFile>(route_of(Method::kGet, "/")).name, "index.html");
  EXPECT_EQ(std::get<GetFile>(route_of(Method::kGet, "/page.js")).name, "page.js");
  EXPECT_EQ(std::get<GetState>(route_of(Method::kGet, "/api/v1/state")).part, "");
  EXPECT_EQ(std::get<GetState>(route_of(Method::kGet, "/api/v1/streams")).part, "streams");
  EXPECT_EQ(std::get<GetState>(route_of(Method::kGet, "/api/v1/objects")).part, "objects");
  const auto stream = std::get<GetPicture>(route_of(Method::kGet, "/api/v1/picture/key.mjpeg"));
  EXPECT_TRUE(stream.stream);
  EXPECT_EQ(stream.view, View::kKey);
  EXPECT_FALSE(std::get<GetPicture>(route_of(Method::kGet, "/api/v1/picture/matte.jpg")).stream);
  EXPECT_TRUE(
      std::holds_alternative<OpenEvents>(route_of(Method::kGet, "/api/v1/event/websocket")));
}

TEST(PageRoute, APictureOfATakeHasANumber) {
  const auto picture =
      std::get<GetTakePicture>(route_of(Method::kGet, "/api/v1/takes/a%201/7.jpg"));
  EXPECT_EQ(picture.take, "a 1");
  EXPECT_EQ(picture.frame, 7);
  for (const char* file : {"0.jpg", "-1.jpg", "7.png", "7.jpgx", "99999999999.jpg", ".jpg", "x"})
    EXPECT_EQ(status_of(route_of(Method::kGet, std::string("/api/v1/takes/a/") + file)), 404)
        << file;
  EXPECT_EQ(status_of(route_of(Method::kPut, "/api/v1/takes/a/7.jpg")), 405);
  EXPECT_EQ(status_of(route_of(Method::kOther, "/api/v1/objects/a")), 405);
}

TEST(PageRoute, WhatIsNotThereIs404AndAWrongMethod405) {
  for (const char* target :
       {"/a/b", "/api", "/api/v1", "/api/v2/state", "/api/v1/nothing", "/api/v1/picture/x.jpg",
        "/api/v1/picture/key.png", "/api/v1/picture/key", "/api/v1/objects/a/b",
        "/api/v1/record/pause", "/api/v1/state/x", "/api/v1/objects/a%0Ab", "/../etc/passwd"})
    EXPECT_EQ(status_of(route_of(Method::kGet, target)), 404) << target;
  EXPECT_EQ(status_of(route_of(Method::kPost, "/")), 405);
  EXPECT_EQ(status_of(route_of(Method::kPut, "/api/v1/state")), 405);
  EXPECT_EQ(status_of(route_of(Method::kGet, "/api/v1/record/start")), 405);
  EXPECT_EQ(status_of(route_of(Method::kDelete, "/api/v1/objects")), 405);
  EXPECT_EQ(status_of(route_of(Method::kPost, "/api/v1/lamps/a")), 405);
  EXPECT_EQ(status_of(route_of(Method::kDelete, "/api/v1/picture/key.jpg")), 405);
}

Result<Action> action(Method method, const char* target, const char* body) {
  const Route route = route_of(method, target);
  const auto* change = std::get_if<Change>(&route);
  if (change == nullptr) return Error{ErrorCode::kNotFound, "no change"};
  return action_of(*change, body);
}
template <typename T>
T command(Method method, const char* target, const char* body) {
  return std::get<T>(std::get<Command>(action(method, target, body).value()));
}

TEST(PageAction, ObjectsArePlaced) {
  const auto set = command<SetObject>(
      Method::kPut, "/api/v1/objects/a%20crate",
      R"({"at": [0.25, 0.5], "turn_deg": 90, "scale": 2, "hidden": true, "preview": true})");
  EXPECT_EQ(set.name, "a crate");
  EXPECT_EQ(*set.at, Eigen::Vector2d(0.25, 0.5));
  EXPECT_NEAR(*set.turn_rad, std::numbers::pi / 2, 1e-12);
  EXPECT_EQ(set.scale, 2);
  EXPECT_EQ(set.hidden, true);
  EXPECT_TRUE(set.preview);
  EXPECT_FALSE(set.position_m);
  const auto onto =
      command<SetObject>(Method::kPut, "/api/v1/objects/a", R"({"onto": [0.25, 0.5]})").onto;
  EXPECT_EQ(onto, Eigen::Vector2d(0.25, 0.5));
  EXPECT_EQ(command<RemoveObject>(Method::kDelete, "/api/v1/objects/a", "").name, "a");
  EXPECT_EQ(std::get<Upload>(route_of(Method::kPost, "/api/v1/objects/new")).name, "new");
}

TEST(PageAction, LampsAreAddedAndDimmed) {
  const auto set = command<SetLamp>(Method::kPut, "/api/v1/lamps/lamp%201",
                                    R"({"intensity": [1, 2, 0.5], "on": false})");
  EXPECT_EQ(*set.intensity, Eigen::Vector3f(1, 2, 0.5F));
  EXPECT_EQ(set.on, false);
  const auto add =
      command<AddLamp>(Method::kPost, "/api/v1/lamps", R"({"at": [0, 1], "height_m": 3})");
  EXPECT_EQ(add.height_m, 3);
  EXPECT_FALSE(add.above_floor_m);
  EXPECT_EQ(
      command<AddLamp>(Method::kPost, "/api/v1/lamps", R"({"at": [0, 1], "above_floor_m": 2})")
          .above_floor_m,
      2);
  for (const char* bad : {"{}", R"({"height_m": 2})", R"({"at": [0, 1], "position_m": [0, 0, 0]})",
                          R"({"at": [0, 1], "height_m": 2, "above_floor_m": 2})",
                          R"({"position_m": [0, 0, 0], "height_m": 2})"})
    EXPECT_FALSE(action(Method::kPost, "/api/v1/lamps", bad)) << bad;
  EXPECT_EQ(command<RemoveLamp>(Method::kDelete, "/api/v1/lamps/x", "{}").name, "x");
}

TEST(PageAction, CamerasAreSetByTheKeysOfRigToml) {
  const auto set = command<SetCamera>(Method::kPut, "/api/v1/cameras/color",
                                      R"({"exposure_ms": 8, "zoom": 100, "preview": true})");
  EXPECT_EQ(set.name, "color");
  EXPECT_EQ(set.values,
            (std::vector<std::pair<std::string, double>>{{"exposure_ms", 8}, {"zoom", 100}}));
  EXPECT_TRUE(set.preview);
  for (const char* bad : {"{}", R"({"exposure_s": 1})", R"({"gain": "high"})"})
    EXPECT_FALSE(action(Method::kPut, "/api/v1/cameras/color", bad)) << bad;
  EXPECT_EQ(std::get<GetState>(route_of(Method::kGet, "/api/v1/cameras")).part, "cameras");
}

TEST(PageAction, RecordingViewFreezeSceneBackground) {
  const auto start = command<StartRecording>(Method::kPost, "/api/v1/record/start",
                                             R"({"name": "scene 1-2", "notes": "good"})");
  EXPECT_EQ(start.name, "scene 1-2");
  EXPECT_EQ(start.notes, "good");
  (void)command<StopRecording>(Method::kPost, "/api/v1/record/stop", "");
  (void)command<SaveScene>(Method::kPost, "/api/v1/scene/save", "");
  (void)command<DiscardPreviews>(Method::kPost, "/api/v1/scene/discard", "");
  EXPECT_FALSE(command<Undo>(Method::kPost, "/api/v1/scene/undo", "").again);
  EXPECT_TRUE(command<Undo>(Method::kPost, "/api/v1/scene/redo", "{}").again);
  (void)command<LearnBackground>(Method::kPost, "/api/v1/background/learn", "{}");
  const auto order = [](const char* target, const char* body) {
    return std::get<output::RunOrder>(action(Method::kPut, target, body).value());
  };
  EXPECT_EQ(std::get<output::ShowView>(order("/api/v1/view", R"({"view":"light"})")).view,
            View::kLight);
  EXPECT_TRUE(std::get<output::FreezePictures>(order("/api/v1/freeze", R"({"on":true})")).on);
}

TEST(PageAction, ObjectsAreRenamedAndCopied) {
  EXPECT_EQ(command<SetObject>(Method::kPut, "/api/v1/objects/a", R"({"name": "b"})").rename, "b");
  EXPECT_FALSE(action(Method::kPut, "/api/v1/objects/a", R"({"name": ""})"));
  EXPECT_EQ(command<CopyObject>(Method::kPost, "/api/v1/objects/a/copy", "").name, "a");
  EXPECT_EQ(status_of(route_of(Method::kGet, "/api/v1/objects/a/copy")), 405);
  EXPECT_EQ(status_of(route_of(Method::kPost, "/api/v1/lamps/a/copy")), 404);
}

TEST(PageAction, PresetsAndTakesAreNamedAsFiles) {
  EXPECT_FALSE(command<StorePreset>(Method::kPut, "/api/v1/presets/night%201", "").replace);
  EXPECT_TRUE(
      command<StorePreset>(Method::kPut, "/api/v1/presets/night", R"({"replace": true})").replace);
  EXPECT_EQ(command<RecallPreset>(Method::kPost, "/api/v1/presets/night/recall", "").name, "night");
  EXPECT_EQ(command<RemovePreset>(Method::kDelete, "/api/v1/presets/night", "").name, "night");
  const auto take =
      command<SetTake>(Method::kPut, "/api/v1/takes/1-2", R"({"circled": true, "notes": "good"})");
  EXPECT_EQ(take.circled, true);
  EXPECT_EQ(take.notes, "good");
  for (const char* target : {"/api/v1/presets/..%2Fscene", "/api/v1/takes/a%2F..",
                             "/api/v1/presets/.x", "/api/v1/presets/a/b", "/api/v1/takes/a/b"})
    EXPECT_EQ(status_of(route_of(Method::kPut, target)), 404) << target;
}

TEST(PageRoute, AWrongMethodIsAnsweredWithTheRightOnes) {
  const auto allowed = [](Method method, const char* target) {
    const Route route = route_of(method, target);
    const auto* answer = std::get_if<Answer>(&route);
    if (answer == nullptr || answer->status != 405) return std::string("served");
    EXPECT_NE(answer->body.find(answer->headers.at(0).second), std::string::npos) << answer->body;
    return answer->headers.at(0).second;
  };
  EXPECT_EQ(allowed(Method::kPost, "/api/v1/view"), "GET, PUT");
  EXPECT_EQ(allowed(Method::kDelete, "/api/v1/focus"), "GET, PUT");
  EXPECT_EQ(allowed(Method::kGet, "/api/v1/scene/undo"), "POST");
  EXPECT_EQ(allowed(Method::kPut, "/api/v1/record/stop"), "POST");
  EXPECT_EQ(allowed(Method::kPost, "/api/v1/presets/a"), "PUT, DELETE");
  EXPECT_EQ(allowed(Method::kPut, "/api/v1/presets"), "GET");
  EXPECT_EQ(allowed(Method::kPut, "/api/v1/presets/a/recall"), "POST");
  EXPECT_EQ(allowed(Method::kDelete, "/api/v1/takes/a"), "PUT");
  EXPECT_EQ(allowed(Method::kDelete, "/api/v1/takes"), "GET");
  EXPECT_EQ(allowed(Method::kGet, "/api/v1/objects/a"), "PUT, POST, DELETE");
  EXPECT_EQ(allowed(Method::kPost, "/api/v1/cameras/a"), "PUT");
}

TEST(PageAction, TheHeadIsSweptOverARoom) {
  const auto start = command<StartSweep>(Method::kPost, "/api/v1/sweep/start",
                                         R"({"name":"stage 2","field_deg":[80,60]})");
  EXPECT_EQ(start.name, "stage 2");
  EXPECT_EQ(start.field_deg, Eigen::Vector2d(80, 60));
  EXPECT_EQ(start.view_frames, 4);
  (void)command<CancelSweep>(Method::kPost, "/api/v1/sweep/cancel", "");
  EXPECT_EQ(std::get<GetState>(route_of(Method::kGet, "/api/v1/sweep")).part, "sweep");
  EXPECT_EQ(status_of(route_of(Method::kGet, "/api/v1/sweep/start")), 405);
  for (const char* bad : {R"({"name":"../a"})", R"({"field_deg":[80,200]})", R"({"view_frames":0})",
                          R"({"field_deg":80})"})
    EXPECT_FALSE(action(Method::kPost, "/api/v1/sweep/start", bad)) << bad;
}

TEST(PageAction, TheFocusIsAPlaceOrADistance) {
  const auto place = command<SetFocus>(Method::kPut, "/api/v1/focus", R"({"at":[0.25,0.5]})");
  EXPECT_EQ(place.at->x(), 0.25);
  EXPECT_FALSE(place.on || place.distance_m || place.f_number);
  const auto numbers = command<SetFocus>(Method::kPut, "/api/v1/focus",
                                         R"({"on":true,"distance_m":2.5,"f_number":1.4})");
  EXPECT_EQ(numbers.distance_m, 2.5);
  EXPECT_EQ(numbers.f_number, 1.4);
  for (const char* bad : {R"({"at":[0.5,0.5],"distance_m":2})", R"({"at":[0.5,1.5]})",
                          R"({"distance_m":0})", R"({"f_number":0.1})", R"({"pixel":[1,2]})"})
    EXPECT_FALSE(action(Method::kPut, "/api/v1/focus", bad)) << bad;
  EXPECT_EQ(std::get<GetState>(route_of(Method::kGet, "/api/v1/focus")).part, "focus");
}

TEST(PageAction, WrongBodiesAreRefusedByTheirKey) {
  const auto refusal = [](const char* target, const char* body) {
    const auto result = action(Method::kPut, target, body);
    return result ? std::string("accepted") : result.error().context;
  };
  const char* const object = "/api/v1/objects/a";
  EXPECT_NE(refusal(object, R"({"at":[0,2]})").find("at is an array"), std::string::npos);
  EXPECT_NE(refusal(object, R"({"at":[0]})").find("at is an array"), std::string::npos);
  EXPECT_NE(refusal(object, R"({"scale":"big"})").find("scale is a number"), std::string::npos);
  EXPECT_NE(refusal(object, R"({"scale":0})").find("scale is a number"), std::string::npos);
  EXPECT_NE(refusal(object, R"({"scale":1e999})").find("body is no JSON"), std::string::npos);
  EXPECT_NE(refusal(object, R"({"sclae":1})").find("sclae is not known"), std::string::npos);
  EXPECT_NE(refusal(object, R"({"at":[0,0],"onto":[0,0]})").find("remove one"), std::string::npos);
  EXPECT_NE(refusal(object, R"({"at":[0,0],"position_m":[0,0,0]})").find("remove one"),
            std::string::npos);
  EXPECT_NE(refusal(object, "[]").find("no JSON object"), std::string::npos);
  EXPECT_NE(refusal(object, "{").find("no JSON"), std::string::npos);
  EXPECT_NE(refusal("/api/v1/view", R"({"view":"x"})").find("view is one of"), std::string::npos);
  EXPECT_NE(refusal("/api/v1/freeze", "{}").find("on is missing"), std::string::npos);
}

TEST(PageAction, ARecordingCannotLeaveItsFolder) {
  for (const char* name : {"../a", "a/b", ".hidden", " a", "a ", "a\\b", "\xC3\xA4"}) {
    const std::string body = nlohmann::json{{"name", name}}.dump();
    EXPECT_FALSE(action(Method::kPost, "/api/v1/record/start", body.c_str())) << name;
  }
}

}  // namespace
}  // namespace mixrig::page
