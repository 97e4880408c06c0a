#include "options/options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cstdio>
#include <optional>
#include <string_view>

#include "core/failure.h"
#include "core/printable.h"
#include "core/suggestion.h"

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

// A wrong word in the place of a verb is more likely than a missing verb.
std::string what_is_wrong(const CLI::App& used, const CLI::ParseError& error) {
  const std::vector<const CLI::App*> verbs = used.get_subcommands([](const CLI::App*) { return true; });
  const std::vector<std::string> rest = used.remaining();
  if (verbs.empty() || rest.empty()) return error.what();
  std::vector<std::string_view> names;
  for (const CLI::App* verb : verbs) names.push_back(verb->get_name());
  const std::string meant = closest(rest.front(), names);
  return "there is no '" + rest.front() + "' here" + (meant.empty() ? "" : "; did you mean '" + meant + "'?");
}

// One line that names the command whose --help lists the options.
std::string problem_text(const CLI::App& root, const CLI::ParseError& error) {
  std::string command;
  const CLI::App& used = used_command(root, command);
  return fmt::format("{}; nothing was done; see '{} --help'", what_is_wrong(used, error), command);
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
  option_->check(CLI::NonNegativeNumber);
  return *this;
}

Option& Option::one_of(std::vector<std::string> choices) {
  option_->check(CLI::IsMember(std::move(choices)));
  return *this;
}

Option& Option::check(const Check& problem_of, const std::string& what) {
  option_->check(CLI::Validator([problem_of](const std::string& text) { return problem_of(text); }, "", what));
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
  return Option(app_->add_option(name, target, description));
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
  return app_->count(name) > 0;
}

Command Command::command(const std::string& name, const std::string& description) {
  return {app_->add_subcommand(name, description), chosen_};
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

// ---- Program --------------------------------------------------------------------------------------------------------

Program::Program(const std::string& name, const std::string& description)
    : Command(nullptr, &chosen_action_), name_(name), root_(std::make_unique<CLI::App>(description, name)) {
  app_ = root_.get();
}

Program::~Program() = default;

void Program::version(const std::string& text) {
  app_->set_version_flag("--version", text, "print version and build");
}

bool Program::parse(int argc, const char* const* argv, int& exit_code) {
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
  try {
    app_->parse(std::vector<std::string>(arguments.rbegin(), arguments.rend()));  // CLI11 wants the last one first
  } catch (const CLI::ParseError& error) {
    throw Failure(ExitCode::bad_input, problem_text(*app_, error));
  }
}

}  // namespace slew::options
