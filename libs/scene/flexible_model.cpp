// SPDX-License-Identifier: Apache-2.0
#include "scene/flexible_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <optional>
#include <utility>

#include "core/suggestion.h"
#include "flex/field_tables.h"
#include "flex/input_error.h"
#include "scene/expand.h"
#include "scene/field_reader.h"
#include "scene/place_map.h"
#include "scene/setting.h"
#include "scene/source.h"
#include "scene/units.h"
#include "scene/yaml_tree.h"

namespace slew::scene {
namespace {

constexpr std::string_view kParts[] = {"materials", "sections", "line", "nodes", "elements", "matrices", "reduction"};

// every key that may stand at the root
std::vector<std::string_view> root_keys() {
  std::vector<std::string_view> keys;
  for (const Field& field : flex::body_fields()) keys.push_back(field.key);
  keys.insert(keys.end(), std::begin(kParts), std::end(kParts));
  return keys;
}

class DescriptionReader {
 public:
  DescriptionReader(const Node& root, LoadContext load_context, Report& report)
      : root_(root), load_context_(std::move(load_context)), report_(report) {}

  // The result is valid only with a clean report.
  FlexibleModel read() {
    read_root();
    read_materials();
    read_sections();
    read_part("line", flex::line_fields(), &def_.line);
    read_nodes();
    read_elements();
    read_matrices();
    read_part("reduction", flex::reduction_fields(), &def_.reduction);
    resolve();
    FlexibleModel out;
    if (report_.is_clean()) add_problems(flex::check_flexible_body(def_));
    if (report_.is_clean()) build(out);
    if (report_.is_clean()) add_problems(flex::check_reduction(def_, out.model));
    if (report_.is_clean()) out.reduction = flex::reduction_of(def_);
    out.def = std::move(def_);
    return out;
  }

 private:
  void add_problems(const Problems& problems) {
    for (const Problem& problem : problems) {
      report_.add(places_.nearest(problem.path, root_.mark), problem.path,
                  {problem.what, problem.expected, problem.suggestion});
    }
  }

  // single values, and unknown keys
  void read_root() {
    report_duplicates(root_, "", report_);
    const std::span<const Field> fields = flex::body_fields();
    for (const Node::Entry& entry : root_.entries) {
      places_.add(entry.key, entry.value.mark);
      const auto field =
          std::find_if(fields.begin(), fields.end(), [&](const Field& row) { return row.key == entry.key; });
      if (field != fields.end()) {
        read_value(entry.value, *field, &def_, entry.key, context_);
      } else if (std::find(std::begin(kParts), std::end(kParts), entry.key) == std::end(kParts)) {
        report_.add(entry.mark, entry.key, {"unknown key", "", closest(entry.key, root_keys())});
      }
    }
    for (const Field& field : fields) {
      if (field.presence == Presence::required && root_.find(field.key) == nullptr)
        report_.add(root_.mark, "", {fmt::format("the key '{}' is missing", field.key), expected_value(field), ""});
    }
  }

  bool is_kind(const Node& node, Node::Kind kind, const std::string& path, const char* expected) {
    if (node.kind == kind) return true;
    report_.add(node.mark, path, {"is " + describe(node), expected, ""});
    return false;
  }

  // The part's value if it is present and of the kind.
  const Node* part(std::string_view key, Node::Kind kind, const char* expected) {
    const Node::Entry* entry = root_.find(key);
    return entry != nullptr && is_kind(entry->value, kind, entry->key, expected) ? &entry->value : nullptr;
  }

  void read_part(std::string_view key, std::span<const Field> fields, void* def) {
    const Node* map = part(key, Node::Kind::map, "a map");
    if (map != nullptr) read_fields(*map, fields, def, std::string(key), root_.find(key)->mark, {}, context_);
  }

  // a '.' would split the path of an override
  void check_name(const Node::Entry& named, const std::string& path) {
    places_.add(path, named.mark);
    const bool is_word = std::all_of(named.key.begin(), named.key.end(), [](char c) {
      return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    });
    if (!is_word) report_.add(named.mark, path, {"is not a name", "letters, digits, _ and -", ""});
  }

  void read_materials() {
    const Node* map = part("materials", Node::Kind::map, "a map of materials by name");
    if (map == nullptr) return;
    report_duplicates(*map, "materials", report_);
    for (const Node::Entry& entry : map->entries) {
      const std::string path = "materials." + entry.key;
      check_name(entry, path);
      flex::NamedMaterial& def = def_.materials.emplace_back();
      def.name = entry.key;
      if (is_kind(entry.value, Node::Kind::map, path, "a map"))
        read_fields(entry.value, flex::material_fields(), &def, path, entry.mark, {}, context_);
    }
  }

