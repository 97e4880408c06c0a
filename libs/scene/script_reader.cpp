// SPDX-License-Identifier: Apache-2.0
#include "scene/script_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/suggestion.h"
#include "lcm_log/input_table.h"
#include "scene/csv_table.h"
#include "scene/parameters.h"
#include "scene/script.h"
#include "scene/source.h"
#include "scene/table_file.h"

namespace slew::scene {
namespace {

constexpr std::string_view kScriptKeys[] = {"file", "columns", "sha256", "inputs", "parameters"};
constexpr std::string_view kRawSuffix = ".raw";  // suffix of an input's variable in `slewring export`
constexpr std::string_view kChangeKeys[] = {"value"};

// Interpolation of a record: values no further apart than a step are held until the next, as ticks held them. Values
// further apart are joined by a line.
Table held_as_ticks(const Table& points, SimDuration step) {
  Table held;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (i > 0) {
      const bool is_next_tick = duration_of_seconds(points[i][0] - points[i - 1][0]).ns <= step.ns;
      const bool is_jump =
          points[i][0] == points[i - 1][0] || (i + 1 < points.size() && points[i + 1][0] == points[i][0]);
      if (is_next_tick && !is_jump && points[i][1] != points[i - 1][1])
        held.push_back({points[i][0], points[i - 1][1]});
    }
    held.push_back(points[i]);
  }
  return held;
}

class ScriptReader {
 public:
  ScriptReader(const LoadContext& load_context, const NameTable& names, Scene& scene, const ReadContext& context)
      : load_context_(load_context), names_(names), scene_(scene), context_(context) {}

  void read(const Node& section, const Mark& place) {
    if (section.kind != Node::Kind::map) {
      report_problem(section.mark, "script",
                     {"is " + describe(section), "a map with the keys inputs, parameters or file", ""});
      return;
    }
    read_fields(section, script_fields(), &scene_.script, "script", place, kScriptKeys, context_);
    const Node::Entry* file = section.find("file");
    const Node::Entry* inputs = section.find("inputs");
    const Node::Entry* changes = section.find("parameters");
    if (file != nullptr && inputs != nullptr) {
      report_problem(inputs->mark, "script.inputs", {"the script has a file and inputs of its own", "one of them", ""});
    } else if (file != nullptr) {
      read_file(section, file->value);
    } else {
      for (const char* key : {"columns", "sha256"}) {
        if (const Node::Entry* entry = section.find(key))
          report_problem(entry->mark, std::string("script.") + key,
                         {"the key has no effect without the key 'file'", "a file, or no such key", ""});
      }
    }
    if (inputs != nullptr) read_tracks(inputs->value);
    if (changes != nullptr) read_changes(changes->value);
    finish(section.mark);
  }

 private:
  void report_problem(const Mark& mark, std::string path, ValueProblem problem) {
    context_.report.add(mark, std::move(path), std::move(problem));
  }

  void add_warning(const Mark& mark, const std::string& path, ValueProblem problem) {
    scene_.warnings.push_back(context_.report.at(mark, path, std::move(problem)).text());
  }

  void read_tracks(const Node& node) {
    if (node.kind != Node::Kind::map) {
      report_problem(node.mark, "script.inputs",
                     {"is " + describe(node), "a map from inputs to points [time, value]", ""});
      return;
    }
    report_duplicates(node, "script.inputs", context_.report);
    for (const Node::Entry& entry : node.entries) {
      if (!is_input(entry.key, entry.mark, "script.inputs." + entry.key)) continue;
      const std::string path = "script.inputs." + entry.key;
      ScriptTrack track{.input = entry.key, .points = {}};
      read_value(entry.value, script_track_fields().front(), &track, path, context_);
      const bool is_in_file = !scene_.table_files.empty() && scene_.table_files.back().path == path;
      if (!track.points.empty() && track.points.front()[0] > 0 && track.points.front()[1] != 0) {
        const auto [time, first] = track.points.front();
        add_warning(entry.value.mark, path,
                    {fmt::format("its first point is at {} s: {} holds from 0 s on", time, first),
                     "[0 s, 0] in front of it, if the input is neutral until then", ""});
      }
      if (!track.points.empty() || is_in_file) add_track(std::move(track), entry.value.mark);
    }
  }

