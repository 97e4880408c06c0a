// SPDX-License-Identifier: Apache-2.0
// Completion of a command line: the words that may stand at the cursor, from the program's own tree of commands.
#pragma once

#include <string>
#include <vector>

#include "options/command_text.h"

namespace slew::options {

enum class FileKind : std::uint8_t { none, any, folders, scenes, recordings };

struct Candidate {
  std::string word;
  std::string description;  // one line; may be empty
};

struct Completion {
  std::vector<Candidate> candidates;  // all begin with the word at the cursor
  FileKind files = FileKind::none;    // files that fit too; the shell lists them
};

// words: the command line behind the program's name up to the cursor; the last one is the word at the cursor, empty
// after a space. Without words: those of an empty word.
[[nodiscard]] Completion complete(const CommandText& program, const std::vector<std::string>& words);

// For the shells' scripts: first the kind of files ("none", "any", "folders", or a list of suffixes and "folders"),
// then one candidate a line as WORD, tab, description.
[[nodiscard]] std::string to_lines(const Completion& completion);

}  // namespace slew::options
