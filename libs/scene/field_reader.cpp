// SPDX-License-Identifier: Apache-2.0
#include "scene/field_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "core/suggestion.h"
#include "scene/canonical.h"
#include "scene/expand.h"
#include "scene/number.h"
#include "scene/point_file.h"
#include "scene/table_file.h"

namespace slew::scene {
namespace {

// integers of a scene are counts and indices; beyond this a double does not hold every integer
constexpr double kLargestInteger = 9007199254740992.0;

Writing writing_of(const Node& node) {
  return node.is_quoted ? Writing::quoted : Writing::plain;
}

// Reads values of one field; all problems carry its path.
class ValueReader {
 public:
  ValueReader(const Field& field, void* def, const std::string& path, const ReadContext& context)
      : field_(field), def_(def), path_(path), context_(context) {}

  void read(const Node& node) {
    if (node.kind == Node::Kind::empty) {
      report_problem(node.mark, {"has no value", expected(), ""});
      return;
    }
    switch (field_.type) {
      case FieldType::number:
        if (const auto value = number(node, field_.dimension, true)) member<double>() = *value;
        break;
      case FieldType::integer:
        read_integer(node);
        break;
      case FieldType::boolean:
        read_boolean(node);
        break;
      case FieldType::text:
        if (const auto value = text(node)) member<std::string>() = *value;
        break;
      case FieldType::triple:
        read_triple(node);
        break;
      case FieldType::triples:
        read_triples(node);
        break;
      case FieldType::table:
        read_table(node);
        break;
      case FieldType::numbers:
        read_numbers(node);
        break;
      case FieldType::texts:
        read_texts(node);
        break;
      case FieldType::choice:
        read_choice(node);
        break;
    }
  }

 private:
  template <typename Value>
  Value& member() {
    return *static_cast<Value*>(field_.member(def_));
  }
  void report_problem(const Mark& mark, ValueProblem problem) { context_.report.add(mark, path_, std::move(problem)); }
  void report_kind(const Node& node) { report_problem(node.mark, {"is " + describe(node), expected(), ""}); }

  [[nodiscard]] std::string expected() const { return expected_value(field_); }

  std::optional<double> number(const Node& node, Dimension dimension, bool has_range) {
    if (node.kind != Node::Kind::scalar) {
      report_problem(node.mark, {"is " + describe(node), expected_quantity(dimension), ""});
      return std::nullopt;
    }
    if (node.origin == Node::Origin::ratio && !is_plain_number(dimension)) {
      report_problem(node.mark, {"the expression gives the number " + node.text + ", in which all units cancelled",
                                 expected_quantity(dimension), ""});
      return std::nullopt;
    }
    QuantityResult result = read_quantity(node.text, writing_of(node), dimension, context_.units);
    if (result.value) warn_of_milli(node, dimension);
    if (!result.value) {
      report_problem(node.mark, std::move(result.problem));
    } else if (has_range && !field_.range.contains(*result.value)) {
      report_problem(node.mark, {describe(node) + " is out of range", range_text(field_.range, dimension), ""});
      return std::nullopt;
    }
    // of a damping or a mass -0 is 0; a coordinate keeps its sign, as that of the same scene from its expanded text
    if (result.value && *result.value == 0 && has_range && field_.range.min >= 0) result.value = 0;
    return result.value;
  }

  // A prefix m where M is meant: no part of a machine has a pressure, force, torque or power of some thousandths, or a
  // mass of some milligrams.
  void warn_of_milli(const Node& node, Dimension dimension) {
    const std::size_t begin = node.text.find_first_not_of("0123456789.eE+- ");
    if (context_.warnings == nullptr || begin == std::string::npos) return;
    const std::string_view unit = std::string_view(node.text).substr(begin);
    constexpr std::string_view kLikelySlips[] = {"mPa", "mN", "mNm", "mN m", "mW", "mg"};
    if (std::find(std::begin(kLikelySlips), std::end(kLikelySlips), unit) == std::end(kLikelySlips)) return;
    const ValueProblem problem{
        fmt::format("'{}' is {}", node.text,
                    with_unit(read_quantity(node.text, writing_of(node), dimension, context_.units).value.value_or(0),
                              dimension)),
        fmt::format("M in the place of m, 'M{}', unless so little is meant", unit.substr(1)), ""};
    context_.warnings->push_back(context_.report.at(node.mark, path_, problem).text());
  }