  void read_sections() {
    const Node* map = part("sections", Node::Kind::map, "a map of sections by name");
    if (map == nullptr) return;
    report_duplicates(*map, "sections", report_);
    for (const Node::Entry& entry : map->entries) {
      const std::string path = "sections." + entry.key;
      check_name(entry, path);
      flex::NamedSection& def = def_.sections.emplace_back();
      def.name = entry.key;
      if (is_kind(entry.value, Node::Kind::map, path, "a map")) read_section(entry, path, def);
    }
  }

  void read_section(const Node::Entry& entry, const std::string& path, flex::NamedSection& def) {
    const flex::SectionType* type = shape_of(entry, path);
    if (type == nullptr) return;
    def.section.shape = type->shape;
    static constexpr std::string_view kKeys[] = {"shape", "stress_points"};
    const bool has_points = type->shape == flex::SectionShape::given;
    read_fields(entry.value, type->fields, &def, path, entry.mark, std::span(kKeys).first(has_points ? 2 : 1),
                context_);
    const Node::Entry* points = entry.value.find("stress_points");
    if (!has_points || points == nullptr) return;
    const std::string list = path + ".stress_points";
    if (!is_kind(points->value, Node::Kind::sequence, list, "a list of points {y, z, torsion_modulus}")) return;
    for (std::size_t i = 0; i < points->value.items.size(); ++i) {
      const Node& point = points->value.items[i];
      const std::string at = fmt::format("{}[{}]", list, i);
      if (is_kind(point, Node::Kind::map, at, "a map"))
        read_fields(point, flex::stress_point_fields(), &def.stress_points.emplace_back(), at, point.mark, {},
                    context_);
    }
  }

  // Null after a reported problem.
  const flex::SectionType* shape_of(const Node::Entry& entry, const std::string& path) {
    std::vector<std::string_view> names;
    const Node::Entry* shape = entry.value.find("shape");
    const bool is_word = shape != nullptr && shape->value.kind == Node::Kind::scalar;
    for (const flex::SectionType& type : flex::section_types()) {
      if (is_word && shape->value.text == type.name) return &type;
      names.push_back(type.name);
    }
    const std::string list = fmt::format("{}", fmt::join(names, ", "));
    if (shape == nullptr) {
      report_.add(entry.mark, path, {"the key 'shape' is missing", list, ""});
    } else {
      report_.add(shape->value.mark, path + ".shape",
                  {"is " + describe(shape->value), list, is_word ? closest(shape->value.text, names) : ""});
    }
    return nullptr;
  }

  void read_nodes() {
    const Node* map = part("nodes", Node::Kind::map, "a map of places by the nodes' numbers");
    if (map == nullptr) return;
    report_duplicates(*map, "nodes", report_);
    for (const Node::Entry& entry : map->entries) {
      const std::string path = "nodes." + entry.key;
      places_.add(path, entry.value.mark);
      flex::BeamNodeDef node;
      const char* end = entry.key.data() + entry.key.size();
      const auto [stop, error] = std::from_chars(entry.key.data(), end, node.id);
      if (error != std::errc() || stop != end || node.id < 0)
        report_.add(entry.mark, path, {"is not a node's number", "a whole number of at least 0", ""});
      read_value(entry.value, flex::node_field(), &node, path, context_);
      def_.nodes.push_back(node);
    }
  }

  void read_elements() {
    const Node* list = part("elements", Node::Kind::sequence, "a list of elements");
    if (list == nullptr) return;
    for (std::size_t i = 0; i < list->items.size(); ++i) {
      const Node& element = list->items[i];
      const std::string path = fmt::format("elements[{}]", i);
      places_.add(path, element.mark);
      flex::ElementChainDef& def = def_.elements.emplace_back();
      if (is_kind(element, Node::Kind::map, path, "a map such as {through: [1, 2]}"))
        read_fields(element, flex::element_fields(), &def, path, element.mark, {}, context_);
    }
  }

