// SPDX-License-Identifier: Apache-2.0
#include "scene/named_points.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/suggestion.h"
#include "multibody/model/defs.h"
#include "scene/element_table.h"
#include "scene/field_reader.h"
#include "scene/names.h"
#include "scene/tree_merge.h"

namespace slew::scene {
namespace {

constexpr const char* kExpectedPoint = "[x, y, z], or {position: [x, y, z], orientation: [a, b, c]}";

Node name_node(std::string_view text, const Mark& mark) {
  Node node;
  node.kind = Node::Kind::scalar;
  node.text = text;
  node.mark = mark;
  return node;
}

const Field* find_in(std::span<const Field> fields, std::string_view key) {
  const auto found = std::find_if(fields.begin(), fields.end(), [&](const Field& field) { return field.key == key; });
  return found == fields.end() ? nullptr : &*found;
}

bool is_body_key(std::span<const Field> fields, std::string_view key) {
  const Field* field = find_in(fields, key);
  return field != nullptr && field->reference == "body";
}

// The key of the body beside a point's key; empty: there is none.
std::string body_key_of(std::span<const Field> fields, std::string_view key) {
  if (key == "points") return is_body_key(fields, "bodies") ? "bodies" : "";
  if (key.starts_with("point")) {
    const std::string body = "body" + std::string(key.substr(std::string_view("point").size()));
    if (is_body_key(fields, body)) return body;
  }
  if (key != "position") return "";
  for (const char* body : {"relative_to", "body"}) {
    if (is_body_key(fields, body)) return body;
  }
  return "";
}

// "Boom.tip"; other values are read, or refused, with their fields
bool is_name_of_point(const Node& node) {
  const std::size_t dot = node.kind == Node::Kind::scalar ? node.text.find('.') : std::string::npos;
  return dot != std::string::npos && is_word(std::string_view(node.text).substr(0, dot));
}

class Placement {
 public:
  explicit Placement(Report& report) : report_(report) {}

  void place(Node& root) {
    Node::Entry* bodies = root.find("bodies");
    if (bodies != nullptr) collect(bodies->value);
    for (const std::string_view section : element_sections()) {
      Node::Entry* entry = root.find(section);
      if (entry == nullptr) continue;
      for (Node::Entry& element : entry->value.entries) place_in(section, element);
    }
  }
  [[nodiscard]] std::vector<NamedPoint> take_points() {
    std::vector<NamedPoint> points;
    for (auto& [name, point] : points_) points.push_back(std::move(point));
    return points;
  }

 private:
  void collect(Node& bodies) {
    for (Node::Entry& body : bodies.entries) {
      const auto points = take(body.value, kPointsKey);
      if (!points) continue;
      const std::string path = fmt::format("{}.{}", body.key, kPointsKey);
      if (points->value.kind != Node::Kind::map) {
        report_.add(points->value.mark, path, {"is " + describe(points->value), "a map of points by name", ""});
        continue;
      }
      report_duplicates(points->value, path, report_);
      for (const Node::Entry& point : points->value.entries) add(body.key, point, path + "." + point.key);
    }
    // Ground is there by itself
    const auto ground = std::find_if(bodies.entries.begin(), bodies.entries.end(),
                                     [](const Node::Entry& body) { return body.key == multibody::kGroundName; });
    const bool has_points = std::any_of(points_.begin(), points_.end(), [](const auto& point) {
      return point.first.starts_with(std::string(multibody::kGroundName) + ".");
    });
    if (ground != bodies.entries.end() && has_points && ground->value.entries.empty()) bodies.entries.erase(ground);
  }

  void add(const std::string& body, const Node::Entry& entry, const std::string& path) {
    if (!is_word(entry.key)) {
      report_.add(entry.mark, path, {"is not a name", "letters, digits and _, beginning with a letter", ""});
      return;
    }
    NamedPoint point{.name = body + "." + entry.key, .body = body, .position = {}, .orientation = {}};
    if (entry.value.kind == Node::Kind::map) {
      report_duplicates(entry.value, path, report_);
      for (const Node::Entry& key : entry.value.entries) {
        if (key.key == "position") {
          point.position = key.value;
        } else if (key.key == "orientation") {
          point.orientation = key.value;
        } else {
          report_.add(key.mark, path + "." + key.key, {"unknown key", "position or orientation", ""});
        }
      }
    } else {
      point.position = entry.value;
    }
    const auto is_triple = [](const Node& node) { return node.kind == Node::Kind::sequence && node.items.size() == 3; };
    const bool has_orientation = point.orientation.kind != Node::Kind::empty;
    if (!is_triple(point.position) || (has_orientation && !is_triple(point.orientation))) {
      report_.add(entry.value.mark, path, {"is no point", kExpectedPoint, ""});
      return;
    }
    points_.emplace(body + "." + entry.key, std::move(point));
  }

