// SPDX-License-Identifier: Apache-2.0
#include "scene/schema.h"

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "build_paths.h"
#include "flex/field_tables.h"
#include "scene/element_table.h"
#include "scene/mesh_inertia.h"
#include "scene/sections.h"
#include "scene/shape_fields.h"

namespace slew::scene {
namespace schema_test {

std::string read_file(const std::string& path) {
  std::ifstream in(path);
  std::stringstream text;
  text << in.rdbuf();
  return text.str();
}

// A schema with its definitions in place of the references to them.
nlohmann::json resolved(const nlohmann::json& node, const nlohmann::json& definitions) {
  nlohmann::json result = node;
  if (!node.is_structured()) return result;
  if (node.is_object() && node.contains("$ref")) {
    const std::string name = node["$ref"].get<std::string>().substr(std::string("#/$defs/").size());
    result = resolved(definitions.at(name), definitions);
    result.update(node);
    result.erase("$ref");
    return result;
  }
  for (auto& [key, part] : result.items()) part = resolved(part, definitions);
  return result;
}

nlohmann::json resolved_schema(const std::string& text) {
  const auto schema = nlohmann::json::parse(text);
  return resolved(schema, schema.at("$defs"));
}

TEST(Schema, HasEveryFieldOfEveryTable) {
  const auto schema = resolved_schema(json_schema());
  for (const ElementTable& table : element_tables()) {
    const auto& element = schema["else"]["properties"][std::string(table.section)]["additionalProperties"];
    // not constant: a key that is missing reads as null
    auto alternatives = element.contains("oneOf") ? element["oneOf"] : nlohmann::json::array({element});
    bool is_found = false;
    for (auto& alternative : alternatives) {
      // the last one is laid over a template, which may give the type
      if (alternative["properties"].contains("use")) continue;
      if (!table.type.empty() && alternative["properties"]["type"]["const"] != std::string(table.type)) continue;
      // the other form of a body: below
      if (alternative["properties"]["inertia"].contains("const")) continue;
      is_found = true;
      for (const ListTable& list : table.lists) {
        EXPECT_EQ(alternative["properties"][std::string(list.key)]["type"], "array") << table.section << list.key;
      }
      for (const Field& field : table.fields) {
        EXPECT_TRUE(alternative["properties"].contains(std::string(field.key))) << table.section << " " << field.key;
      }
    }
    EXPECT_TRUE(is_found) << table.section << " " << table.type;
  }
}

TEST(Schema, ReportsWhichFieldsAreLive) {
  const auto schema = resolved_schema(json_schema());
  const auto& bodies = schema["else"]["properties"]["bodies"]["additionalProperties"]["oneOf"];
  // numbers, mesh, each shape, parts; flexible and segmented; the last one is laid over a template
  const std::size_t rigid_forms = 3 + shape_words().size();
  ASSERT_EQ(bodies.size(), rigid_forms + 3);
  for (std::size_t i = 0; i < rigid_forms; ++i) EXPECT_TRUE(bodies[i]["properties"]["mass"]["x-live"].get<bool>()) << i;
  for (std::size_t i = rigid_forms; i < rigid_forms + 2; ++i) {
    EXPECT_FALSE(bodies[i]["properties"]["mass"].contains("x-live")) << i;
  }
}

TEST(Schema, HasTheFieldsOfABodyFromAMesh) {
  const auto schema = resolved_schema(json_schema());
  const auto& bodies = schema["else"]["properties"]["bodies"]["additionalProperties"]["oneOf"];
  EXPECT_EQ(bodies[1]["properties"]["inertia"]["const"], "from_mesh");
  for (const Field& field : mesh_inertia_fields()) {
    EXPECT_TRUE(bodies[1]["properties"].contains(std::string(field.key))) << field.key;
    EXPECT_FALSE(field.doc.empty()) << field.key;
  }
  EXPECT_TRUE(bodies[1]["properties"].contains("position"));
  EXPECT_FALSE(bodies[1]["properties"].contains("center_of_mass"));
}

TEST(Schema, HasTheFieldsOfABodyFromShapes) {
  const auto schema = resolved_schema(json_schema());
  const auto& bodies = schema["else"]["properties"]["bodies"]["additionalProperties"]["oneOf"];
  const auto expect_fields = [](const nlohmann::json& type, std::span<const Field> fields) {
    for (const Field& field : fields) {
      EXPECT_TRUE(type["properties"].contains(std::string(field.key))) << field.key;
      const bool is_required = field.presence == Presence::required;
      const auto& required = type["required"];
      EXPECT_EQ(std::find(required.begin(), required.end(), std::string(field.key)) != required.end(), is_required)
          << field.key;
    }
  };
  const std::size_t count = shape_words().size();
  const auto& parts = bodies[2 + count]["properties"];
  EXPECT_EQ(parts["inertia"]["const"], "from_parts");
  for (std::size_t i = 0; i < count; ++i) {
    const ShapeWord& word = shape_words()[i];
    SCOPED_TRACE(word.name);
    const auto& body = bodies[2 + i];
    EXPECT_EQ(body["properties"]["inertia"]["const"], "from_shape");
    EXPECT_EQ(body["properties"]["shape"]["const"], std::string(word.name));
    EXPECT_TRUE(body["properties"].contains("position"));
    EXPECT_FALSE(body["properties"].contains("center_of_mass"));
    expect_fields(body, word.body_fields);
    expect_fields(parts["parts"]["items"]["oneOf"][i], word.part_fields);
  }
}

TEST(Schema, HasTheKeysThatTheLoaderResolves) {
  const auto schema = resolved_schema(json_schema());
  for (const std::string_view key : language_keys()) {
    EXPECT_FALSE(schema["properties"][std::string(key)]["description"].get<std::string>().empty()) << key;
  }
  const auto& bodies = schema["else"]["properties"]["bodies"]["additionalProperties"]["oneOf"];
  EXPECT_TRUE(bodies[0]["properties"].contains("points"));
  for (const std::string_view section : element_sections()) {
    const auto& types = schema["else"]["properties"][std::string(section)]["additionalProperties"]["oneOf"];
    EXPECT_EQ(types.back()["required"][0], "use") << section;
  }
  for (const auto& joint : schema["else"]["properties"]["joints"]["additionalProperties"]["oneOf"]) {
    if (joint["properties"].contains("use") || joint["properties"]["type"]["const"] != "revolute") continue;
    EXPECT_TRUE(joint["properties"].contains("frame1"));
    EXPECT_EQ(joint["properties"]["point1"]["anyOf"].size(), 2u);
  }
}

// an overlay sets one key of an element of the included scene
TEST(Schema, WithAnIncludeNoKeyIsRequiredAndNoneIsUnknown) {
  const auto schema = resolved_schema(json_schema());
  for (const ElementTable& table : element_tables()) {
    const auto& forms = schema["then"]["properties"][std::string(table.section)]["additionalProperties"]["anyOf"];
    const auto& whole = schema["else"]["properties"][std::string(table.section)]["additionalProperties"]["oneOf"];
    ASSERT_EQ(forms.size(), whole.size()) << table.section;
    for (std::size_t i = 0; i + 1 < forms.size(); ++i) {
      EXPECT_FALSE(forms[i].contains("required") || forms[i].contains("oneOf")) << table.section << i;
      EXPECT_FALSE(forms[i]["additionalProperties"].get<bool>()) << table.section << i;
      EXPECT_EQ(forms[i]["properties"], whole[i]["properties"]) << table.section << i;
    }
    EXPECT_EQ(forms.back()["required"][0], "use") << table.section;
  }
  for (const char* const form : {"then", "else"}) {
    const auto& ground = schema[form]["properties"]["bodies"]["properties"]["Ground"];
    EXPECT_EQ(ground["properties"].size(), 1u) << form;
    EXPECT_TRUE(ground["properties"].contains("points")) << form;
  }
}

TEST(Schema, HoldsEachFormOfAnElementOnce) {
  const auto schema = nlohmann::json::parse(json_schema());
  for (const std::string_view section : element_sections()) {
    for (const char* const form : {"then", "else"}) {
      const auto& elements = schema[form]["properties"][std::string(section)]["additionalProperties"];
      for (const auto& type : elements[elements.contains("oneOf") ? "oneOf" : "anyOf"]) {
        EXPECT_TRUE(type.contains("$ref") && !type.contains("properties")) << section << " " << type.dump();
      }
    }
  }
  EXPECT_EQ(schema["$defs"]["bodies.rigid.from_shape.box"]["properties"]["shape"]["const"], "box");
}

TEST(Schema, StatesTheChoiceThatReadsAField) {
  const auto schema = nlohmann::json::parse(json_schema());
  const std::string text = schema["properties"]["session"]["properties"]["overrun"]["description"].get<std::string>();
  EXPECT_NE(text.find("; read with pace: real"), std::string::npos) << text;
}

TEST(Schema, EveryFieldHasADocLine) {
  for (const ElementTable& table : element_tables()) {
    for (const Field& field : table.fields) EXPECT_FALSE(field.doc.empty()) << table.section << " " << field.key;
    for (const ListTable& list : table.lists) {
      for (const Field& field : list.fields) EXPECT_FALSE(field.doc.empty()) << list.key << " " << field.key;
    }
  }
}

TEST(FormatDocument, IsCurrent) {
  const std::string document = read_file(SLEWRING_SOURCE_DIR "/docs/scene-format.md");
  EXPECT_EQ(with_field_reference(document), document)
      << "run `scene_format docs/scene-format.md` (target scene_format) and commit the result";
}

TEST(FormatDocument, WrapsProseAt120AndKeepsCodeWhole) {
  std::size_t wrapped = 0;
  for (const std::string& document : {field_reference(), flexible_field_reference()}) {
    std::istringstream lines(document);
    std::string previous;
    for (std::string line; std::getline(lines, line); previous = line) {
      if (line.starts_with('#')) continue;
      EXPECT_LE(line.size(), 120u) << line;
      EXPECT_EQ(std::count(line.begin(), line.end(), '`') % 2, 0) << line;
      // a line is as full as its words allow; lines of an item are indented
      if (line.empty() || previous.empty() || line.starts_with("- ")) continue;
      EXPECT_EQ(line.starts_with("  "), previous.starts_with("- ") || previous.starts_with("  ")) << line;
      const std::string word = line.substr(line.find_first_not_of(' '));
      const std::size_t end = word.find(' ', word.starts_with('`') ? word.find('`', 1) : 0);
      EXPECT_GT(previous.size() + 1 + std::min(end, word.size()), 120u) << previous;
      ++wrapped;
    }
  }
  EXPECT_GT(wrapped, 10u);
}

// Keys of a section's types as the document shows them: its own items, common ones, and those of the types it names.
class ShownKeys {
 public:
  explicit ShownKeys(const std::string& section) {
    std::string document = field_reference();
    for (std::size_t i = 0; (i = document.find("\n  ", i)) != std::string::npos;) document.replace(i, 3, " ");
    const std::size_t begin = document.find("\n### " + section + "\n");
    std::istringstream lines(document.substr(begin + 1, document.find("\n### ", begin + 1) - begin));
    std::string type, sentences;
    bool is_of_type = false;
    for (std::string line; std::getline(lines, line);) {
      // lists of maps and forms of bodies, shown between types
      if (line.starts_with('`') && !line.starts_with("`type: ") && sentences.empty()) is_of_type = false;
      if (line.starts_with("`type: ")) {
        type = line.substr(7, line.find('`', 7) - 7);
        is_of_type = true;
        sentences = " ";
      }
      if (is_of_type && !sentences.empty()) {
        sentences += line + ' ';
        if (!line.empty()) continue;
        refer(type, sentences);
        sentences.clear();
      }
      if (!is_of_type || !line.starts_with("- ")) continue;
      const std::string keys = line.starts_with("- volumes: ") ? line : line.substr(0, line.find(" ("));
      add(type, keys_in(keys), "");
    }
  }

