// SPDX-License-Identifier: Apache-2.0
#include "scene/yaml_tree.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>

namespace slew::scene {
namespace yaml_tree_test {

struct Parsed {
  std::optional<Node> root;
  std::string problems;
};

Parsed parse(std::string text) {
  Report report;
  Parsed parsed;
  const auto source = check_source(std::move(text), report.add_source("f"), report);
  if (source) parsed.root = parse_yaml(*source, report);
  try {
    if (!report.is_clean()) report.fail(20);
  } catch (const LoadError& error) {
    parsed.problems = error.what();
  }
  return parsed;
}

TEST(YamlTree, KeepsThePlaceOfEveryKeyAndValue) {
  const Parsed parsed = parse("a:\n  b: 5 m\n  c: [1, \"2\"]\n");
  ASSERT_TRUE(parsed.root) << parsed.problems;
  const Node::Entry& a = parsed.root->entries.at(0);
  EXPECT_EQ(a.mark, (Mark{0, 1, 1}));
  EXPECT_EQ(a.value.entries.at(0).mark, (Mark{0, 2, 3}));
  EXPECT_EQ(a.value.entries.at(0).value.mark, (Mark{0, 2, 6}));
  EXPECT_EQ(a.value.entries.at(1).value.items.at(1).mark, (Mark{0, 3, 10}));
}

TEST(YamlTree, ColumnsCountCharactersNotBytes) {
  const Parsed parsed = parse("{\"\xC3\xA4\xE2\x82\xAC\": 5}\n");
  ASSERT_TRUE(parsed.root) << parsed.problems;
  EXPECT_EQ(parsed.root->entries.at(0).value.mark, (Mark{0, 1, 8}));
}

TEST(YamlTree, ThePlaceOfAValueInALongLineIsCountedInCharacters) {
  std::string line = "{\xC3\x84: [";
  for (int i = 0; i < 3000; ++i) line += "[" + std::to_string(i) + ", 0], ";
  const Parsed parsed = parse(line + "]}");
  ASSERT_TRUE(parsed.root) << parsed.problems;
  const Node& list = parsed.root->entries.at(0).value;
  EXPECT_EQ(list.items.at(2999).mark, (Mark{0, 1, static_cast<int>(line.find("[2999,"))}));
}

TEST(YamlTree, LineBreaksThatNoEditorShowsAreRefused) {
  EXPECT_TRUE(parse("a: b\xE2\x80\xA8"
                    "c\n")
                  .problems.starts_with("f:1:5: a line break that no editor shows"));
}

TEST(YamlTree, SyntaxErrorsReportWhatIsMissingAndWhere) {
  EXPECT_EQ(parse("a: \"b\nc: 1\n").problems, "f:1:4: this quote is not closed; expected a second \"");
  EXPECT_EQ(parse("a: [1, 2}\n").problems,
            "f:1:9: not valid YAML: this bracket does not fit the '[' in line 1; expected ']'");
  EXPECT_EQ(parse("a: {b: 1\nc: 2}\nd: 3\n").problems,
            "f:2:2: not valid YAML: the '{' in line 1 goes on here; expected '}' or ','");
  EXPECT_EQ(
      parse("a: b: 1\n").problems,
      "f:1:5: not valid YAML: no key can stand here; expected one 'key: value' in a line; a ':' may be missing in "
      "the line before");
  EXPECT_EQ(parse("a:\n\tb: 1\n").problems, "f:2:1: not valid YAML: the line is indented with a tab; expected spaces");
  EXPECT_EQ(
      parse("a:\n    b: 1\n  c: 2\n").problems,
      "f:3:3: not valid YAML: this is no key of the map in line 1; expected 'key: value', indented like the other "
      "keys");
}

TEST(YamlTree, WindowsLineEndsAndAByteOrderMarkAreNoMatter) {
  const Parsed parsed = parse(
      "\xEF\xBB\xBF"
      "a: 1\r\nb: two words\r\n");
  ASSERT_TRUE(parsed.root) << parsed.problems;
  EXPECT_EQ(parsed.root->entries.at(1).value.text, "two words");
  EXPECT_EQ(parsed.root->entries.at(1).value.mark, (Mark{0, 2, 4}));
}

TEST(YamlTree, QuotedAndBlockScalarsAreMarkedAsText) {
  const Parsed parsed = parse("a: 1\nb: '1'\nc: \"1\"\nd: |\n  1\n");
  ASSERT_TRUE(parsed.root) << parsed.problems;
  EXPECT_FALSE(parsed.root->find("a")->value.is_quoted);
  EXPECT_TRUE(parsed.root->find("b")->value.is_quoted);
  EXPECT_TRUE(parsed.root->find("c")->value.is_quoted);
  EXPECT_TRUE(parsed.root->find("d")->value.is_quoted);
}

TEST(YamlTree, ADuplicateKeyKeepsTheFirstValueAndReportsBothPlaces) {
  const Parsed parsed = parse("a: 1\nb: 2\na: 3\n");
  ASSERT_TRUE(parsed.root);
  EXPECT_EQ(parsed.root->find("a")->value.text, "1");
  ASSERT_EQ(parsed.root->duplicates.size(), 1u);
  EXPECT_EQ(parsed.root->duplicates[0].mark, (Mark{0, 3, 1}));
  EXPECT_EQ(parsed.root->duplicates[0].first, (Mark{0, 1, 1}));
}

TEST(YamlTree, DuplicatesAreFoundInLargeMapsAsInSmallOnes) {
  for (const int keys : {3, 1000}) {
    std::string text;
    for (int i = 0; i < 2 * keys; ++i) text += "k" + std::to_string(i % keys) + ": " + std::to_string(i) + "\n";
    const Parsed parsed = parse(text);
    ASSERT_TRUE(parsed.root);
    ASSERT_EQ(parsed.root->entries.size(), static_cast<std::size_t>(keys));
    ASSERT_EQ(parsed.root->duplicates.size(), static_cast<std::size_t>(keys));
    for (int i = 0; i < keys; ++i) {
      EXPECT_EQ(parsed.root->entries[static_cast<std::size_t>(i)].value.text, std::to_string(i));
      EXPECT_EQ(parsed.root->duplicates[static_cast<std::size_t>(i)].first, (Mark{0, i + 1, 1}));
      EXPECT_EQ(parsed.root->duplicates[static_cast<std::size_t>(i)].mark, (Mark{0, keys + i + 1, 1}));
    }
  }
}

TEST(YamlTree, EscapedQuotesDoNotCloseAScalar) {
  const Parsed parsed = parse("a: \"x \\\" y\"\nb: 'it''s'\n");
  ASSERT_TRUE(parsed.root) << parsed.problems;
  EXPECT_EQ(parsed.root->find("a")->value.text, "x \" y");
  EXPECT_EQ(parsed.root->find("b")->value.text, "it's");
}

TEST(YamlTree, AValueThatIsNotThereIsShownAtItsKey) {
  const Parsed parsed = parse("a:\nb: 1\n");
  ASSERT_TRUE(parsed.root);
  EXPECT_EQ(parsed.root->find("a")->value.kind, Node::Kind::empty);
  EXPECT_EQ(parsed.root->find("a")->value.mark, (Mark{0, 1, 1}));
}

TEST(YamlTree, BytesThatAreNotUtf8AreRefusedWithTheirPlace) {
  for (const char* bad :
       {"\xFF", "\xC0\xAF", "\xE2\x82", "\xED\xA0\x80", "\xF4\x90\x80\x80", "\x80", "\xF8\x88\x80\x80\x80"}) {
    EXPECT_TRUE(parse(std::string("a: 1\nb: ") + bad + "\n").problems.starts_with("f:2:4: bad UTF-8")) << bad;
  }
  EXPECT_EQ(parse("a: \xF0\x9F\x8F\x97\n").problems, "");
}

TEST(YamlTree, BracketsWithoutEndAreRefusedAtOnce) {
  EXPECT_EQ(parse("a: " + std::string(100000, '[')).problems, "f:1:19: nested too deeply; expected at most 16 levels");
  EXPECT_EQ(parse("a: " + std::string(20, '[') + std::string(20, ']')).problems,
            "f:1:19: nested too deeply; expected at most 16 levels");
  EXPECT_EQ(parse("a: [1,\n").problems, "f:1:4: this '[' is not closed; expected ']' or ','");
}

TEST(YamlTree, TextOverTenMegabytesIsRefused) {
  EXPECT_EQ(parse(std::string(kMaxFileBytes + 1, ' ')).problems, "f: is 10.0 MB large; expected at most 10.0 MB");
}

TEST(YamlTree, ManyKeysAreReadInLinearTime) {
  std::string text;
  for (int i = 0; i < 20000; ++i) text += "k" + std::to_string(i) + ": 1\n";
  const Parsed parsed = parse(text);
  ASSERT_TRUE(parsed.root);
  EXPECT_EQ(parsed.root->entries.size(), 20000u);
}

}  // namespace yaml_tree_test
}  // namespace slew::scene