  bool is_input(const std::string& name, const Mark& mark, const std::string& path) {
    if (names_.kind_of(name) == "input") return true;
    const std::string suggestion = names_.closest_of(name, "input");
    const std::string_view kind = names_.kind_of(name);
    std::string inputs;
    for (const InputDef& input : scene_.inputs) inputs += (inputs.empty() ? "" : ", ") + input.name;
    std::string expected = inputs.empty() ? "a scene with inputs" : "an input of the scene: " + inputs;
    report_problem(
        mark, path,
        {kind.empty() ? fmt::format("no input '{}'", name) : fmt::format("'{}' is {}", name, with_article(kind)),
         suggestion.empty() ? std::move(expected) : std::string(), suggestion});
    return false;
  }

  void add_track(ScriptTrack track, const Mark& mark) {
    const auto input = std::find_if(scene_.inputs.begin(), scene_.inputs.end(),
                                    [&](const InputDef& def) { return def.name == track.input; });
    if (input != scene_.inputs.end() && input->type == InputType::digital) {
      for (const auto& point : track.points) {
        if (point[1] == 0 || point[1] == 1) continue;
        report_problem(mark, "script.inputs." + track.input,
                       {fmt::format("{} is no value of a digital input", point[1]), "0 or 1", ""});
        return;
      }
    }
    scene_.script.tracks.push_back(std::move(track));
  }

  // The file, its columns and its content: keys for a .csv file beside those of every script.
  void read_file(const Node& section, const Node& name) {
    const bool is_text = name.kind == Node::Kind::scalar && !name.text.empty();
    const bool is_yaml = is_text && (name.text.ends_with(".yaml") || name.text.ends_with(".yml"));
    const std::string_view ending = is_text && name.text.ends_with(".lcm") ? ".lcm" : ".csv";
    if (!is_text || (!is_yaml && !name.text.ends_with(ending))) {
      report_problem(name.mark, "script.file", {"is " + describe(name), "the name of a .csv, .lcm or .yaml file", ""});
      return;
    }
    // the text of a session gives the content
    if (!load_context_.has_folder && section.find("sha256") == nullptr) {
      report_problem(name.mark, "script.file",
                     {"a scene without a folder cannot name a file", "the points themselves under inputs", ""});
      return;
    }
    Node reference;
    reference.kind = Node::Kind::map;
    reference.entries.push_back(*section.find("file"));
    for (const char* key : {"columns", "sha256"}) {
      const Node::Entry* entry = section.find(key);
      if (entry == nullptr) continue;
      if (is_yaml)
        report_problem(entry->mark, std::string("script.") + key,
                       {"the key has no effect on a .yaml file", "a .csv file, or no such key", ""});
      reference.entries.push_back(*entry);
    }
    const std::size_t problems = context_.report.size();
    if (is_yaml) {
      read_yaml_file(name);
    } else if (auto file = read_table_reference(reference, "script", context_, ending)) {
      read_csv_file(name, std::move(*file));
    }
    if (context_.report.size() > problems && is_opened_)
      report_problem(name.mark, "script.file", {describe(name) + " cannot be used", "", ""});
  }

  void read_yaml_file(const Node& name) {
    if (auto refusal = load_context_.refusal_of(name.text)) {
      report_problem(name.mark, "script.file", std::move(*refusal));
      return;
    }
    is_opened_ = true;
    const std::string path = load_context_.path_of(name.text);
    const auto text = read_source(path, context_.report.add_source(path), context_.report);
    if (text) read_yaml(*text);
  }

