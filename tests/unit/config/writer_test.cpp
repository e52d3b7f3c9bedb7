// SPDX-License-Identifier: Apache-2.0
// Document must read back the same values that Writer writes.
#include "host/math/config/writer.h"

#include <array>
#include <bit>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "host/math/config/table.h"

namespace mixrig::config {
namespace {

Document read_back(const Writer& writer) {
  auto document = Document::parse(writer.text(), "w.toml");
  EXPECT_TRUE(document) << document.error().context << "\n" << writer.text();
  return *std::move(document);
}

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

TEST(Writer, WritesValuesTablesAndArraysOfTables) {
  Writer root, first, second, inner, deeper;
  root.set("format", 1).set("name", "a take").set("fine", true).set("unit_m", 25.0);
  root.set("size_px", Size{640, 480});
  first.set("name", "one");
  second.set("name", "two");
  root.add("camera", std::move(first)).add("camera", std::move(second));
  inner.set("learn", std::array<int, 2>{1, 25});
  inner.set_matrix("rotation", 2, std::array<double, 4>{1, 0, 0, 1});
  inner.set("empty", Writer());
  root.set("part", std::move(inner));
  deeper.set("name", "no header for a table of tables");
  root.set("deep", std::move(Writer().set("deeper", std::move(deeper))));
  EXPECT_EQ(root.text(), R"(format = 1
name = "a take"
fine = true
unit_m = 25.0
size_px = [640, 480]

[[camera]]
name = "one"

[[camera]]
name = "two"

[part]
learn = [1, 25]
rotation = [[1.0, 0.0], [0.0, 1.0]]

[part.empty]

[deep.deeper]
name = "no header for a table of tables"
)");
}

TEST(Writer, TextOfAnyKindReadsBackTheSame) {
  for (const char* text :
       {"", "plain", "with \"quotes\"", "C:\\folder\\new", "two\nlines\r\n", "\ttab",
        "\x01\x1f\x7f", "'single'", "'''", "\"\"\"", "K\xc3\xb6nig \xe5\xae\xa4 \xf0\x9f\x8e\xa5",
        "# no comment", "[table]", "a = 1", "\\u0041"}) {
    Writer root, under_a_key;
    root.set("text", text);
    under_a_key.set("value", 1);
    root.set("tables", std::move(Writer().set(text, std::move(under_a_key))));
    Document document = read_back(root);
    EXPECT_EQ(document.root().text("text"), text);
    const Table tables = document.root().table("tables");
    ASSERT_EQ(tables.keys(), std::vector<std::string>{text}) << "a key is escaped too";
    EXPECT_EQ(tables.table(text).integer("value", {0, 9}), 1);
    EXPECT_TRUE(document.finish());
  }
}

TEST(Writer, BytesThatAreNotUtf8StillMakeAFileThatCanBeRead) {
  Writer root;
  root.set("name", "bad \xff\xc3 bytes");
  const std::string name = read_back(root).root().text("name");
  EXPECT_TRUE(name.starts_with("bad ")) << name;
  EXPECT_TRUE(name.ends_with(" bytes")) << name;
}

TEST(Writer, NumbersReadBackToTheSameBits) {
  std::vector<double> values{0.0,
                             -0.0,
                             0.1,
                             1.0 / 3.0,
                             1e-17,
                             5e-324,
                             1e300,
                             -1e22,
                             123456789012345680.0,
                             std::nextafter(1.0, 2.0),
                             std::numeric_limits<double>::max()};
  std::mt19937_64 random(3);
  while (values.size() < 2000)
    if (const auto value = std::bit_cast<double>(random()); std::isfinite(value))
      values.push_back(value);
  Writer root;
  root.set("array", values);
  root.set_matrix("matrix", 4, values);
  for (std::size_t i = 0; i < values.size(); ++i) root.set("value" + std::to_string(i), values[i]);
  Document document = read_back(root);
  const auto array = document.root().numbers("array", values.size(), values.size());
  const auto matrix = document.root().matrix("matrix", values.size() / 4, 4);
  for (std::size_t i = 0; i < values.size(); ++i) {
    EXPECT_TRUE(same_bits(array[i], values[i])) << values[i];
    EXPECT_TRUE(same_bits(matrix[i], values[i])) << values[i];
    EXPECT_TRUE(same_bits(document.root().number("value" + std::to_string(i)), values[i]));
  }
}

TEST(Writer, NumbersHaveTheFewestDigits) {
  Writer root;
  root.set("values", std::vector<double>{29.97, 1100.1, 1e-5, -3, 1e300});
  EXPECT_EQ(root.text(), "values = [29.97, 1100.1, 1e-05, -3.0, 1e+300]\n");
}

TEST(Writer, AValueThatIsSetAgainIsReplaced) {
  Writer root;
  root.set("key", 1).set("next", true).set("key", "text");
  EXPECT_EQ(root.text(), "key = \"text\"\nnext = true\n");
}

TEST(Writer, ALongMatrixIsWrittenOneRowALine) {
  Writer root;
  root.set_matrix("m", 3, std::vector<double>(30, 0.125));
  EXPECT_TRUE(root.text().starts_with("m = [\n  [0.125, 0.125, 0.125],\n  [")) << root.text();
  EXPECT_EQ(read_back(root).root().matrix("m", 10, 3), std::vector<double>(30, 0.125));
}

TEST(Rounded, KeepsThatManySignificantDigits) {
  EXPECT_EQ(rounded(0.123456789, 7), 0.1234568);
  EXPECT_EQ(rounded(-1234.56789, 6), -1234.57);
  EXPECT_EQ(rounded(1000 * 0.07, 6), 70.0);
  EXPECT_EQ(rounded(0.0, 7), 0.0);
  EXPECT_EQ(rounded(1e-9 / 3, 7), 3.333333e-10);
  EXPECT_EQ(rounded(1.0 / 3, 17), 1.0 / 3);
}

}  // namespace
}  // namespace mixrig::config
