// SPDX-License-Identifier: Apache-2.0
// the generic reader against a Def that no library owns
#include "scene/field_reader.h"

#include <gtest/gtest.h>

#include <optional>
#include <string>
#include <vector>

#include "scene/yaml_tree.h"

namespace slew::scene {
namespace field_reader_test {

enum class Colour : int { red, green };
constexpr std::string_view kColours[] = {"red", "green"};

struct ThingDef {
  double length = 1;
  std::int64_t count = 0;
  bool is_open = false;
  std::string label;
  std::string body;
  Triple position{};
  Table curve;
  std::vector<double> masses;
  std::vector<std::string> names;
  Colour colour = Colour::red;
};

constexpr Range kCount{.min = 0, .max = 5, .min_is_open = false, .max_is_open = false};

constexpr Field kFields[] = {
    field<&ThingDef::length>(
        "length",
        {.dimension = Dimension::length, .range = kPositive, .presence = Presence::required, .doc = "length"}),
    field<&ThingDef::count>("count", {.range = kCount}),
    field<&ThingDef::is_open>("is_open", {}),
    field<&ThingDef::label>("label", {}),
    field<&ThingDef::body>("body", {.reference = "body"}),
    field<&ThingDef::position>("position", {.dimension = Dimension::length}),
    field<&ThingDef::curve>(
        "curve", {.dimension = Dimension::time, .value_dimension = Dimension::pressure, .range = kNotNegative}),
    field<&ThingDef::masses>("masses", {.dimension = Dimension::mass, .range = kPositive}),
    field<&ThingDef::names>("names", {.reference = "volume"}),
    field<&ThingDef::colour>("colour", {.choices = kColours}),
};

struct Reading {
  ThingDef def;
  std::string problems;
  std::vector<Reference> references;
};

Reading read(const std::string& text) {
  static UnitSystem units;
  Report report;
  PlaceMap places;
  Reading reading;
  const auto source = check_source(text, report.add_source("f"), report);
  const auto root = parse_yaml(*source, report);
  if (root)
    read_fields(*root, kFields, &reading.def, "Thing", root->mark, {}, {units, report, places, reading.references});
  try {
    if (!report.is_clean()) report.fail(20);
  } catch (const LoadError& error) {
    reading.problems = error.what();
  }
  return reading;
}

TEST(FieldReader, FillsEveryTypeOfMember) {
  const Reading reading = read(
      "length: 20 cm\ncount: 3\nis_open: true\nlabel: a label\nbody: Rod\nposition: [1, 2 mm, 3 km]\n"
      "curve: [[0, 1 bar], [100 ms, 2e5]]\nmasses: [1 t, 2]\nnames: [A, B]\ncolour: green\n");
  EXPECT_EQ(reading.problems, "");
  EXPECT_EQ(reading.def.length, 0.2);
  EXPECT_EQ(reading.def.count, 3);
  EXPECT_TRUE(reading.def.is_open);
  EXPECT_EQ(reading.def.label, "a label");
  EXPECT_EQ(reading.def.position, (Triple{1, 0.002, 3000}));
  EXPECT_EQ(reading.def.curve, (Table{{0, 1e5}, {0.1, 2e5}}));
  EXPECT_EQ(reading.def.masses, (std::vector<double>{1000, 2}));
  EXPECT_EQ(reading.def.names, (std::vector<std::string>{"A", "B"}));
  EXPECT_EQ(reading.def.colour, Colour::green);
}

TEST(FieldReader, CollectsReferencesWithKindAndPlace) {
  const Reading reading = read("length: 1\nbody: Rod\nnames: [A]\n");
  ASSERT_EQ(reading.references.size(), 2u);
  EXPECT_EQ(reading.references[0].kind, "body");
  EXPECT_EQ(reading.references[0].name, "Rod");
  EXPECT_EQ(reading.references[0].mark, (Mark{0, 2, 7}));
  EXPECT_EQ(reading.references[1].kind, "volume");
}

TEST(FieldReader, AFieldThatIsRefusedKeepsItsDefault) {
  EXPECT_EQ(read("length: -5\n").def.length, 1.0);
}

struct Refused {
  const char* text;
  const char* problem;
};

const Refused kRefused[] = {
    Refused{"count: 1\n",
            "f:1:1: Thing: the key 'length' is missing; expected a length such as '1.5 m', or a bare number in m"},
    Refused{"length: 0 m\n", "f:1:9: Thing.length: '0 m' is out of range; expected more than 0 m"},
    Refused{"length: {a: 1}\n",
            "f:1:9: Thing.length: is a map; expected a length such as '1.5 m', or a bare number in m"},
    Refused{"length: 1\ncount: 6\n", "f:2:8: Thing.count: '6' is out of range; expected 0 to 5"},
    Refused{"length: 1\ncount: 2 m\n", "f:2:8: Thing.count: is '2 m'; expected an integer without unit"},
    Refused{"length: 1\ncount: '2'\n", "f:2:8: Thing.count: is '2'; expected an integer"},
    Refused{"length: 1\ncount: 010\n", "f:2:8: Thing.count: '010' looks octal; expected 10 or 8"},
    Refused{"length: 1\nis_open: off\n", "f:2:10: Thing.is_open: 'off' is ambiguous in YAML; expected true or false"},
    Refused{"length: 1\nis_open: 'true'\n", "f:2:10: Thing.is_open: is 'true'; expected true or false"},
    Refused{"length: 1\nlabel: [a]\n", "f:2:8: Thing.label: is a list; expected a text"},
    Refused{"length: 1\nposition: 5\n", "f:2:11: Thing.position: is '5'; expected a list of three, [x, y, z]"},
    Refused{"length: 1\nposition: [1, 2, 3, 4]\n",
            "f:2:11: Thing.position: is a list of 4; expected a list of three, [x, y, z]"},
    Refused{"length: 1\ncurve: [[0, 1], [1]]\n",
            "f:2:17: Thing.curve: a point has 1 value; expected points of two values, [[argument, value], ...]"},
    Refused{"length: 1\ncurve: [[0, -1]]\n", "f:2:13: Thing.curve: '-1' is out of range; expected at least 0 Pa"},
    Refused{"length: 1\ncurve: []\n",
            "f:2:8: Thing.curve: is an empty list; expected a list of points [argument, value]"},
    Refused{"length: 1\nmasses: 5\n", "f:2:9: Thing.masses: is '5'; expected a list of numbers"},
    Refused{"length: 1\nnames: [A, [B]]\n", "f:2:12: Thing.names: an entry is a list; expected a text"},
    Refused{"length: 1\ncolour: gren\n",
            "f:2:9: Thing.colour: is 'gren'; expected red or green; did you mean 'green'?"}};

TEST(FieldReader, RefusesWithPlaceReasonAndExpectation) {
  for (const auto& [text, problem] : kRefused) EXPECT_EQ(read(text).problems, problem);
}

}  // namespace field_reader_test
}  // namespace slew::scene