  // Long tracks stay in the file; short ones become part of the scene's text.
  void read_csv_file(const Node& name, TableFile file) {
    if (file.is_pinned && !load_context_.has_folder && !load_context_.reads_script) {
      scene_.script.file = std::move(file);
      return;
    }
    const std::size_t problems = context_.report.size();
    file.path = "script.file";
    const TableText opened = open_table(file, name.mark, context_);
    is_opened_ = opened.is_file;
    if (opened.text) read_csv(*opened.text, file);
    if (opened.log) read_log(*opened.log, opened.source, file);
    const auto& tracks = scene_.script.tracks;
    const bool is_long = std::any_of(tracks.begin(), tracks.end(),
                                     [](const ScriptTrack& track) { return track.points.size() > kMaxPointsInText; });
    if (context_.report.size() == problems && (is_long || file.is_pinned)) scene_.script.file = std::move(file);
  }

  void read_log(const std::string& log, int source, TableFile& file) {
    std::vector<lcm_log::TableChannel> channels;
    for (const InputDef& input : scene_.inputs) channels.push_back({input.name, input.type == InputType::digital});
    const SimDuration neutral_after = duration_of_seconds(scene_.session.controller_timeout);
    lcm_log::InputTable table = lcm_log::input_table(log, channels, scene_.session.step_duration(), neutral_after);
    if (!table.problem.empty()) {
      context_.report.add({source, 0, 0}, "", {std::move(table.problem), std::move(table.expected), ""});
      return;
    }
    for (const std::string& warning : table.warnings) scene_.warnings.push_back("script.file: " + warning);
    const auto text = check_source(std::move(table.csv), source, context_.report, kMaxTableBytes);
    if (text) read_csv(*text, file);
  }

  void read_csv(const SourceText& text, TableFile& file) {
    const std::size_t problems = context_.report.size();
    TimeTable table(text, context_.units, context_.report);
    if (!table.read_head()) return;
    check_columns(table.head(), file);
    std::vector<std::string> passed_over;
    const std::vector<std::size_t> taken = columns_of(table, file, passed_over);
    if (context_.report.size() == problems && taken.empty()) {
      context_.report.add({text.source, 1, 1}, "",
                          {"no column is named after an input of the scene", "a column for an input", ""});
    }
    if (context_.report.size() > problems) return;
    add_columns(table, taken, file);
    if (passed_over.empty()) return;
    const bool is_one = passed_over.size() == 1;
    scene_.warnings.push_back(fmt::format("script.file: {} column{} of '{}' {} no input and {} not taken ({}{})",
                                          passed_over.size(), is_one ? "" : "s", file.file, is_one ? "is" : "are",
                                          is_one ? "was" : "were", passed_over.front(), is_one ? "" : ", ..."));
  }

  // Uses columns named after an input, `Stick` or `Stick.raw`; skips other variables of an export.
  std::vector<std::size_t> columns_of(const TimeTable& table, const TableFile& file,
                                      std::vector<std::string>& passed_over) {
    std::vector<std::size_t> taken;
    for (std::size_t i = 0; i < table.head().size(); ++i) {
      const std::string& name = table.head()[i].name;
      const bool is_listed = std::find(file.columns.begin(), file.columns.end(), name) != file.columns.end();
      if (table.is_time(i) || (!file.columns.empty() && !is_listed)) continue;
      const bool is_variable = name.find('.') != std::string::npos && !name.ends_with(kRawSuffix);
      if (is_variable && !is_listed) {
        passed_over.push_back(name);
      } else if (is_input(input_of(name), table.head()[i].mark, "")) {
        taken.push_back(i);
      }
    }
    return taken;
  }

  [[nodiscard]] std::string input_of(const std::string& column) const {
    return column.ends_with(kRawSuffix) ? column.substr(0, column.size() - kRawSuffix.size()) : column;
  }

