// SPDX-License-Identifier: Apache-2.0
#include "options/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <optional>
#include <sstream>
#include <string_view>
#include <type_traits>

#include "core/failure.h"
#include "core/printable.h"
#include "core/suggestion.h"
#include "options/whole_number.h"

namespace slew::options {
namespace {

// CLI::Range lets nan through.
CLI::Validator finite_between(double least, double most) {
  const std::string range = fmt::format("from {:.12g} to {:.12g}", least, most);
  const auto problem = [least, most, range](const std::string& text) {
    double number = 0;
    // nan compares with nothing: accept only values inside the range
    const bool is_inside = CLI::detail::lexical_cast(text, number) && number >= least && number <= most;
    return is_inside ? std::string() : fmt::format("'{}' is no number {}", text, range);
  };
  return {problem, range, "number range"};
}

// Names no upper bound: that of double has 309 digits.
CLI::Validator finite_from_zero() {
  const auto problem = [](const std::string& text) {
    double number = 0;
    const bool is_inside = CLI::detail::lexical_cast(text, number) && number >= 0 && std::isfinite(number);
    return is_inside ? std::string() : fmt::format("'{}' is no number from 0", text);
  };
  return {problem, "from 0", "number range"};
}

// The command that was being parsed; `name` gets its words.
const CLI::App& used_command(const CLI::App& root, std::string& name) {
  const CLI::App* used = &root;
  name = root.get_name();
  while (!used->get_subcommands().empty()) {
    used = used->get_subcommands().front();
    name += ' ' + used->get_name();
  }
  return *used;
}

std::string suggestion(const std::string& word, const std::vector<std::string>& names) {
  const std::string meant = closest(word, {names.begin(), names.end()});
  return meant.empty() ? "" : "; did you mean '" + meant + "'?";
}

std::vector<std::string> verb_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!verb->get_group().empty()) names.push_back(verb->get_name());
  }
  return names;
}

// As typed, with their dashes; without hidden ones.
std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* option : app.get_options([](const CLI::Option* one) { return !one->get_group().empty(); })) {
    for (const std::string& name : option->get_snames()) names.push_back('-' + name);
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  return names;
}

bool was_typed(const CLI::App& app, const CLI::Option* option) {
  const std::vector<CLI::Option*>& typed = app.parse_order();
  return std::find(typed.begin(), typed.end(), option) != typed.end();
}

// " (from the environment variable X)" where that gave the value of the error.
std::string origin_of_value(const CLI::App& used, const std::string& error) {
  for (const CLI::Option* option : used.get_options()) {
    const bool is_meant = option->count() > 0 && !option->get_envname().empty() && !was_typed(used, option);
    if (is_meant && error.starts_with(option->get_name() + ":")) {
      return " (from the environment variable " + option->get_envname() + ")";
    }
  }
  return "";
}

// A wrong word in the place of a verb is more likely than a missing verb, a misspelt option than a missing value.
std::string what_is_wrong(const CLI::App& used, const CLI::ParseError& error) {
  const std::vector<std::string> rest = used.remaining();
  const auto unknown = std::find_if(rest.begin(), rest.end(),
                                    [](const std::string& word) { return word.size() > 1 && word.front() == '-'; });
  if (unknown != rest.end()) {
    const std::string name = unknown->substr(0, unknown->find('='));
    return "there is no option '" + name + "' here" + suggestion(name, option_names(used));
  }
  const std::vector<std::string> verbs = verb_names(used);
  if (verbs.empty() || rest.empty()) return error.what() + origin_of_value(used, error.what());
  return "there is no '" + rest.front() + "' here" + suggestion(rest.front(), verbs);
}

// One line that names the command whose --help lists the options.
std::string problem_text(const CLI::App& root, const CLI::ParseError& error) {
  std::string command;
  const CLI::App& used = used_command(root, command);
  return fmt::format("{}; nothing was done; see '{} --help'", what_is_wrong(used, error), command);
}

// CLI11 takes variables for every verb: a wrong value would end verbs too that have no use for it. Those of verbs that
// are not among the words are forgotten.
void forget_environment(CLI::App& app, const std::vector<std::string>& words, bool is_used) {
  if (!is_used) {
    for (CLI::Option* option : app.get_options()) option->envname("");
  }
  for (CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    const bool is_named = std::find(words.begin(), words.end(), verb->get_name()) != words.end();
    forget_environment(*verb, words, is_used && is_named);
  }
}

constexpr const char* kChoices = "choices";

// of one_of(): the set as CLI11 writes it, "{real,free}"
std::vector<std::string> choices_of(CLI::Option& option) {
  try {
    const std::string set = option.get_validator(kChoices)->get_description();
    return CLI::detail::split(set.substr(1, set.size() - 2), ',');
  } catch (const CLI::OptionNotFound&) {
    return {};
  }
}

