// SPDX-License-Identifier: Apache-2.0
// Reduced bodies as sets of text files, Model_Prefix_Matrix.dat.
//
// Source, Nodes, Frequencies, Modes, Inertia, Stiffness, Foreshortening, Recovery and Elements. Each begins with one
// line
//   slewring-flexible 2 Frequencies rows=14 columns=2 set=8c1f0a... units=1,rad/s
// then lines that begin with # (names of the columns), then its rows. 17 significant digits: reading restores the bits.
// `set` is one number in all files of a set, made of all their contents, so that files of two sets are not mixed; it is
// not compared with the contents again, so that a set may be edited. Model and prefix may hold '_', so two pairs can
// share their files' names (a, b_c and a_b, c): Source identifies the owner. The format: docs/flexible-files.md. Source
// of the naming: the flexible-body tutorial thesis (2017), chapter 3.2; the contents differ.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "flex/reduction.h"

namespace slew::flex {

struct FlexibleFileSet {
  std::filesystem::path folder;
  std::string model;   // letters, digits, '_', '-', '.'
  std::string prefix;  // the same
};

// Letters, digits, '_', '-', '.', one or more.
[[nodiscard]] bool is_flexible_name(std::string_view name) noexcept;
// folder/Model_Prefix_Matrix.dat
[[nodiscard]] std::filesystem::path flexible_file(const FlexibleFileSet& set, const std::string& matrix);
// The nine names of a set's matrices, in the order of writing.
[[nodiscard]] const std::vector<std::string>& flexible_matrices();

// The set whose files begin with `stem`, folder/Model_Prefix, with the names in its Source; without them, the prefix
// follows the last '_'. Throws InputError if Source is missing or unreadable.
[[nodiscard]] FlexibleFileSet find_flexible_files(const std::filesystem::path& stem);

// Writes new files beside the old ones and renames them when all are complete: a failure before that leaves the old set
// unchanged, an interruption during the renames leaves a set that reading refuses. The folder must exist. Throws
// InputError: bad names, a place taken by another model's set or by something other than a file; OutputError: a file
// that cannot be written.
void write_flexible_files(const FlexibleFileSet& set, const Reduction& reduction);

// Throws InputError naming file and line: a file that is missing or of another set, model, format or version, numbers
// of rows or columns that differ from the header or the other files, words that are no finite numbers, unknown nodes,
// frequencies that are not positive and ascending, a stiffness that is not symmetric.
[[nodiscard]] Reduction read_flexible_files(const FlexibleFileSet& set);

}  // namespace slew::flex
