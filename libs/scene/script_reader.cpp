#include "scene/script_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <utility>

#include "core/suggestion.h"
#include "scene/csv_table.h"
#include "scene/parameters.h"
#include "scene/source.h"

namespace slew::scene {
namespace {

constexpr std::string_view kScriptKeys[] = {"file", "inputs", "parameters"};
constexpr std::string_view kChangeKeys[] = {"value"};

class ScriptReader {
 public:
  ScriptReader(const Surroundings& surroundings, const NameTable& names, Scene& scene, const ReadContext& context)
      : surroundings_(surroundings), names_(names), scene_(scene), context_(context) {}

  void read(const Node& section, const Mark& place) {
    if (section.kind != Node::Kind::map) {
      complain(section.mark, "script", {"is " + describe(section), "a map", ""});
      return;
    }
    read_fields(section, script_fields(), &scene_.script, "script", place, kScriptKeys, context_);
    const Node::Entry* file = section.find("file");
    const Node::Entry* inputs = section.find("inputs");
    const Node::Entry* changes = section.find("parameters");
    if (file != nullptr && inputs != nullptr) {
      complain(inputs->mark, "script.inputs", {"the script has a file and inputs of its own", "one of them", ""});
    } else if (file != nullptr) {
      read_file(file->value);
    }
    if (inputs != nullptr) read_tracks(inputs->value);
    if (changes != nullptr) read_changes(changes->value);
    finish(section.mark);
  }

 private:
  void complain(const Mark& mark, std::string path, Complaint complaint) {
    context_.report.add(mark, std::move(path), std::move(complaint));
  }

  void read_tracks(const Node& node) {
    if (node.kind != Node::Kind::map) {
      complain(node.mark, "script.inputs", {"is " + describe(node), "a map from inputs to points [time, value]", ""});
      return;
    }
    report_duplicates(node, "script.inputs", context_.report);
    for (const Node::Entry& entry : node.entries) {
      if (!is_input(entry.key, entry.mark, "script.inputs." + entry.key)) continue;
      ScriptTrack track{.input = entry.key, .points = {}};
      read_value(entry.value, script_track_fields().front(), &track, "script.inputs." + entry.key, context_);
      if (!track.points.empty()) add_track(std::move(track), entry.value.mark);
    }
  }

  bool is_input(const std::string& name, const Mark& mark, const std::string& path) {
    if (names_.kind_of(name) == "input") return true;
    complain(mark, path, {"no input '" + name + "'", "", names_.closest_of(name, "input")});
    return false;
  }

  void add_track(ScriptTrack track, const Mark& mark) {
    const auto input = std::find_if(scene_.inputs.begin(), scene_.inputs.end(),
                                    [&](const InputDef& def) { return def.name == track.input; });
    if (input != scene_.inputs.end() && input->type == InputType::digital) {
      for (const auto& point : track.points) {
        if (point[1] == 0 || point[1] == 1) continue;
        complain(mark, "script.inputs." + track.input,
                 {fmt::format("{} is no value of a digital input", point[1]), "0 or 1", ""});
        return;
      }
    }
    scene_.script.tracks.push_back(std::move(track));
  }

  void read_file(const Node& name) {
    if (name.kind != Node::Kind::scalar || name.text.empty()) {
      complain(name.mark, "script.file", {"is " + describe(name), "the name of a .csv or .yaml file", ""});
      return;
    }
    if (!surroundings_.has_folder) {
      complain(name.mark, "script.file",
               {"a scene without a folder cannot name a file", "the points themselves under inputs", ""});
      return;
    }
    const std::string path = surroundings_.path_of(name.text);
    const bool is_csv = path.ends_with(".csv");
    if (!is_csv && !path.ends_with(".yaml") && !path.ends_with(".yml")) {
      complain(name.mark, "script.file", {describe(name) + " is of no kind that is known", "a .csv or .yaml file", ""});
      return;
    }
    const std::size_t problems = context_.report.size();
    const std::optional<SourceText> text = read_source(path, context_.report.add_source(path), context_.report);
    if (text && is_csv) read_csv(*text);
    if (text && !is_csv) read_yaml(*text);
    if (context_.report.size() > problems)
      complain(name.mark, "script.file", {describe(name) + " cannot be used", "", ""});
  }