OptionText text_of(CLI::Option& option) {
  OptionText text;
  text.is_positional = option.get_positional();
  if (text.is_positional) {
    text.names = {option.get_name(true, false)};
  } else {
    for (const std::string& name : option.get_snames()) text.names.push_back('-' + name);
    for (const std::string& name : option.get_lnames()) text.names.push_back("--" + name);
  }
  // "VALUE:range"
  const std::string type = option.get_items_expected_max() == 0 ? "" : option.get_type_name();
  const std::size_t colon = type.find(':');
  text.value_name = type.substr(0, colon);
  text.choices = choices_of(option);
  if (colon != std::string::npos && text.choices.empty()) text.range = type.substr(colon + 1);
  text.description = option.get_description();
  text.group = option.get_group();
  text.default_text = option.get_default_str();
  text.environment = option.get_envname();
  text.is_required = option.get_required();
  text.takes_many = text.is_positional && option.get_items_expected_max() > 1;
  text.takes_a_list = option.get_delimiter() != '\0';
  return text;
}

constexpr std::size_t kHelpWidth = 80;

// Descriptions in lines that end at kHelpWidth; CLI11 indents what follows a line break.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_desc(const CLI::Option* option) const override { return in_lines(option->get_description()); }

  std::string make_subcommand(const CLI::App* verb) const override {
    std::ostringstream text;
    CLI::detail::format_help(text, verb->get_display_name(true), in_lines(verb->get_description()), get_column_width());
    return text.str();
  }

 private:
  [[nodiscard]] std::string in_lines(const std::string& description) const {
    std::string lines;
    std::size_t length = 0;  // of the last line
    for (const std::string& word : CLI::detail::split(description, ' ')) {
      if (length > 0 && get_column_width() + length + 1 + word.size() > kHelpWidth) {
        lines += '\n';
        length = 0;
      } else if (length > 0) {
        lines += ' ';
        ++length;
      }
      lines += word;
      length += word.size();
    }
    return lines;
  }
};

CommandText text_of(CLI::App& app) {
  CommandText text{app.get_name(), app.get_description(), app.get_footer(), {}, {}};
  for (CLI::Option* option : app.get_options()) {
    if (!option->get_group().empty()) text.options.push_back(text_of(*option));
  }
  for (CLI::App* verb : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (!verb->get_group().empty()) text.commands.push_back(text_of(*verb));
  }
  return text;
}

}  // namespace

// ---- Option ---------------------------------------------------------------------------------------------------------

Option& Option::value_name(const std::string& name) {
  option_->type_name(name);
  return *this;
}

Option& Option::description(const std::string& text) {
  option_->description(text);
  return *this;
}

Option& Option::group(const std::string& heading) {
  option_->group(heading);
  return *this;
}

Option& Option::show_default() {
  option_->capture_default_str();
  return *this;
}

