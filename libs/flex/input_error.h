// SPDX-License-Identifier: Apache-2.0
// Error of a request or an input file. One text: what happened; expected ...; what to do.
//
// Thrown while a model is built, reduced, written or read; never within a step.
#pragma once

#include <cstddef>
#include <filesystem>
#include <stdexcept>
#include <string>

#include "core/problem.h"

namespace slew::flex {

class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A file cannot be written: the fault is the place, not the request.
class OutputError : public InputError {
 public:
  using InputError::InputError;
};

// Throws every problem, one a line (path: what; expected ...); returns when there is none.
void refuse_if_any(const Problems& problems);

// Throws "file:line: what; expected ...; remedy". line 0: the whole file. remedy may be empty.
[[noreturn]] void refuse_file(const std::filesystem::path& file, std::size_t line, const std::string& what,
                              const std::string& expected, const std::string& remedy = {});

}  // namespace slew::flex