  void read_matrices() {
    read_part("matrices", flex::matrix_file_fields(), &def_.matrices);
    const Node::Entry* matrices = root_.find("matrices");
    if (matrices == nullptr) return;
    if (!load_context_.has_folder)
      report_.add(matrices->mark, "matrices", {"a description without a folder cannot name files", "", ""});
    for (const Node::Entry& entry : matrices->value.entries) {
      if (auto refusal = load_context_.refusal_of(entry.value.text))
        report_.add(entry.value.mark, "matrices." + entry.key, std::move(*refusal));
    }
    const auto keys = flex::beam_keys();
    for (const Node::Entry& entry : root_.entries) {
      if (std::find(keys.begin(), keys.end(), entry.key) != keys.end())
        report_.add(entry.mark, entry.key, {"has no effect beside matrices", "either a beam or matrices", ""});
    }
  }

  // names of materials and sections
  void resolve() {
    std::vector<std::string_view> materials, sections;
    for (const flex::NamedMaterial& named : def_.materials) materials.push_back(named.name);
    for (const flex::NamedSection& named : def_.sections) sections.push_back(named.name);
    for (const Reference& reference : references_) {
      const auto& names = reference.kind == "material" ? materials : sections;
      if (std::find(names.begin(), names.end(), reference.name) == names.end())
        report_.add(reference.mark, reference.path,
                    {fmt::format("no {} '{}'", reference.kind, reference.name), "", closest(reference.name, names)});
    }
  }

  void build(FlexibleModel& out) {
    try {
      out.model = flex::model_of(def_, load_context_.folder);
    } catch (const flex::InputError& error) {
      report_.add(places_.nearest("matrices", root_.mark), "matrices", {error.what(), "", ""});
    }
  }

  const Node& root_;
  LoadContext load_context_;
  Report& report_;
  flex::FlexibleBodyDef def_;
  PlaceMap places_;
  std::vector<Reference> references_;
  UnitSystem units_;
  ReadContext context_{units_, report_, places_, references_, &load_context_};
};

constexpr const char* kModelSetting = "key=value, such as 'line.nodes=40' or 'materials.Steel.youngs_modulus=20GPa'";

// Sets the value at the path; creates a missing part at the root.
void apply_setting(Node& root, const std::string& text, Report& report) {
  std::optional<Setting> setting = parse_setting(text, kModelSetting, report);
  if (!setting) return;
  Node* map = &root;
  std::size_t at = 0;
  for (std::size_t dot = setting->path.find('.'); dot != std::string::npos; dot = setting->path.find('.', at)) {
    const std::string key = setting->path.substr(at, dot - at);
    const bool is_part = map == &root && std::find(std::begin(kParts), std::end(kParts), key) != std::end(kParts);
    if (map->find(key) == nullptr && is_part) {
      Node made;
      made.kind = Node::Kind::map;
      made.mark = setting->mark;
      set_key(root, key, std::move(made), setting->mark);
    }
    Node::Entry* entry = map->find(key);
    if (entry == nullptr || entry->value.kind != Node::Kind::map) {
      std::vector<std::string_view> keys;
      if (map == &root) keys = root_keys();
      for (const Node::Entry& other : map->entries) keys.push_back(other.key);
      const std::string what = entry == nullptr ? "no '" + key + "'" : "'" + key + "' holds no keys";
      report.add(setting->mark, "", {what, "", entry == nullptr ? closest(key, keys) : ""});
      return;
    }
    map = &entry->value;
    at = dot + 1;
  }
  set_key(*map, setting->path.substr(at), std::move(setting->value), setting->mark);
}

FlexibleModel read_tree(Node root, LoadContext load_context, const Overrides& overrides, Report& report) {
  for (const std::string& text : overrides) apply_setting(root, text, report);
  FlexibleModel model = DescriptionReader(root, std::move(load_context), report).read();
  if (!report.is_clean()) report.fail(kMaxReportedProblems);
  return model;
}

}  // namespace

FlexibleModel load_flexible_file(const std::string& path, const Overrides& overrides) {
  return guarded(path, [&] {
    Report report;
    std::optional<Node> root = read_with_includes(path, report);
    if (!root) report.fail(kMaxReportedProblems);
    LoadContext load_context{true, std::filesystem::path(path).parent_path().string()};
    return read_tree(std::move(*root), std::move(load_context), overrides, report);
  });
}

FlexibleModel load_flexible_text(std::string text, const std::string& name, const Overrides& overrides) {
  return guarded(name, [&] {
    Report report;
    const std::optional<SourceText> source = check_source(std::move(text), report.add_source(name), report);
    std::optional<Node> root = source ? parse_yaml(*source, report) : std::nullopt;
    if (!root) report.fail(kMaxReportedProblems);
    return read_tree(std::move(*root), {}, overrides, report);
  });
}

}  // namespace slew::scene