Option& Option::between(int least, int most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

Option& Option::between(std::int64_t least, std::int64_t most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

Option& Option::between(std::uint32_t least, std::uint32_t most) {
  option_->check(CLI::Range(least, most));
  return *this;
}

Option& Option::between(double least, double most) {
  option_->check(finite_between(least, most));
  return *this;
}

Option& Option::not_negative() {
  option_->check(finite_from_zero());
  return *this;
}

Option& Option::one_of(std::vector<std::string> choices) {
  option_->check(CLI::IsMember(std::move(choices)), kChoices);
  return *this;
}

Option& Option::check(const Check& problem_of, const std::string& what) {
  option_->check(CLI::Validator([problem_of](const std::string& text) { return problem_of(text); }, "", what));
  return *this;
}

Option& Option::replaced_by(std::function<std::string(const std::string&)> value_of) {
  option_->transform([value_of = std::move(value_of)](const std::string& text) { return value_of(text); });
  return *this;
}

Option& Option::environment(const std::string& variable) {
  option_->envname(variable);
  return *this;
}

Option& Option::required() {
  option_->required();
  return *this;
}

Option& Option::values(int least, int most) {
  option_->expected(least, most);
  return *this;
}

Option& Option::repeatable() {
  option_->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return *this;
}

Option& Option::one_value_each() {
  option_->allow_extra_args(false);
  return *this;
}

Option& Option::comma_separated() {
  option_->delimiter(',');
  return *this;
}

Option& Option::needs(const Option& other) {
  option_->needs(other.option_);
  return *this;
}

Option& Option::excludes(const Option& other) {
  option_->excludes(other.option_);
  return *this;
}

// ---- Command --------------------------------------------------------------------------------------------------------

template <class Value>
Option Command::option(const std::string& name, Value& target, const std::string& description) {
  CLI::Option* option = app_->add_option(name, target, description);
  if constexpr (std::is_same_v<Value, std::int64_t> || std::is_same_v<Value, std::uint64_t>) {
    option->check({problem_of_whole<Value>, "", "whole number"});
  }
  return Option(option);
}

template Option Command::option(const std::string&, std::string&, const std::string&);
template Option Command::option(const std::string&, std::vector<std::string>&, const std::string&);
template Option Command::option(const std::string&, std::vector<double>&, const std::string&);
template Option Command::option(const std::string&, int&, const std::string&);
template Option Command::option(const std::string&, std::int64_t&, const std::string&);
template Option Command::option(const std::string&, std::uint32_t&, const std::string&);
template Option Command::option(const std::string&, std::uint64_t&, const std::string&);
template Option Command::option(const std::string&, double&, const std::string&);
template Option Command::option(const std::string&, std::optional<double>&, const std::string&);

Option Command::flag(const std::string& name, bool& target, const std::string& description) {
  return Option(app_->add_flag(name, target, description));
}

void Command::require_one_of(const Option& a, const Option& b) {
  app_->parse_complete_callback([a = a.option_, b = b.option_] {
    if (a->empty() && b->empty()) throw CLI::RequiredError(a->get_name());
    if (!a->empty() && !b->empty()) throw CLI::ExcludesError(b->get_name(), a->get_name());
  });
}

Option Command::find(const std::string& name) {
  return Option(app_->get_option(name));
}

bool Command::has(const std::string& name) const {
  return was_typed(*app_, app_->get_option(name));
}

Command Command::command(const std::string& name, const std::string& description) {
  CLI::App* const command = app_->add_subcommand(name, description);
  command->footer("");  // CLI11 copies that of the parent
  return {command, chosen_};
}

void Command::require_command() {
  app_->require_subcommand(1);
}

void Command::hide() {
  app_->group("");
}

void Command::footer(const std::string& text) {
  app_->footer(text);
}

void Command::action(Action action) {
  app_->callback([chosen = chosen_, action = std::move(action)] { *chosen = action; });
}

std::string Command::help() const {
  std::string name = app_->get_name();
  for (const CLI::App* app = app_->get_parent(); app != nullptr; app = app->get_parent()) {
    name = app->get_name() + " " + name;
  }
  // App::help() gives that of the verb that was parsed
  return app_->get_formatter()->make_help(app_, name, CLI::AppFormatMode::Normal);
}

CommandText Command::text() const {
  return text_of(*app_);
}

// ---- Program --------------------------------------------------------------------------------------------------------

Program::Program(const std::string& name, const std::string& description)
    : Command(nullptr, &chosen_action_), name_(name), root_(std::make_unique<CLI::App>(description, name)) {
  app_ = root_.get();
  app_->formatter(std::make_shared<HelpFormatter>());
}

Program::~Program() = default;

void Program::version(const std::string& text, const std::string& as_json) {
  CLI::Option* const own = app_->get_option_no_throw("--json");  // of a program whose lines may be JSON
  CLI::Option* const json = own != nullptr ? own : app_->add_flag("--json")->description("with --version: as JSON");
  CLI::Option* const version = app_->set_version_flag(
      "--version", [text, as_json, json] { return json->count() > 0 ? as_json : text; }, "print version and build");
  if (own == nullptr) json->needs(version);
}

Command Program::find_command(const std::vector<std::string>& verbs) const {
  CLI::App* app = app_;
  for (const std::string& verb : verbs) {
    CLI::App* next = nullptr;
    for (CLI::App* one : app->get_subcommands([](const CLI::App*) { return true; })) {
      if (one->get_name() == verb) next = one;
    }
    if (next == nullptr) {
      throw Failure(ExitCode::bad_input, "there is no '" + verb + "' here" + suggestion(verb, verb_names(*app)) +
                                             "; nothing was done; see '" + name_ + " --help'");
    }
    app = next;
  }
  return {app, chosen_};
}

bool Program::parse(int argc, const char* const* argv, int& exit_code) {
  forget_environment(*app_, {argv + std::min(argc, 1), argv + argc}, true);
  try {
    app_->parse(argc, argv);
    return true;
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) {
      exit_code = app_->exit(error);
      return false;
    }
    std::fprintf(stderr, "%s: %s\n", app_->get_name().c_str(), printable_lines(problem_text(*app_, error)).c_str());
    exit_code = static_cast<int>(ExitCode::bad_input);
    return false;
  }
}

void Program::parse(const std::vector<std::string>& arguments) {
  forget_environment(*app_, arguments, true);
  try {
    app_->parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 wants the last one first
  } catch (const CLI::ParseError& error) {
    throw Failure(ExitCode::bad_input, problem_text(*app_, error));
  }
}

}  // namespace slew::options
