// SPDX-License-Identifier: Apache-2.0
#include "extras/people/watch/people_extra.h"

#include <gtest/gtest.h>

#include "host/run/explain/explain.h"
#include "tests/support/box_source.h"

namespace mixrig::session {
namespace {

class PeopleExtraTest : public ::testing::Test {
 protected:
  PeopleExtraTest() {
    session_.source = std::make_unique<test::BoxSource>(5, 12);
    session_.setup = *setup_of(session_.source->info(), std::nullopt);
    session_.backend = {render::Backend::kCpu, 1};
  }
  /// The line of `mixrig explain`; empty where there is none.
  PassLine pass(std::string_view name) {
    const auto out = explain(session_, 4, {std::make_shared<PeopleExtra>()}, clock_, {});
    EXPECT_TRUE(out) << out.error().context;
    for (const PassLine& line : out->passes)
      if (line.name == name) return line;
    return {};
  }
  Session session_;
  SystemClock clock_;
};

TEST_F(PeopleExtraTest, ASceneThatAsksForNothingRunsNothing) {
  EXPECT_TRUE(pass("people").why.starts_with("not run")) << pass("people").why;
  EXPECT_TRUE(pass("touch").why.starts_with("not run")) << pass("touch").why;
  EXPECT_EQ(pass("physics").why, "not run: no object has physics");
}

TEST_F(PeopleExtraTest, SaysWhyPeopleAreFollowedAndWhoIsTold) {
  session_.scene.follow_people = true;
  session_.scene.events = {"127.0.0.1:7420", "127.0.0.1:7421", true};
  EXPECT_EQ(pass("people").why, "people are followed for [people] and [events], beside the frames");
  EXPECT_EQ(pass("touch").why,
            "who touches 0 objects, beside the frames; written to events.jsonl, as JSON to "
            "127.0.0.1:7420, as OSC to 127.0.0.1:7421, with the places of people");
  EXPECT_GT(pass("people").p50_ms, 0);
  EXPECT_GT(pass("touch").p50_ms, 0);
}

}  // namespace
}  // namespace mixrig::session
