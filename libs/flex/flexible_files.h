// Reduced bodies as sets of text files, Model_Prefix_Matrix.dat.
//
// Source, Nodes, Frequencies, Modes, Inertia, Stiffness, Foreshortening, Recovery and Elements. Each begins with one
// line
//   slewring-flexible 2 Frequencies rows=14 columns=2 set=8c1f0a... units=1,rad/s
// then lines that begin with # (names of the columns), then its rows. 17 significant digits: what is read has the bits
// of what was written. `set` is one number in all files of a set, made of all their contents, so that files of two sets
// are not mixed; it is not compared with the contents again, so that a set may be edited. Model and prefix may hold
// '_', so two pairs can share their files' names (a, b_c and a_b, c): Source tells whose they are. The format:
// docs/flexible-files.md. Source of the naming: the flexible-body tutorial thesis (2017), chapter 3.2; the contents are
// ours.
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
// Of every set: the nine names of matrices, in the order in which they are written.
[[nodiscard]] const std::vector<std::string>& flexible_matrices();

// The set whose files begin with `stem`, folder/Model_Prefix, by what its Source says; where Source does not say it,
// the prefix is what stands behind the last '_'. Throws InputError when there is no such Source or it cannot be read.
[[nodiscard]] FlexibleFileSet find_flexible_files(const std::filesystem::path& stem);

// Writes new files beside the old ones and puts them in their places when all are whole: what fails before that leaves
// the old set as it was, an end in between two sets that reading refuses. The folder must exist.
// Throws InputError: bad names, a place that is taken by another model's set or by what is no file; OutputError: a file
// that cannot be written.
void write_flexible_files(const FlexibleFileSet& set, const Reduction& reduction);

// Throws InputError naming file and line: a file that is missing or of another set, model, format or version, rows or
// columns that are not as many as said or as the other files have, words that are no finite numbers, unknown nodes,
// frequencies that are not positive and ascending, a stiffness that is not symmetric.
[[nodiscard]] Reduction read_flexible_files(const FlexibleFileSet& set);

}  // namespace slew::flex