  void check_columns(const std::vector<ColumnHead>& head, const TableFile& file) {
    for (const std::string& wanted : file.columns) {
      std::vector<std::string_view> names;
      for (const ColumnHead& column : head) names.push_back(column.name);
      if (std::find(names.begin(), names.end(), wanted) == names.end())
        context_.report.add(head.front().mark, "", {"no column '" + wanted + "'", "", closest(wanted, names)});
    }
  }

  void add_columns(TimeTable& table, const std::vector<std::size_t>& taken, TableFile& file) {
    std::string late;
    double begin = 0;
    file.columns.clear();
    for (CsvColumn& column : table.read(taken)) {
      const ColumnHead& head = table.head()[column.index];
      const std::string input = input_of(head.name);
      if (column.begin > 0 && column.points.front() != std::array{column.begin, 0.0}) {
        begin = late.empty() ? column.begin : std::min(begin, column.begin);
        late += (late.empty() ? "" : ", ") + input;
      }
      const auto& tracks = scene_.script.tracks;
      if (std::any_of(tracks.begin(), tracks.end(), [&](const ScriptTrack& t) { return t.input == input; }))
        context_.report.add(head.mark, "", {"two columns are for '" + input + "'", "one of them", ""});
      file.columns.push_back(head.name);
      if (head.name.ends_with(kRawSuffix)) column.points = held_as_ticks(column.points, scene_.session.step_duration());
      add_track({.input = input, .points = std::move(column.points)}, head.mark);
    }
    if (late.empty()) return;
    scene_.warnings.push_back(fmt::format("script.file: '{}' begins at {} s; {} neutral before", file.file, begin,
                                          late + (late.find(',') == std::string::npos ? " is" : " are")));
  }

  void read_yaml(const SourceText& text) {
    const std::optional<Node> root = parse_yaml(text, context_.report);
    if (!root) return;
    if (const Node::Entry* nested = root->find("file")) {
      report_problem(nested->mark, "script.file", {"a script file names another", "inputs and parameters", ""});
      return;
    }
    read(*root, root->mark);
  }

  void read_changes(const Node& node) {
    if (node.kind != Node::Kind::sequence) {
      report_problem(
          node.mark, "script.parameters",
          {"is " + describe(node), "a list of changes such as [{at: 1 s, set: Bag.mass, value: 800 kg}]", ""});
      return;
    }
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      read_change(node.items[i], fmt::format("script.parameters[{}]", i));
    }
  }

  void read_change(const Node& node, const std::string& path) {
    if (node.kind != Node::Kind::map) {
      report_problem(
          node.mark, path,
          {"is " + describe(node), "a change such as {at: 1 s, set: Bag.mass, value: 800 kg, over: 2 s}", ""});
      return;
    }
    ScriptChange change;
    const std::size_t problems = context_.report.size();
    read_fields(node, script_change_fields(), &change, path, node.mark, kChangeKeys, context_);
    const Node::Entry* value = node.find("value");
    if (value == nullptr)
      report_problem(node.mark, path, {"the key 'value' is missing", "the parameter's new value", ""});
    if (value == nullptr || context_.report.size() > problems) return;
    if (!take_value(value->value, path, node.find("set")->value.mark, change)) return;
    if (!change.choice.empty() && change.over > 0) {
      report_problem(node.find("over")->value.mark, path + ".over", {"a choice changes at once", "no time, or 0", ""});
      return;
    }
    scene_.script.changes.push_back(std::move(change));
    if (node.find("over") == nullptr) scene_.script.changes.back().over = directory().find(change_path_)->ramp;
    warn_of_rounding(node, path);
  }

