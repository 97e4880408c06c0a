// SPDX-License-Identifier: Apache-2.0
// What a command line accepts, as plain values: for completion in a shell and for manual pages.
#pragma once

#include <string>
#include <vector>

namespace slew::options {

struct OptionText {
  std::vector<std::string> names;  // as typed: "-o", "--output"; of a positional argument its bare name
  std::string value_name;          // "FILE"; empty: a flag
  std::string range;               // accepted values, "INT in [1 - 99]"; empty: not stated
  std::string description;
  std::string group;                 // heading in --help
  std::string default_text;          // empty: none is shown
  std::string environment;           // variable that gives the value where the option is not given; empty: none
  std::vector<std::string> choices;  // the accepted values; empty: others than a list
  bool is_positional = false;
  bool is_required = false;
  bool takes_many = false;    // a positional argument of more than one word
  bool takes_a_list = false;  // separated by commas
};

struct CommandText {
  std::string name;
  std::string description;
  std::string footer;
  std::vector<OptionText> options;    // in the order of --help, without hidden ones
  std::vector<CommandText> commands;  // without hidden ones
};

}  // namespace slew::options