  void read_csv(const SourceText& text) {
    for (CsvColumn& column : read_time_table(text, context_.report)) {
      if (!is_input(column.name, column.mark, "")) continue;
      add_track({.input = std::move(column.name), .points = std::move(column.points)}, column.mark);
    }
  }

  void read_yaml(const SourceText& text) {
    const std::optional<Node> root = parse_yaml(text, context_.report);
    if (!root) return;
    if (const Node::Entry* nested = root->find("file")) {
      complain(nested->mark, "script.file", {"a script file names another", "inputs and parameters", ""});
      return;
    }
    read(*root, root->mark);
  }

  void read_changes(const Node& node) {
    if (node.kind != Node::Kind::sequence) {
      complain(node.mark, "script.parameters",
               {"is " + describe(node), "a list of {at: , set: , value: , over: }", ""});
      return;
    }
    for (std::size_t i = 0; i < node.items.size(); ++i) {
      read_change(node.items[i], fmt::format("script.parameters[{}]", i));
    }
  }

  void read_change(const Node& node, const std::string& path) {
    if (node.kind != Node::Kind::map) {
      complain(node.mark, path, {"is " + describe(node), "{at: , set: , value: , over: }", ""});
      return;
    }
    ScriptChange change;
    const std::size_t problems = context_.report.size();
    read_fields(node, script_change_fields(), &change, path, node.mark, kChangeKeys, context_);
    const Node::Entry* value = node.find("value");
    if (value == nullptr) complain(node.mark, path, {"the key 'value' is missing", "the parameter's new value", ""});
    if (value == nullptr || context_.report.size() > problems) return;
    if (!take_value(value->value, path, node.find("set")->value.mark, change)) return;
    if (!change.choice.empty() && change.over > 0) {
      complain(node.find("over")->value.mark, path + ".over", {"a choice changes at once", "no time, or 0", ""});
      return;
    }
    scene_.script.changes.push_back(std::move(change));
    if (node.find("over") == nullptr) scene_.script.changes.back().over = directory().find(change_path_)->ramp;
  }

  // The value in the parameter's dimension, when the parameter can be changed.
  bool take_value(const Node& node, const std::string& path, const Mark& set_mark, ScriptChange& change) {
    change_path_ = change.set;
    const ParameterInfo* parameter = directory().find(change.set);
    if (parameter == nullptr || parameter->change == Change::restart) {
      complain(set_mark, path + ".set", {directory().check(change.set, 0).status.text, "", ""});
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
    // of a scene that is sound so far, whose mechanism can be built
    if (context_.report.size() > 0 || parameter->is_choice()) return true;
    const Status status = directory().check(change.set, change.value).status;
    if (!status.is_ok()) complain(node.mark, path + ".value", {status.text, "", ""});
    return status.is_ok();
  }

  const ParameterDirectory& directory() {
    if (!directory_) directory_.emplace(scene_);
    return *directory_;
  }

  // One order for every way of writing a script.
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
      const StepIndex step =
          duration_of_seconds(change.at).ns / std::max<std::int64_t>(1, scene_.session.step_duration().ns);
      if (++changes_in_step[step] != kMaxScriptChangesPerStep + 1) continue;
      complain(mark, "script.parameters",
               {fmt::format("more than {} changes in the step at {} s", kMaxScriptChangesPerStep, change.at),
                fmt::format("at most {} in one step", kMaxScriptChangesPerStep), ""});
    }
  }

  const Surroundings& surroundings_;
  const NameTable& names_;
  Scene& scene_;
  const ReadContext& context_;
  std::string change_path_;
  std::optional<ParameterDirectory> directory_;
};

}  // namespace

void read_script(const Node& section, const Mark& place, const Surroundings& surroundings, const NameTable& names,
                 Scene& scene, const ReadContext& context) {
  ScriptReader(surroundings, names, scene, context).read(section, place);
}

}  // namespace slew::scene