  [[nodiscard]] bool has(const std::string& type, const std::string& key) const {
    const auto found = keys_.find(type);
    return found != keys_.end() && found->second.contains(key);
  }

 private:
  static std::vector<std::string> keys_in(const std::string& text) {
    std::vector<std::string> keys;
    for (std::size_t i = text.find('`'); i != std::string::npos; i = text.find('`', i)) {
      const std::size_t end = text.find('`', i + 1);
      keys.push_back(text.substr(i + 1, end - i - 1));
      i = end + 1;
    }
    return keys;
  }
  void add(const std::string& type, const std::vector<std::string>& keys, const std::string& end) {
    for (const std::string& key : keys) keys_[type].insert(key + end);
  }
  // "All keys of `a` but `b`, in m for Pa. Common: `c`. With `_1`, `_2` behind the key, as for `a`: `d`."
  void refer(const std::string& type, const std::string& text) {
    for (std::size_t i = 0; (i = text.find(" All keys of ", i)) != std::string::npos; ++i) {
      // behind `;` are units of keys
      const std::string sentence = text.substr(i, std::min(text.find(". ", i), text.find("; ", i)) - i);
      const std::size_t without = std::min(sentence.find(" but "), sentence.size());
      std::set<std::string> keys = keys_.at(keys_in(sentence.substr(0, without)).front());
      for (const std::string& key : keys_in(sentence.substr(without))) keys.erase(key);
      keys_[type].insert(keys.begin(), keys.end());
    }
    for (const char* const begin : {" Common: ", " As for ", " With "}) {
      for (std::size_t i = 0; (i = text.find(begin, i)) != std::string::npos; ++i) {
        const std::string sentence = text.substr(i, text.find(". ", i) - i);
        const std::size_t colon = sentence.find(": ");
        std::vector<std::string> ends{""};
        if (begin == std::string_view(" With ")) ends = keys_in(sentence.substr(0, sentence.find(" behind ")));
        for (const std::string& end : ends) add(type, keys_in(sentence.substr(colon)), end);
      }
    }
  }

