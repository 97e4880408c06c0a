// SPDX-License-Identifier: Apache-2.0
// The command line of a program: verbs, options and flags with their texts, ranges and groups, read once in main.
//
//   options::Program program("slewring", "what it is for");
//   options::Command verb = program.command("run", "run a scene");
//   verb.option("--step", options.step, "communication step").value_name("TIME").group("Scene");
//   verb.action([options] { return run(*options); });
//   if (!program.parse(argc, argv, exit_code)) return exit_code;
//   return static_cast<int>(program.run());
//
// Handles are small and are copied; they and the targets of options must not outlive the program. The header hides
// CLI11, which one unit compiles.
#pragma once

#include <functional>
#include <initializer_list>
#include <memory>
#include <string>
#include <vector>

#include "core/status.h"
#include "options/command_text.h"

// types of CLI11, which only this library includes
namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace slew::options {

using Action = std::function<ExitCode()>;

// Text of a value -> its error; empty: none.
using Check = std::function<std::string(const std::string&)>;

class Option {
 public:
  explicit Option(CLI::Option* option) noexcept : option_(option) {}

  // ---- display in --help
  Option& value_name(const std::string& name);
  Option& description(const std::string& text);
  Option& group(const std::string& heading);
  Option& show_default();

  // ---- accepted values
  Option& between(int least, int most);
  Option& between(std::int64_t least, std::int64_t most);
  Option& between(std::uint32_t least, std::uint32_t most);
  Option& between(double least, double most);  // finite; for options with a fractional number
  Option& not_negative();
  Option& one_of(std::vector<std::string> choices);
  Option& check(const Check& problem_of, const std::string& what);

  // ---- origin of the value
  Option& replaced_by(std::function<std::string(const std::string&)> value_of);  // text given -> text that is taken
  // Variable that gives the value where the option is not given. An empty variable counts as none.
  Option& environment(const std::string& variable);

  // ---- repetition and combination
  Option& required();
  Option& values(int least, int most);  // words behind one occurrence
  Option& repeatable();                 // a list that is shown like an option of one value
  Option& one_value_each();             // a list that takes one value an occurrence; repeat for more
  Option& comma_separated();
  Option& needs(const Option& other);
  Option& excludes(const Option& other);

 private:
  friend class Command;
  CLI::Option* option_;
};

class Command {
 public:
  // name: "scene" is a positional argument, "-o,--output" two names of one option. The target keeps its value when the
  // option is not given. Value: std::string, std::vector of strings or doubles, int, std::int64_t, std::uint32_t,
  // std::uint64_t, double, std::optional<double>.
  template <class Value>
  Option option(const std::string& name, Value& target, const std::string& description);
  Option flag(const std::string& name, bool& target, const std::string& description);

  // Exactly one of the two must be given.
  void require_one_of(const Option& a, const Option& b);
  [[nodiscard]] Option find(const std::string& name);
  // True when the option was given on the command line; a value of the environment does not count.
  [[nodiscard]] bool has(const std::string& name) const;

  Command command(const std::string& name, const std::string& description);
  void require_command();
  void hide();                             // removes it from the list of commands in --help
  void footer(const std::string& text);    // text below the options in --help
  void action(Action action);              // action of the program if the user gives this command
  [[nodiscard]] std::string help() const;  // the text of --help
  [[nodiscard]] CommandText text() const;

 private:
  friend class Program;
  Command(CLI::App* app, Action* chosen) noexcept : app_(app), chosen_(chosen) {}

  CLI::App* app_;
  Action* chosen_;  // the program's chosen action
};

class Program : public Command {
 public:
  Program(const std::string& name, const std::string& description);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;
  ~Program();

  [[nodiscard]] const std::string& name() const noexcept { return name_; }
  // --version; as_json for --version --json.
  void version(const std::string& text, const std::string& as_json);
  // The command that is reached by these verbs, {"control", "pause"}. Throws Failure (bad_input) where there is none.
  [[nodiscard]] Command find_command(const std::vector<std::string>& verbs) const;

  // True if the program is to continue. Otherwise the exit code is 0 (help, version) or bad_input, with one line on
  // standard error.
  [[nodiscard]] bool parse(int argc, const char* const* argv, int& exit_code);
  // The same for tests: throws Failure (bad_input) with that line.
  void parse(const std::vector<std::string>& arguments);

  // The action of the command that was given.
  [[nodiscard]] ExitCode run() const { return chosen_action_(); }

 private:
  std::string name_;
  std::unique_ptr<CLI::App> root_;
  Action chosen_action_;
};

}  // namespace slew::options
