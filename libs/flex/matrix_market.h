// SPDX-License-Identifier: Apache-2.0
// Sparse matrices in Matrix Market files: coordinate, real (or integer), general or symmetric.
//
// A symmetric file holds the lower triangle. Comments (%) and blank lines may stand before the sizes; repeated entries
// are an error, as the format demands. Source: Boisvert, Pozo & Remington 1996 (NISTIR 5935). Not covered: array
// (dense), complex, pattern, skew-symmetric and hermitian files; they are refused with their name.
#pragma once

#include <filesystem>

#include "flex/fe_model.h"

namespace slew::flex {

// Throws InputError naming file and line: unreadable, wrong header, wrong counts, indices out of range, numbers that
// are none or not finite, entries above the diagonal of a symmetric file, an entry given twice.
[[nodiscard]] SparseMatrix read_matrix_market(const std::filesystem::path& file);

// A symmetric matrix as its lower triangle, 17 significant digits. comment: one line, may be empty.
// Throws InputError when the file cannot be written.
void write_matrix_market(const std::filesystem::path& file, const SparseMatrix& symmetric, const std::string& comment);

}  // namespace slew::flex