  void read_integer(const Node& node) {
    const bool is_scalar = node.kind == Node::Kind::scalar && !node.is_quoted;
    const NumberText parsed = is_scalar ? split_number(node.text) : NumberText{};
    const auto value = static_cast<double>(parsed.value);
    if (is_scalar && !parsed.is_number) {
      report_problem(node.mark,
                     {parsed.problem.what, parsed.problem.expected.empty() ? expected() : parsed.problem.expected, ""});
    } else if (!is_scalar || !parsed.rest.empty() || value != std::floor(value) || std::abs(value) > kLargestInteger) {
      report_problem(node.mark,
                     {"is " + describe(node), expected() + (parsed.rest.empty() ? "" : " without unit"), ""});
    } else if (!field_.range.contains(value)) {
      report_problem(node.mark, {describe(node) + " is out of range", range_text(field_.range, Dimension::none), ""});
    } else {
      member<std::int64_t>() = static_cast<std::int64_t>(value);
    }
  }

  void read_boolean(const Node& node) {
    if (node.kind == Node::Kind::scalar && !node.is_quoted && (node.text == "true" || node.text == "false")) {
      member<bool>() = node.text == "true";
      return;
    }
    constexpr std::string_view kAmbiguous[] = {"yes", "no", "on",  "off", "y",  "n",  "Yes",
                                               "No",  "On", "Off", "YES", "NO", "ON", "OFF"};
    const bool is_ambiguous =
        std::find(std::begin(kAmbiguous), std::end(kAmbiguous), node.text) != std::end(kAmbiguous);
    report_problem(node.mark, {(is_ambiguous ? describe(node) + " is ambiguous in YAML" : "is " + describe(node)),
                               expected(), ""});
  }

  std::optional<std::string> text(const Node& node) {
    if (node.kind != Node::Kind::scalar) {
      report_kind(node);
      return std::nullopt;
    }
    // an empty text means "none" where a reference is optional
    if (node.text.empty() && field_.presence == Presence::required) {
      report_problem(node.mark, {"is empty", expected(), ""});
      return std::nullopt;
    }
    if (!field_.reference.empty() && !node.text.empty()) {
      context_.references.push_back({field_.reference, node.text, path_, node.mark});
    }
    return node.text;
  }

  void read_triple(const Node& node) { fill_triple(node, expected(), member<Triple>()); }

  // False after a problem in the list; an invalid number leaves its component unchanged.
  bool fill_triple(const Node& node, const std::string& wanted, Triple& triple) {
    if (node.kind != Node::Kind::sequence || node.items.size() != 3) {
      const bool is_list = node.kind == Node::Kind::sequence;
      report_problem(node.mark,
                     {"is " + (is_list ? fmt::format("a list of {}", node.items.size()) : describe(node)), wanted, ""});
      return false;
    }
    for (std::size_t i = 0; i < 3; ++i) {
      if (const auto value = number(node.items[i], field_.dimension, true)) triple[i] = *value;
    }
    return true;
  }

  void read_triples(const Node& node) {
    if (node.kind != Node::Kind::sequence) {
      report_kind(node);
      return;
    }
    std::vector<Triple> triples;
    for (const Node& item : node.items) {
      if (!fill_triple(item, "[x, y, z]", triples.emplace_back())) return;
    }
    member<std::vector<Triple>>() = std::move(triples);
  }

  // Points in a file beside the scene. A long table stays there, outside the scene's text.
  void read_table_file(const Node& node) {
    std::optional<TableFile> table = read_table_reference(node, path_, context_);
    if (!table) return;
    if (!table->columns.empty() && table->columns.size() != 2) {
      report_problem(node.find("columns")->value.mark,
                     {fmt::format("names {} columns", table->columns.size()), "two, of argument and value", ""});
      return;
    }
    const std::size_t problems = context_.report.size();
    const TableText opened = open_table(*table, node.mark, context_);
    if (opened.text) {
      if (auto points = read_point_file(*opened.text, table->columns, field_, context_.units, context_.report))
        member<Table>() = std::move(*points);
    }
    if (context_.report.size() > problems && opened.is_file)
      report_problem(node.mark, {"'" + table->file + "' cannot be used", "", ""});
    const bool is_long = member<Table>().size() > kMaxPointsInText || table->is_pinned;
    if (is_long && context_.report.size() == problems && context_.table_files != nullptr)
      context_.table_files->push_back(std::move(*table));
  }

