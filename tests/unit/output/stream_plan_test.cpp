// SPDX-License-Identifier: Apache-2.0
#include "host/output/streams/stream_plan.h"

#include <gtest/gtest.h>

#include "tests/support/refusal.h"

namespace mixrig::output {
namespace {

using Picture = scene::StreamOut::Picture;
using Codec = scene::StreamOut::Codec;

Result<StreamPlan> plan(const std::string& uri, Picture picture = Picture::kFill,
                        Codec codec = Codec::kAuto) {
  scene::StreamOut out;
  out.uri = uri, out.picture = picture, out.codec = codec;
  return plan_stream(out, {640, 480}, 25);
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(StreamPlan, EachAddressHasItsCodecAndPlugIns) {
  const auto srt = plan("srt://127.0.0.1:7001");
  ASSERT_TRUE(srt) << srt.error().context;
  EXPECT_TRUE(has(srt->description, "x264enc") && has(srt->description, "mpegtsmux"));
  EXPECT_TRUE(has(srt->description, "width=640,height=480,framerate=25000/1000"));
  EXPECT_FALSE(srt->waits);
  const auto file = plan("a.mkv", Picture::kAlpha);
  ASSERT_TRUE(file);
  EXPECT_TRUE(has(file->description, "format=BGRA") && has(file->description, "avenc_ffv1"));
  EXPECT_TRUE(file->waits);
  const auto depth = plan("shm:///tmp/depth", Picture::kDepth);
  ASSERT_TRUE(depth);
  EXPECT_TRUE(has(depth->caps, "GRAY16_LE"));
  const auto rtp = plan("rtp://10.0.0.7:5004", Picture::kStereo);
  ASSERT_TRUE(rtp);
  EXPECT_TRUE(has(rtp->description, "width=1280,"));
  EXPECT_EQ(rtp->port, 5004);
  const auto texts = [](const std::string& uri) { return plan(uri, Picture::kFill)->texts; };
  using Texts = std::vector<std::pair<std::string, std::string>>;
  EXPECT_EQ(texts("rtp://10.0.0.7:5004"), (Texts{{"host", "10.0.0.7"}}));
  EXPECT_EQ(texts("rtp://127.0.0.1:5004"),
            (Texts{{"host", "127.0.0.1"}, {"bind-address", "127.0.0.1"}}));
  EXPECT_EQ(texts("rtp://localhost:5004"), texts("rtp://127.0.0.1:5004"));
  EXPECT_TRUE(has(plan("a.mov", Picture::kAlpha)->description, "A444_10LE"));
  const auto page = plan("a.mp4", Picture::kFill);
  ASSERT_TRUE(page);
  EXPECT_TRUE(has(page->description, "x264enc") && has(page->description, "mp4mux"));
  EXPECT_TRUE(page->waits && page->i420);
  const std::string node = plan("v4l2:///dev/video7")->description;
  EXPECT_TRUE(has(node, "v4l2sink"));
  EXPECT_TRUE(has(node, "format=YUY2")) << "what every reader of a camera takes";
}

TEST(StreamPlan, AListenerWithoutAnAddressHearsThisMachineAlone) {
  EXPECT_EQ(plan("srt://:7001?mode=listener")->texts.at(0).second,
            "srt://127.0.0.1:7001?mode=listener");
}

TEST(StreamPlan, KeysOfSrtAreReadOrRefused) {
  EXPECT_TRUE(plan("srt://a:1")->calls);
  EXPECT_TRUE(plan("srt://a:1?latency=200&mode=caller&passphrase=0123456789")->calls);
  EXPECT_FALSE(plan("srt://:1?mode=listener&pbkeylen=32")->calls);
  EXPECT_FALSE(plan("rtp://a:1")->calls);
  const std::pair<const char*, const char*> wrong[] = {
      {"srt://a:1?pasphrase=0123456789", "no key \"pasphrase\""},
      {"srt://a:1?passphrase=short", "10 to 79"},
      {"srt://a:1?mode=client", "caller, listener or rendezvous"},
      {"srt://a:1?pbkeylen=128", "16, 24 or 32"},
      {"srt://a:1?", "no key \"\""},
      {"srt://a:1?latency=1&&mode=caller", "no key \"\""}};
  for (const auto& [uri, says] : wrong)
    EXPECT_TRUE(test::refused(plan(uri), {uri, says}, ErrorCode::kUsage)) << uri;
}

TEST(StreamPlan, OddSidesAreRefusedWhereTheCodecCannotHoldThem) {
  scene::StreamOut out;
  out.uri = "srt://127.0.0.1:7001";
  EXPECT_TRUE(test::refused(plan_stream(out, {161, 129}, 25), {"even sides", "161x129"}));
  out.picture = Picture::kFillKey;  // two beside each other: 322 wide
  EXPECT_TRUE(test::refused(plan_stream(out, {161, 129}, 25), {"322x129"}));
  EXPECT_TRUE(plan_stream(out, {161, 128}, 25));
  out.codec = Codec::kFfv1;
  EXPECT_TRUE(plan_stream(out, {161, 129}, 25));
}

TEST(StreamPlan, NothingOfTheAddressIsReadAsAPipeline) {
  const auto evil = plan("shm:///tmp/x ! filesink location=/tmp/y");
  ASSERT_TRUE(evil);
  EXPECT_FALSE(has(evil->description, "/tmp/y"));
}

TEST(StreamPlan, WhatCannotBeCarriedIsOneLine) {
  struct Row {
    const char* uri;
    Picture picture;
    Codec codec;
    const char* says;
  };
  const Row rows[] = {
      {"rtmp://a/b", Picture::kFill, Codec::kAuto, "is no stream: give srt://"},
      {"a.avi", Picture::kFill, Codec::kAuto, "is no stream"},
      {"rtp://host", Picture::kFill, Codec::kAuto, "names no host and port"},
      {"rtp://a:70000", Picture::kFill, Codec::kAuto, "names no host and port"},
      {"srt://a", Picture::kFill, Codec::kAuto, "names no host and port: give srt://"},
      {"srt://:::", Picture::kFill, Codec::kAuto, "names no host and port: give srt://"},
      {"srt://a:0?mode=caller", Picture::kFill, Codec::kAuto, "names no host and port"},
      {"srt://a:1", Picture::kDepth, Codec::kH264, "depth has 16 bits"},
      {"rtp://a:1", Picture::kDepth, Codec::kAuto, "depth has 16 bits"},
      {"srt://a:1", Picture::kAlpha, Codec::kH264, "no alpha"},
      {"v4l2:///dev/video1", Picture::kAlpha, Codec::kAuto, "no alpha"},
      {"rtp://a:1", Picture::kFill, Codec::kFfv1, "RTP carries H.264 or raw"},
      {"a.mov", Picture::kFill, Codec::kFfv1, "belong together"},
      {"a.mp4", Picture::kFill, Codec::kFfv1, "an .mp4 carries H.264"},
      {"a.mp4", Picture::kAlpha, Codec::kAuto, "no alpha"},
      {"a.mp4", Picture::kDepth, Codec::kAuto, "depth has 16 bits"},
      {"shm:///a", Picture::kFill, Codec::kH264, "cannot carry codec \"h264\""},
      {"a.mkv", Picture::kFill, Codec::kRaw, "cannot carry codec \"raw\""},
  };
  for (const Row& row : rows) {
    const auto wrong = plan(row.uri, row.picture, row.codec);
    EXPECT_TRUE(test::refused(wrong, {}, ErrorCode::kUsage)) << row.uri;
    EXPECT_TRUE(has(wrong.error().context, row.says)) << wrong.error().context;
    EXPECT_EQ(wrong.error().context.find('\n'), std::string::npos);
  }
}

}  // namespace
}  // namespace mixrig::output