  void place_in(std::string_view section, Node::Entry& element) {
    const ElementTable* table = find_element_table(section, element.value);
    if (table == nullptr || element.value.kind != Node::Kind::map) return;
    place_frames(table->fields, element);
    for (const Field& field : table->fields) {
      const bool is_list = field.type == FieldType::triples;
      if ((field.type != FieldType::triple && !is_list) || field.dimension != Dimension::length) continue;
      Node::Entry* entry = element.value.find(field.key);
      if (entry == nullptr) continue;
      const std::string path = fmt::format("{}.{}", element.key, field.key);
      const std::string body_key = body_key_of(table->fields, field.key);
      if (is_list) {
        place_list(element, *entry, body_key, path);
      } else if (is_name_of_point(entry->value)) {
        place_one(element, *entry, body_key, path);
      }
    }
  }

  void place_one(Node::Entry& element, Node::Entry& entry, const std::string& body_key, const std::string& path) {
    const NamedPoint* point = find(entry.value, body_key, path);
    if (point == nullptr) return;
    const std::string body = body_of(entry.value);
    const Mark mark = entry.value.mark;
    entry.value = point->position;
    name_body(element.value, body_key, body, mark, path);
  }

  // a list of points and of the bodies that have them
  void place_list(Node::Entry& element, Node::Entry& entry, const std::string& body_key, const std::string& path) {
    std::vector<Node> bodies;
    const Mark mark = entry.value.mark;
    for (Node& item : entry.value.items) {
      if (!is_name_of_point(item)) continue;
      const NamedPoint* point = find(item, body_key, path);
      if (point == nullptr) return;
      bodies.push_back(name_node(body_of(item), item.mark));
      item = point->position;
    }
    if (bodies.empty()) return;
    const Node::Entry* given = element.value.find(body_key);
    if (bodies.size() != entry.value.items.size()) {
      if (given == nullptr) {
        report_.add(mark, path,
                    {"some points are named and others are lists", "names alone, or bodies beside the points", ""});
      }
      return;
    }
    if (given == nullptr) {
      Node list;
      list.kind = Node::Kind::sequence;
      list.mark = mark;
      list.items = std::move(bodies);
      element.value.entries.push_back({body_key, mark, std::move(list)});
      return;
    }
    const auto& items = given->value.items;
    for (std::size_t i = 0; i < std::min(items.size(), bodies.size()); ++i) {
      if (items[i].text != bodies[i].text) refuse_body(items[i].mark, bodies[i].text, items[i].text, path);
    }
  }

  // frame1: body1, point1 and orientation1
  void place_frames(std::span<const Field> fields, Node::Entry& element) {
    for (const char* number : {"", "1", "2"}) {
      const std::string suffix = number, key = std::string(kFrameKey) + suffix;
      const bool has_frame = is_body_key(fields, "body" + suffix) && find_in(fields, "point" + suffix) != nullptr &&
                             find_in(fields, "orientation" + suffix) != nullptr;
      if (!has_frame || find_in(fields, key) != nullptr) continue;
      const auto frame = take(element.value, key);
      if (!frame) continue;
      const std::string path = element.key + "." + key;
      bool is_given = false;
      for (const std::string& other : {"point" + suffix, "orientation" + suffix}) {
        if (element.value.find(other) == nullptr) continue;
        report_.add(frame->mark, path, {"'" + other + "' is given as well", "one of them", ""});
        is_given = true;
      }
      const NamedPoint* point = is_given ? nullptr : find(frame->value, "body" + suffix, path);
      if (point == nullptr) continue;
      element.value.entries.push_back({"point" + suffix, frame->mark, point->position});
      if (point->orientation.kind != Node::Kind::empty) {
        element.value.entries.push_back({"orientation" + suffix, frame->mark, point->orientation});
      }
      name_body(element.value, "body" + suffix, body_of(frame->value), frame->value.mark, path);
    }
  }

  static std::string body_of(const Node& name) { return name.text.substr(0, name.text.find('.')); }

  // null after a reported problem
  const NamedPoint* find(const Node& name, const std::string& body_key, const std::string& path) {
    if (!is_name_of_point(name) || body_key.empty()) {
      const char* expected = body_key.empty() ? "a list of three, [x, y, z]" : "the name of a point, such as Boom.tip";
      report_.add(name.mark, path, {"is " + describe(name), expected, ""});
      return nullptr;
    }
    const auto found = points_.find(name.text);
    if (found != points_.end()) return &found->second;
    std::vector<std::string_view> names;
    for (const auto& [known, point] : points_) names.push_back(known);
    report_.add(name.mark, path, {"there is no point '" + name.text + "'", "", closest(name.text, names)});
    return nullptr;
  }

  void name_body(Node& element, const std::string& key, const std::string& body, const Mark& mark,
                 const std::string& path) {
    const Node::Entry* given = element.find(key);
    if (given == nullptr) {
      element.entries.push_back({key, mark, name_node(body, mark)});
    } else if (given->value.text != body) {
      refuse_body(mark, body, given->value.text, path);
    }
  }

  void refuse_body(const Mark& mark, const std::string& of_point, const std::string& given, const std::string& path) {
    report_.add(mark, path,
                {fmt::format("the point is on '{}', the body beside it is '{}'", of_point, given),
                 "a point of that body, or no body", ""});
  }

  Report& report_;
  std::map<std::string, NamedPoint, std::less<>> points_;
};

}  // namespace

std::vector<NamedPoint> place_named_points(Node& root, Report& report) {
  Placement placement(report);
  placement.place(root);
  return placement.take_points();
}

}  // namespace slew::scene
