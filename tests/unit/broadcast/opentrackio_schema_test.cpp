// SPDX-License-Identifier: Apache-2.0
// Samples that are sent against the schema that SMPTE publishes (MIXRIG_DATA/opentrackio), by a
// checker of the words that this schema uses.
#include <cstdlib>
#include <fstream>
#include <regex>
#include <string>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "extras/broadcast/packets/opentrackio.h"

namespace mixrig::stream {
namespace {

using nlohmann::json;

bool is_of_type(const json& value, const std::string& type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_string();
  if (type == "boolean") return value.is_boolean();
  if (type == "integer") return value.is_number_integer();
  return type == "number" && value.is_number();
}

/// Faults of a value, each with its place; empty: it is valid.
std::string faults(const json& value, const json& schema, const std::string& at) {
  const auto fault = [&](const std::string& what) { return at + ": " + what + "\n"; };
  if (schema.contains("anyOf")) {
    std::string all;
    for (const json& one : schema["anyOf"]) {
      const std::string found = faults(value, one, at);
      if (found.empty()) return {};
      all += found;
    }
    return all;
  }
  if (schema.contains("type") && !is_of_type(value, schema["type"]))
    return fault("no " + schema["type"].get<std::string>());
  std::string all;
  if (schema.contains("enum") &&
      std::find(schema["enum"].begin(), schema["enum"].end(), value) == schema["enum"].end())
    all += fault(value.dump() + " is not allowed");
  if (value.is_number() && schema.contains("minimum") && value < schema["minimum"])
    all += fault("too small");
  if (value.is_number() && schema.contains("maximum") && value > schema["maximum"])
    all += fault("too large");
  if (value.is_string() && schema.contains("pattern") &&
      !std::regex_search(value.get<std::string>(),
                         std::regex(schema["pattern"].get<std::string>())))
    all += fault("of another pattern");
  for (const json& key : schema.value("required", json::array()))
    if (!value.contains(key.get<std::string>())) all += fault("lacks " + key.get<std::string>());
  if (value.is_object())
    for (const auto& [key, inner] : value.items()) {
      const bool known = schema.contains("properties") && schema["properties"].contains(key);
      if (known)
        all += faults(inner, schema["properties"][key], at + "." + key);
      else if (schema.value("additionalProperties", json(true)) == false)
        all += fault(key + " is not known");
    }
  if (value.is_array() && schema.contains("items"))
    for (const json& inner : value) all += faults(inner, schema["items"], at + "[]");
  return all;
}

class OpenTrackSchema : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const root = std::getenv("MIXRIG_DATA");
    if (root == nullptr) GTEST_SKIP() << "needs opentrackio/: set MIXRIG_DATA to its folder";
    folder_ = std::string(root) + "/opentrackio/";
    schema_ = read("schema.json");
    if (!schema_.is_object()) GTEST_SKIP() << folder_ << " has no schema.json";
  }
  json read(const std::string& name) const {
    std::ifstream file(folder_ + name);
    return file ? json::parse(file, nullptr, false) : json();
  }
  static json sent(const OpenTrackSample& sample, OpenTrackEncoding encoding) {
    const auto payload = opentrack_payload(sample, encoding);
    const auto* const begin = reinterpret_cast<const std::uint8_t*>(payload.data());
    return encoding == OpenTrackEncoding::kCbor ? json::from_cbor(begin, begin + payload.size())
                                                : json::parse(begin, begin + payload.size());
  }
  std::string folder_;
  json schema_;
};

TEST_F(OpenTrackSchema, TheCheckerTakesThePublishedSamplesAndFindsFaults) {
  for (const char* name : {"complete_dynamic_example.json", "complete_static_example.json"}) {
    json sample = read(name);
    EXPECT_EQ(faults(sample, schema_, ""), "") << name;
    sample["timing"]["synchronization"]["source"] = "sundial";
    EXPECT_NE(faults(sample, schema_, ""), "");
    sample["timing"]["synchronization"].erase("source");
    EXPECT_NE(faults(sample, schema_, ""), "");
  }
}

TEST_F(OpenTrackSchema, WhatIsSentIsValid) {
  OpenTrackSample sample;
  sample.number = 7, sample.time_ns = 1'750'000'000'040'000'001, sample.status = "ok";
  sample.sample_id[6] = sample.source_id[6] = 0x40;
  sample.sample_id[8] = sample.source_id[8] = 0x80;
  sample.angles = CameraAngles{0.1, -0.2, 0.3};
  sample.position_m = {1.5, -2, 0.25};
  sample.focal_length_mm = 24, sample.offset_mm = {0.5, -0.25};
  sample.zoom = 4012, sample.focus = 70000;
  sample.sensor = {36, 20.25, 1280, 720};
  using Source = OpenTrackSample::Synchronization::Source;
  for (const auto encoding : {OpenTrackEncoding::kJson, OpenTrackEncoding::kCbor})
    for (const auto source : {Source::kPtp, Source::kNtp}) {
      sample.synchronization = {source, true};
      const json whole = sent(sample, encoding);
      EXPECT_EQ(faults(whole, schema_, ""), "") << whole.dump();
      EXPECT_TRUE(whole["timing"]["synchronization"]["locked"].get<bool>());
    }
  sample.synchronization.reset(), sample.angles.reset(), sample.sensor.reset();
  EXPECT_EQ(faults(sent(sample, OpenTrackEncoding::kJson), schema_, ""), "");
}

}  // namespace
}  // namespace mixrig::stream
