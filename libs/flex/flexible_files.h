// Reduced bodies as sets of text files, Model_Prefix_Matrix.dat.
//
// Source, Nodes, Frequencies, Modes, Inertia, Stiffness, Foreshortening and Recovery. Each begins with one line
//   slewring-flexible 1 Frequencies rows=14 columns=2 set=8c1f0a... units=1,rad/s
// then lines that begin with # (names of the columns), then its rows. 17 significant digits: what is read has the bits
// of what was written. `set` is one number in all files of a set, made of all their contents, so that files of two sets
// are not mixed; it is not compared with the contents again, so that a set may be edited. The format:
// docs/flexible-files.md. Source of the naming: the flexible-body tutorial thesis (2017), chapter 3.2; the contents are
// ours.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "flex/reduction.h"

namespace slew::flex {

struct FlexibleFileSet {
  std::filesystem::path folder;
  std::string model;   // letters, digits, '_', '-', '.'
  std::string prefix;  // the same without '_'
};

// folder/Model_Prefix_Matrix.dat
[[nodiscard]] std::filesystem::path flexible_file(const FlexibleFileSet& set, const std::string& matrix);
// Of every set: the eight names of matrices, in the order in which they are written.
[[nodiscard]] const std::vector<std::string>& flexible_matrices();

// Throws InputError: bad names, or a file that cannot be written. The folder must exist.
void write_flexible_files(const FlexibleFileSet& set, const Reduction& reduction);

// Throws InputError naming file and line: a file that is missing or of another set, format or version, rows or columns
// that are not as many as said or as the other files have, words that are no finite numbers, unknown nodes, frequencies
// that are not positive and ascending, a stiffness that is not symmetric.
[[nodiscard]] Reduction read_flexible_files(const FlexibleFileSet& set);

}  // namespace slew::flex