  std::map<std::string, std::set<std::string>> keys_;  // by type
};

TEST(FormatDocument, ShowsEveryKeyOfEveryType) {
  std::size_t count = 0;
  for (const std::string_view section : element_sections()) {
    const ShownKeys shown{std::string(section)};
    for (const ElementTable& table : element_tables()) {
      if (table.section != section || table.type.empty()) continue;
      for (const Field& field : table.fields) {
        EXPECT_TRUE(shown.has(std::string(table.type), std::string(field.key))) << table.type << " " << field.key;
        ++count;
      }
    }
  }
  EXPECT_GT(count, 900u);
}

TEST(FormatDocument, ShowsKeysThatTypesHaveAlikeOnce) {
  const std::string document = field_reference();
  const auto part = [&](const std::string& type) {
    const std::size_t begin = document.find("`type: " + type + "`");
    return document.substr(begin, document.find("\n`type: ", begin) - begin);
  };
  EXPECT_EQ(part("flow"), "`type: flow`: flow meter. All keys of `pressure`, in m3/s for Pa.\n");
  EXPECT_NE(part("counterbalance_valve").find("(1e6 Pa), `step_response`."), std::string::npos)
      << part("counterbalance_valve");
  EXPECT_NE(part("universal").find("With `_1`, `_2` behind the key, as for `revolute`: `limit_min`,"),
            std::string::npos);
  EXPECT_NE(part("spool_valve").find("- `area_pa`, `area_bt`, `area_pb`, `area_at` (0 m2, >=0, live): area of edge *,"),
            std::string::npos)
      << part("spool_valve");
  EXPECT_NE(part("can_out").find("`signals`, `nodes`, `pdos`, `objects`: as for `can_in`."), std::string::npos);
}

TEST(FormatDocument, WithoutMarkersIsNotTouched) {
  EXPECT_EQ(with_field_reference("text"), "");
}

TEST(Schema, OfFlexibleBodiesHasTheirFieldsAndShapes) {
  const auto schema = resolved_schema(flexible_json_schema());
  const auto& properties = schema.at("properties");
  for (const flex::SectionType& type : flex::section_types()) {
    const auto& shapes = properties.at("sections").at("additionalProperties").at("oneOf");
    const auto found = std::find_if(shapes.begin(), shapes.end(), [&](const auto& shape) {
      return shape.at("properties").at("shape").at("const") == type.name;
    });
    ASSERT_NE(found, shapes.end()) << type.name;
    for (const Field& field : type.fields) EXPECT_TRUE(found->at("properties").contains(field.key)) << field.key;
  }
  for (const Field& field : flex::reduction_fields()) {
    EXPECT_TRUE(properties.at("reduction").at("properties").contains(field.key)) << field.key;
    EXPECT_NE(flexible_field_reference().find(fmt::format("- `{}` (", field.key)), std::string::npos) << field.key;
  }
  EXPECT_EQ(properties.at("elements").at("items").at("required").at(0), "through");
}

}  // namespace schema_test
}  // namespace slew::scene