  void read_table(const Node& node) {
    const bool is_file = node.kind == Node::Kind::scalar && node.text.ends_with(".csv");
    if (is_file || node.kind == Node::Kind::map) {
      read_table_file(node);
      return;
    }
    if (node.kind != Node::Kind::sequence || node.items.empty()) {
      report_kind(node);
      return;
    }
    Table table;
    bool is_sound = true;
    const Node* before = nullptr;  // argument of the point before, where that is sound
    for (const Node& point : node.items) {
      if (point.kind != Node::Kind::sequence || point.items.size() != 2) {
        const std::string what =
            point.kind == Node::Kind::sequence
                ? fmt::format("a point has {} value{}", point.items.size(), point.items.size() == 1 ? "" : "s")
                : "a point is " + describe(point);
        report_problem(point.mark, {what, "points of two values, [[argument, value], ...]", ""});
        is_sound = false;
        continue;
      }
      const auto argument = number(point.items[0], field_.dimension, false);
      const auto value = number(point.items[1], field_.value_dimension, true);
      is_sound = is_sound && argument && value;
      if (!argument || !value) continue;
      if (is_sound && !may_follow(table, *argument, field_)) {
        report_problem(point.items[0].mark, {fmt::format("{} does not lie behind {} of the point before it",
                                                         describe(point.items[0]), describe(*before)),
                                             order_text(field_), ""});
        is_sound = false;
      }
      table.push_back({*argument, *value});
      before = &point.items[0];
    }
    if (is_sound) member<Table>() = std::move(table);
  }

  void read_numbers(const Node& node) {
    if (node.kind != Node::Kind::sequence) {
      report_kind(node);
      return;
    }
    std::vector<double> values;
    for (const Node& item : node.items) values.push_back(number(item, field_.dimension, true).value_or(0));
    member<std::vector<double>>() = std::move(values);
  }

  void read_texts(const Node& node) {
    if (node.kind != Node::Kind::sequence) {
      report_kind(node);
      return;
    }
    std::vector<std::string> values;
    for (const Node& item : node.items) {
      if (item.kind != Node::Kind::scalar || item.text.empty()) {
        report_problem(item.mark, {"an entry is " + describe(item), "a text", ""});
      } else if (auto value = text(item)) {
        values.push_back(std::move(*value));
      }
    }
    member<std::vector<std::string>>() = std::move(values);
  }

  void read_choice(const Node& node) {
    if (node.kind == Node::Kind::scalar) {
      const auto found = std::find(field_.choices.begin(), field_.choices.end(), node.text);
      if (found != field_.choices.end()) {
        field_.set_choice(def_, static_cast<int>(found - field_.choices.begin()));
        return;
      }
    }
    const std::vector<std::string_view> candidates(field_.choices.begin(), field_.choices.end());
    report_problem(node.mark, {"is " + describe(node), expected(),
                               node.kind == Node::Kind::scalar ? closest(node.text, candidates) : ""});
  }

  const Field& field_;
  void* def_;
  const std::string& path_;
  const ReadContext& context_;
};

const Field* find_field(std::span<const Field> fields, std::string_view key) {
  for (const Field& field : fields) {
    if (field.key == key) return &field;
  }
  return nullptr;
}

// "oil_law: density_parabola", from the Def; "no ls_port" if it is empty.
std::string setting_text(const Field* field, std::string_view key, void* def) {
  const std::string value = field == nullptr ? "" : value_text(*field, def);
  return value.empty() || value == "[]" ? "no " + std::string(key) : fmt::format("{}: {}", key, value);
}

// faulty: keys with problems of their own, which get no further report
void check_unread(const Node& map, std::span<const Field> fields, void* def, const std::string& path,
                  std::span<const std::string_view> faulty, const ReadContext& context) {
  const auto is_faulty = [&](std::string_view key) {
    return std::find(faulty.begin(), faulty.end(), key) != faulty.end();
  };
  for (const Node::Entry& entry : map.entries) {
    const Field* const field = find_field(fields, entry.key);
    if (field == nullptr || is_faulty(entry.key)) continue;
    const auto unmet = std::find_if(field->read_by.begin(), field->read_by.end(),
                                    [&](const ReadBy& condition) { return !condition.holds(def); });
    if (unmet == field->read_by.end() || is_faulty(unmet->key)) continue;
    const Node::Entry* const choice = map.find(unmet->key);
    const std::string value_path = path + "." + entry.key;
    const ValueProblem problem{
        "nothing reads this key with " + setting_text(find_field(fields, unmet->key), unmet->key, def),
        fmt::format("{}, or no such key", unmet->what), ""};
    const bool is_left_unread =
        choice != nullptr && context.report.layer(choice->mark) > context.report.layer(entry.mark);
    const bool is_carried_along =
        unmet->otherwise == ReadBy::Otherwise::warning ||
        (unmet->otherwise == ReadBy::Otherwise::error_in_files && context.report.is_override(entry.mark));
    if (is_left_unread || is_carried_along) {
      context.warnings->push_back(context.report.at(entry.mark, value_path, problem).text());
    } else {
      context.report.add(entry.mark, value_path, problem);
    }
  }
}

}  // namespace

bool may_follow(const Table& table, double argument, const Field& field) {
  if (table.empty() || argument > table.back()[0]) return true;
  // the middle one of three points with one argument has no effect
  const bool is_second = table.size() < 2 || table[table.size() - 2][0] < argument;
  return field.has_jumps && argument == table.back()[0] && is_second;
}

std::string order_text(const Field& field) {
  return field.has_jumps ? "increasing arguments, or two points at one as a jump" : "increasing arguments";
}

std::string choice_list(std::span<const std::string_view> choices) {
  std::string all;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    if (i > 0) all += i + 1 == choices.size() ? " or " : ", ";
    all += choices[i];
  }
  return all;
}