  // A change begins with a step and takes whole steps.
  void warn_of_rounding(const Node& node, const std::string& path) {
    const SimDuration step = scene_.session.step_duration();
    const ScriptChange& change = scene_.script.changes.back();
    const SimTime begin = start_of(first_step_at(change.at, step), step);
    if (begin.ns != duration_of_seconds(change.at).ns) {
      add_warning(node.find("at")->value.mark, path + ".at",
                  {fmt::format("{:.9g} s is within a step of {:g} ms: the change acts from {:.9g} s on", change.at,
                               1e3 * step.seconds(), begin.seconds()),
                   "a multiple of session.step", ""});
    }
    const Node::Entry* given = node.find("over");
    const SimDuration over = duration_of_seconds(change.over), taken = whole_steps(over, step);
    if (given == nullptr || taken == over) return;
    add_warning(given->value.mark, path + ".over",
                {fmt::format("{:.9g} ms is no whole number of steps of {:g} ms: the change takes {:.9g} ms",
                             1e3 * over.seconds(), 1e3 * step.seconds(), 1e3 * taken.seconds()),
                 "a multiple of session.step", ""});
  }

  // The value in the parameter's dimension, when the parameter can be changed.
  bool take_value(const Node& node, const std::string& path, const Mark& set_mark, ScriptChange& change) {
    change_path_ = change.set;
    const ParameterInfo* parameter = directory().find(change.set);
    if (parameter == nullptr || parameter->change == Change::restart) {
      report_problem(set_mark, path + ".set", {directory().check(change.set, 0).status.text, "", ""});
      return false;
    }
    Field row;
    static_cast<FieldOptions&>(row) = {
        .dimension = parameter->dimension, .range = parameter->range, .choices = parameter->choices};
    row.type = parameter->is_choice() ? FieldType::choice : FieldType::number;
    row.member = [](void* def) -> void* { return &static_cast<ScriptChange*>(def)->value; };
    row.set_choice = [](void* def, int index) { static_cast<ScriptChange*>(def)->value = index; };
    const std::size_t problems = context_.report.size();
    read_value(node, row, &change, path + ".value", context_);
    if (context_.report.size() > problems) return false;
    change.choice = parameter->choice_of(change.value);
    // only for a scene without problems so far, whose mechanism can be built
    if (context_.report.size() > 0) return true;
    const Status status = directory().check(change.set, change.value).status;
    if (!status.is_ok()) report_problem(node.mark, path + ".value", {status.text, "", ""});
    return status.is_ok();
  }

  const ParameterDirectory& directory() {
    if (!directory_) directory_.emplace(scene_);
    return *directory_;
  }

  // One order for every notation of a script.
  void finish(const Mark& mark) {
    const auto rank = [&](const std::string& name) {
      return std::find_if(scene_.inputs.begin(), scene_.inputs.end(),
                          [&](const InputDef& def) { return def.name == name; }) -
             scene_.inputs.begin();
    };
    std::stable_sort(scene_.script.tracks.begin(), scene_.script.tracks.end(),
                     [&](const ScriptTrack& a, const ScriptTrack& b) { return rank(a.input) < rank(b.input); });
    std::stable_sort(scene_.script.changes.begin(), scene_.script.changes.end(),
                     [](const ScriptChange& a, const ScriptChange& b) { return a.at < b.at; });
    std::map<StepIndex, std::size_t> changes_in_step;
    for (const ScriptChange& change : scene_.script.changes) {
      if (++changes_in_step[first_step_at(change.at, scene_.session.step_duration())] != kMaxScriptChangesPerStep + 1)
        continue;
      report_problem(mark, "script.parameters",
                     {fmt::format("more than {} changes in the step at {} s", kMaxScriptChangesPerStep, change.at),
                      fmt::format("at most {} in one step", kMaxScriptChangesPerStep), ""});
    }
  }

  const LoadContext& load_context_;
  const NameTable& names_;
  Scene& scene_;
  const ReadContext& context_;
  bool is_opened_ = false;  // true: problems belong to the file
  std::string change_path_;
  std::optional<ParameterDirectory> directory_;
};

}  // namespace

void read_script(const Node& section, const Mark& place, const LoadContext& load_context, const NameTable& names,
                 Scene& scene, const ReadContext& context) {
  ScriptReader(load_context, names, scene, context).read(section, place);
}

}  // namespace slew::scene
