// SPDX-License-Identifier: Apache-2.0
#include "options/completion.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>
#include <utility>

#include "core/installation.h"

namespace slew::options {
namespace {

// Kinds of files by the names of values in --help.
FileKind files_of(const OptionText& option) {
  static constexpr std::pair<std::string_view, FileKind> kKinds[] = {
      {"SCENE", FileKind::scenes},   {"REC", FileKind::recordings}, {"DIR", FileKind::folders},
      {"FOLDER", FileKind::folders}, {"STORE", FileKind::folders},  {"FILE", FileKind::any},
      {"SOURCE", FileKind::any},     {"PREFIX", FileKind::any},     {"DEVICE", FileKind::any}};
  const auto* const kind = std::find_if(std::begin(kKinds), std::end(kKinds),
                                        [&](const auto& known) { return known.first == option.value_name; });
  return kind == std::end(kKinds) || !option.choices.empty() ? FileKind::none : kind->second;
}

bool is_named(const OptionText& option, const std::string& name) {
  return !option.is_positional && std::find(option.names.begin(), option.names.end(), name) != option.names.end();
}

const OptionText* find_option(const CommandText& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  const auto option = std::find_if(command.options.begin(), command.options.end(),
                                   [&](const OptionText& candidate) { return is_named(candidate, name); });
  return option == command.options.end() ? nullptr : &*option;
}

const CommandText* find_command(const CommandText& command, const std::string& name) {
  const auto found = std::find_if(command.commands.begin(), command.commands.end(),
                                  [&](const CommandText& candidate) { return candidate.name == name; });
  return found == command.commands.end() ? nullptr : &*found;
}

const OptionText* positional(const CommandText& command, std::size_t index) {
  for (const OptionText& option : command.options) {
    if (!option.is_positional) continue;
    if (index == 0 || option.takes_many) return &option;
    --index;
  }
  return nullptr;
}

// The place of the cursor: the command it belongs to, and what precedes it.
struct Place {
  const CommandText* command;
  const OptionText* pending = nullptr;  // option whose value is next
  std::size_t positionals = 0;          // arguments given
  bool takes_options = true;            // no "--" yet
  std::size_t begin = 0;                // number of words up to the command's name
};

Place place_behind(const CommandText& program, const std::vector<std::string>& words) {
  Place place{&program};
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const std::string& word = words[i];
    if (place.pending != nullptr) {
      place.pending = nullptr;
    } else if (place.takes_options && word == "--") {
      place.takes_options = false;
    } else if (place.takes_options && word.size() > 1 && word[0] == '-') {
      const OptionText* const option = find_option(*place.command, word);
      const bool has_value = word.find('=') != std::string::npos;
      if (option != nullptr && !option->value_name.empty() && !has_value) place.pending = option;
    } else if (const CommandText* const command = find_command(*place.command, word);
               command != nullptr && place.positionals == 0) {
      place = Place{command};
      place.begin = i + 1;
    } else {
      ++place.positionals;
    }
  }
  return place;
}

void add(Completion& completion, const std::string& typed, const std::string& word, const std::string& description) {
  if (!word.starts_with(typed)) return;
  std::string line = description.substr(0, description.find('\n'));
  std::replace(line.begin(), line.end(), '\t', ' ');
  completion.candidates.push_back({word, std::move(line)});
}

void add_installed_scenes(Completion& completion, const std::string& typed) {
  const std::string folder = installed_scenes();
  if (folder.empty()) return;
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".yaml") names.push_back(entry.path().filename().string());
  }
  std::sort(names.begin(), names.end());
  for (const std::string& name : names) add(completion, typed, name, "installed scene");
}

// prefix: what stands before the value in the same word, "--pace="
void add_values(Completion& completion, const OptionText& option, const std::string& typed, const std::string& prefix) {
  const std::size_t comma = option.takes_a_list ? typed.rfind(',') : std::string::npos;
  const std::string before = prefix + (comma == std::string::npos ? "" : typed.substr(0, comma + 1));
  for (const std::string& choice : option.choices) add(completion, prefix + typed, before + choice, "");
  completion.files = files_of(option);
  if (completion.files == FileKind::scenes && prefix.empty()) add_installed_scenes(completion, typed);
}

// Verbs as arguments of another verb, as in "help control pause".
void add_verbs(Completion& completion, const CommandText& program, const std::vector<std::string>& words) {
  const Place place = place_behind(program, words);
  for (const CommandText& verb : place.command->commands) add(completion, words.back(), verb.name, verb.description);
  const OptionText* const argument = positional(*place.command, place.positionals);
  if (argument != nullptr && !argument->choices.empty()) add_values(completion, *argument, words.back(), "");
}

}  // namespace

Completion complete(const CommandText& program, const std::vector<std::string>& words) {
  const std::string typed = words.empty() ? "" : words.back();
  const Place place = place_behind(program, words);
  const CommandText& command = *place.command;
  Completion completion;
  if (place.pending != nullptr) {
    add_values(completion, *place.pending, typed, "");
    return completion;
  }
  if (place.takes_options && typed.starts_with("-")) {
    const std::size_t equals = typed.find('=');
    const OptionText* const option = equals == std::string::npos ? nullptr : find_option(command, typed);
    if (option != nullptr) {
      add_values(completion, *option, typed.substr(equals + 1), typed.substr(0, equals + 1));
    } else {
      for (const OptionText& offered : command.options) {
        if (offered.is_positional) continue;
        for (const std::string& name : offered.names) add(completion, typed, name, offered.description);
      }
    }
    return completion;
  }
  if (place.positionals == 0) {
    for (const CommandText& verb : command.commands) add(completion, typed, verb.name, verb.description);
  }
  if (const OptionText* const argument = positional(command, place.positionals)) {
    if (argument->value_name == "VERB") {
      add_verbs(completion, program, {words.begin() + static_cast<std::ptrdiff_t>(place.begin), words.end()});
    } else {
      add_values(completion, *argument, typed, "");
    }
  }
  return completion;
}

std::string to_lines(const Completion& completion) {
  static constexpr const char* kFiles[] = {"none", "any", "folders", "folders .yaml", "folders .mcap"};
  std::string text = fmt::format("{}\n", kFiles[static_cast<std::size_t>(completion.files)]);
  for (const Candidate& candidate : completion.candidates) {
    text += fmt::format("{}\t{}\n", candidate.word, candidate.description);
  }
  return text;
}

}  // namespace slew::options