// "bodies or shapes"
std::string plural(std::string_view words) {
  constexpr std::string_view kOr = " or ";
  if (const std::size_t other = words.find(kOr); other != std::string_view::npos) {
    return plural(words.substr(0, other)) + std::string(kOr) + plural(words.substr(other + kOr.size()));
  }
  return words == "body" ? "bodies" : std::string(words) + "s";
}

std::string expected_value(const Field& field) {
  switch (field.type) {
    case FieldType::number:
      return expected_quantity(field.dimension);
    case FieldType::integer:
      return "an integer";
    case FieldType::boolean:
      return "true or false";
    case FieldType::text:
      return field.reference.empty() ? "a text" : "the name of a " + std::string(field.reference);
    case FieldType::triple:
      return "a list of three, [x, y, z]";
    case FieldType::triples:
      return "a list of [x, y, z]";
    case FieldType::table:
      return "a list of points [argument, value]";
    case FieldType::numbers:
      return "a list of numbers";
    case FieldType::texts:
      if (field.reference.empty()) return "a list of texts";
      return "a list of names of " + plural(field.reference);
    case FieldType::choice:
      return choice_list(field.choices);
  }
  return {};
}

std::string range_text(const Range& range, Dimension dimension) {
  const bool has_min = std::isfinite(range.min);
  const bool has_max = std::isfinite(range.max);
  if (!has_min && !has_max) return {};
  const std::string min = with_unit(range.min, dimension);
  const std::string max = with_unit(range.max, dimension);
  if (has_min && has_max && !range.min_is_open && !range.max_is_open) return min + " to " + max;
  std::string text;
  if (has_min) text = (range.min_is_open ? "more than " : "at least ") + min;
  if (has_max) text += (has_min ? " and " : "") + std::string(range.max_is_open ? "less than " : "at most ") + max;
  return text;
}

void report_duplicates(const Node& map, const std::string& path, Report& report) {
  for (const Node::Duplicate& duplicate : map.duplicates) {
    report.add(duplicate.mark, path.empty() ? duplicate.key : path + "." + duplicate.key,
               {fmt::format("is there twice (first in line {})", duplicate.first.line), "one of them", ""});
  }
}

void read_value(const Node& node, const Field& field, void* def, const std::string& path, const ReadContext& context) {
  ValueReader(field, def, path, context).read(node);
}

void read_fields(const Node& map, std::span<const Field> fields, void* def, const std::string& path, const Mark& place,
                 std::span<const std::string_view> other_keys, const ReadContext& context) {
  report_duplicates(map, path, context.report);
  std::vector<std::string_view> faulty;
  for (const Node::Entry& entry : map.entries) {
    if (std::find(other_keys.begin(), other_keys.end(), entry.key) != other_keys.end()) continue;
    const std::string value_path = path + "." + entry.key;
    if (const Field* field = find_field(fields, entry.key)) {
      context.places.add(value_path, entry.value.mark);
      const std::size_t problems = context.report.size();
      read_value(entry.value, *field, def, value_path, context);
      if (context.report.size() > problems) faulty.push_back(field->key);
      continue;
    }
    std::vector<std::string_view> candidates(other_keys.begin(), other_keys.end());
    for (const Field& field : fields) candidates.push_back(field.key);
    // without a similar key the message lists all keys
    const std::string suggestion = closest(entry.key, candidates);
    const std::string expected = suggestion.empty() ? choice_list(candidates) : std::string();
    context.report.add(entry.mark, value_path, {"unknown key", expected, suggestion});
  }
  for (const Field& field : fields) {
    if (field.presence == Presence::required && map.find(field.key) == nullptr) {
      context.report.add(place, path,
                         {"the key '" + std::string(field.key) + "' is missing", expected_value(field), ""});
    }
  }
  if (context.warnings != nullptr) check_unread(map, fields, def, path, faulty, context);
}

}  // namespace slew::scene
