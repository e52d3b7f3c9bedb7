// SPDX-License-Identifier: Apache-2.0
// Manifests: what a getter returns, and the one line that an operator reads.
#include "host/math/config/table.h"

#include <cstdlib>
#include <random>

#include <gtest/gtest.h>

namespace mixrig::config {
namespace {

Document parsed(const std::string& text) {
  auto document = Document::parse(text, "a.toml");
  EXPECT_TRUE(document) << document.error().context;
  return *std::move(document);
}

/// The line of the error that reading `text` by `read` gives; empty for none.
template <typename Read>
std::string line_of(const std::string& text, Read read) {
  Document document = parsed(text);
  read(document.root());
  const auto result = document.finish();
  return result ? "" : result.error().context;
}

TEST(Table, GettersReturnWhatTheFileSays) {
  Document document = parsed(
      "n = 2.5\ni = 7\nt = \"x\"\nb = false\nword = \"two\"\nv = [1, 2.5]\nm = [[1, 2], [3, 4]]\n"
      "[s]\nk = 1\n[[list]]\na = 1\n[[list]]\na = 2\n");
  const Table root = document.root();
  EXPECT_EQ(root.number("n"), 2.5);
  EXPECT_EQ(root.integer("i", {0, 10}), 7);
  EXPECT_EQ(root.number("i"), 7.0) << "a whole number is a number";
  EXPECT_EQ(root.text("t"), "x");
  EXPECT_FALSE(root.boolean_or("b", true));
  EXPECT_EQ(root.one_of("word", {"one", "two"}, 0), 1);
  EXPECT_EQ(root.numbers("v", 1, 3), (std::vector<double>{1, 2.5}));
  EXPECT_EQ(root.matrix("m", 2, 2), (std::vector<double>{1, 2, 3, 4}));
  EXPECT_EQ(root.size_of("m"), 2U);
  EXPECT_EQ(root.size_of("n"), 0U) << "no array";
  EXPECT_EQ(root.table("s").integer("k", {0, 9}), 1);
  EXPECT_EQ(root.table("s").keys(), std::vector<std::string>{"k"});
  EXPECT_TRUE(root.table("absent").keys().empty());
  const auto list = root.tables("list");
  ASSERT_EQ(list.size(), 2U);
  EXPECT_EQ(list[0].integer("a", {0, 9}), 1);
  EXPECT_EQ(list[1].integer("a", {0, 9}), 2);
  EXPECT_FALSE(root.table("absent").present());
  EXPECT_EQ(root.table("absent").number_or("x", 4.0), 4.0);
  EXPECT_EQ(root.number_or("absent_number", 3.0), 3.0);
  EXPECT_TRUE(document.finish());
}

TEST(Table, ReportsAnUnknownKeyWithLineAndNearestBeforeTheMissingOne) {
  EXPECT_EQ(
      line_of("[key]\n\ntreshold_m = 1\n", [](Table t) { t.table("key").number("threshold_m"); }),
      "a.toml:3: key \"key.treshold_m\": not known: did you mean \"threshold_m\"?");
  EXPECT_EQ(line_of("qqqqqq = 1\n", [](Table t) { t.has("color"); }),
            "a.toml:1: key \"qqqqqq\": not known: remove it");
  EXPECT_EQ(line_of("[[o]]\na = 1\n[[o]]\nb = 1\n",
                    [](Table t) {
                      for (const Table& o : t.tables("o")) o.number_or("a", 0);
                    }),
            "a.toml:4: key \"o.b\": not known: remove it");
}

TEST(Table, ReportsWrongValuesWithLineRangeAndWhatToDo) {
  EXPECT_EQ(line_of("\nfx = -1\n",
                    [](Table t) {
                      t.number("fx", {0, 10});
                    }),
            "a.toml:2: key \"fx\": -1 is out of range: give 0 to 10");
  EXPECT_EQ(line_of("fx = nan\n",
                    [](Table t) {
                      t.number("fx", {0, 10});
                    }),
            "a.toml:1: key \"fx\": nan is out of range: give 0 to 10");
  EXPECT_EQ(line_of("fx = inf\n", [](Table t) { t.number_or("fx", 0); }).substr(0, 30),
            "a.toml:1: key \"fx\": inf is out");
  EXPECT_EQ(line_of("fx = \"1\"\n", [](Table t) { t.number("fx"); }),
            "a.toml:1: key \"fx\": must be a number: correct the value");
  EXPECT_EQ(line_of("n = 1.5\n",
                    [](Table t) {
                      t.integer("n", {0, 9});
                    }),
            "a.toml:1: key \"n\": must be a whole number: correct the value");
  EXPECT_EQ(line_of("v = [1, 2]\n", [](Table t) { t.numbers("v", 3, 3); }),
            "a.toml:1: key \"v\": must be an array of 3 numbers: correct the value");
  EXPECT_EQ(line_of("m = [[1, 2], [3]]\n", [](Table t) { t.matrix("m", 2, 2); }),
            "a.toml:1: key \"m\": must be 2 arrays of 2 numbers: correct the value");
  EXPECT_EQ(line_of("m = [[1, nan], [3, 4]]\n", [](Table t) { t.matrix("m", 2, 2); }),
            "a.toml:1: key \"m\": must be 2 arrays of 2 finite numbers: correct the value");
  EXPECT_EQ(line_of("w = \"x\"\n",
                    [](Table t) {
                      t.one_of("w", {"a", "b"}, 0);
                    }),
            "a.toml:1: key \"w\": \"x\" is not known: use one of \"a\", \"b\"");
  EXPECT_EQ(line_of("\n[t]\n", [](Table t) { t.table("t").number("fx"); }),
            "a.toml:2: key \"t.fx\": missing: add it");
  EXPECT_EQ(line_of("s = 1\n", [](Table t) { t.table("s"); }),
            "a.toml:1: key \"s\": must be a table: correct the value");
  EXPECT_EQ(line_of("s = [1]\n", [](Table t) { t.tables("s"); }),
            "a.toml:1: key \"s\": must be tables: write [[s]] before each");
  EXPECT_EQ(line_of("", [](Table t) { t.required_table("s"); }),
            "a.toml:1: key \"s\": missing: add it");
}

TEST(Document, BadTomlIsOneLineWithItsPlace) {
  const auto broken = Document::parse("a = 1\nb = = 2\n", "a.toml");
  ASSERT_FALSE(broken);
  EXPECT_EQ(broken.error().code, ErrorCode::kFormat);
  EXPECT_EQ(broken.error().context.substr(0, 9), "a.toml:2:");
  EXPECT_EQ(broken.error().context.find('\n'), std::string::npos);
}

TEST(Document, NestingThatWouldOverflowTheStackIsRefused) {
  std::string deep = "a";
  for (int i = 0; i < 200000; ++i) deep += ".a";
  EXPECT_FALSE(Document::parse(deep + " = 1\n", "a.toml"));
  EXPECT_FALSE(Document::parse("[" + deep + "]\n", "a.toml"));
  EXPECT_FALSE(Document::parse("a = " + std::string(200000, '['), "a.toml"));
  EXPECT_FALSE(Document::parse(std::string(2U << 20, '\n'), "a.toml"));
}

TEST(Document, AnyBytesEndInAValueOrALine) {
  const std::string whole = "[color]\npath = \"a.png\"\nv = [1.0, 2]\n[[o]]\nx = { y = 1 }\n";
  std::mt19937 random(5);
  for (int i = 0; i < 3000; ++i) {
    std::string text = whole.substr(0, random() % (whole.size() + 1));
    for (unsigned flips = random() % 4; flips > 0 && !text.empty(); --flips)
      text[random() % text.size()] = static_cast<char>(random());
    const auto document = Document::parse(text, "a.toml");
    if (!document) {
      EXPECT_EQ(document.error().context.substr(0, 7), "a.toml:");
    }
  }
}

TEST(Document, MissingFileIsNotFoundAndAFolderIsNoFile) {
  EXPECT_EQ(Document::read("/nonexistent/a.toml").error().code, ErrorCode::kNotFound);
  EXPECT_FALSE(Document::read("/"));
}

TEST(ExpandEnvironment, ReplacesSetVariablesAndNamesTheUnsetOne) {
  setenv("MIXRIG_TEST_A", "/data", 1);
  unsetenv("MIXRIG_TEST_B");
  EXPECT_EQ(*expand_environment("${MIXRIG_TEST_A}/x"), "/data/x");
  EXPECT_EQ(*expand_environment("plain"), "plain");
  const auto unset = expand_environment("${MIXRIG_TEST_B}/x");
  ASSERT_FALSE(unset);
  EXPECT_NE(unset.error().context.find("MIXRIG_TEST_B is not set"), std::string::npos);
  EXPECT_FALSE(expand_environment("${MIXRIG"));
}

}  // namespace
}  // namespace mixrig::config
