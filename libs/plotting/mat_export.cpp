// SPDX-License-Identifier: Apache-2.0
#include "plotting/mat_export.h"

#include <fmt/format.h>
#include <matio.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <memory>
#include <set>
#include <string_view>

namespace slew::plotting {
namespace {

constexpr std::size_t kMostCharacters = 63;                // namelengthmax of MATLAB
constexpr std::size_t kMostValues = std::size_t{1} << 26;  // time and values together stay below 2^31 bytes
constexpr const char* kOrigin = "recording";

constexpr std::array kKeywords = {"break",      "case",   "catch",    "classdef", "continue", "else",      "elseif",
                                  "end",        "for",    "function", "global",   "if",       "otherwise", "parfor",
                                  "persistent", "return", "spmd",     "switch",   "try",      "while"};

struct CloseFile {
  void operator()(mat_t* file) const noexcept { Mat_Close(file); }
};
struct FreeVariable {
  void operator()(matvar_t* variable) const noexcept { Mat_VarFree(variable); }
};
using File = std::unique_ptr<mat_t, CloseFile>;
using Variable = std::unique_ptr<matvar_t, FreeVariable>;

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
}

std::string mat_name(std::string_view name) {
  std::string valid;
  for (const char c : name) valid += is_letter(c) || (c >= '0' && c <= '9') ? c : '_';
  const bool is_keyword = std::find(kKeywords.begin(), kKeywords.end(), valid) != kKeywords.end();
  if (valid.empty() || !is_letter(valid.front()) || is_keyword) valid.insert(0, "x");
  return valid.substr(0, kMostCharacters);
}

Variable text(std::string content) {
  std::size_t dims[] = {1, content.size()};
  return Variable(Mat_VarCreate(nullptr, MAT_C_CHAR, MAT_T_UTF8, 2, dims, content.data(), 0));
}

// Not copied: the values must live until the variable is written.
Variable column(const double* values, std::size_t size) {
  std::size_t dims[] = {size, 1};
  return Variable(
      Mat_VarCreate(nullptr, MAT_C_DOUBLE, MAT_T_DOUBLE, 2, dims, const_cast<double*>(values), MAT_F_DONT_COPY_DATA));
}

bool add_struct(mat_t* file, const char* name, std::span<const char* const> fields, std::span<Variable> values) {
  std::size_t dims[] = {1, 1};
  const Variable all(Mat_VarCreateStruct(name, 2, dims, const_cast<const char**>(fields.data()),
                                         static_cast<unsigned>(fields.size())));
  if (!all || std::any_of(values.begin(), values.end(), [](const Variable& value) { return !value; })) return false;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    Mat_VarSetStructFieldByName(all.get(), fields[i], 0, values[i].release());
  }
  return Mat_VarWrite(file, all.get(), MAT_COMPRESSION_ZLIB) == 0;
}

bool add_origin(mat_t* file, const MatOrigin& origin) {
  constexpr const char* kFields[] = {"scene", "session", "session_id", "build", "step"};
  Variable values[] = {text(origin.scene), text(origin.session), text(origin.session_id), text(origin.build),
                       column(&origin.step, 1)};
  return add_struct(file, kOrigin, kFields, values);
}

bool add_curve(mat_t* file, const std::string& name, const Series& series) {
  constexpr const char* kFields[] = {"name", "unit", "time", "value"};
  const std::size_t size = size_of(series);
  Variable values[] = {text(series.name), text(series.unit.empty() ? "1" : series.unit),
                       column(series.time.data(), size), column(series.values.data(), size)};
  return add_struct(file, name.c_str(), kFields, values);
}

bool holds(matvar_t* variable, const char* field, std::span<const double> expected) {
  const matvar_t* found = Mat_VarGetStructFieldByName(variable, field, 0);
  if (found == nullptr || found->class_type != MAT_C_DOUBLE || found->nbytes != expected.size_bytes()) return false;
  if (expected.empty()) return true;
  return found->data != nullptr && std::memcmp(found->data, expected.data(), expected.size_bytes()) == 0;
}

// The library does not report every write that failed, and reads a cut file as variables without name or values.
bool is_as_written(const std::filesystem::path& path, std::span<const std::string> names,
                   std::span<const Series> series) {
  const File file(Mat_Open(path.c_str(), MAT_ACC_RDONLY));
  if (!file) return false;
  const Variable origin(Mat_VarReadNext(file.get()));
  if (!origin) return false;
  for (std::size_t i = 0; i < series.size(); ++i) {
    const Variable variable(Mat_VarReadNext(file.get()));
    if (!variable || variable->name == nullptr || names[i] != variable->name) return false;
    const std::size_t size = size_of(series[i]);
    if (!holds(variable.get(), "time", {series[i].time.data(), size})) return false;
    if (!holds(variable.get(), "value", {series[i].values.data(), size})) return false;
  }
  return true;
}

}  // namespace

std::vector<std::string> mat_names(std::span<const Series> series) {
  std::set<std::string> taken = {kOrigin};
  std::vector<std::string> names;
  for (const Series& curve : series) {
    const std::string requested = mat_name(curve.name);
    std::string name = requested;
    for (int k = 2; !taken.insert(name).second; ++k) {
      const std::string suffix = fmt::format("_{}", k);
      name = requested.substr(0, kMostCharacters - suffix.size()) + suffix;
    }
    names.push_back(std::move(name));
  }
  return names;
}

Status export_mat(std::span<const Series> series, const MatOrigin& origin, const std::filesystem::path& path) {
  for (const Series& curve : series) {
    if (size_of(curve) <= kMostValues) continue;
    return Status::error(ExitCode::bad_input,
                         fmt::format("{} has {} values and a MAT-file of level 5 holds {} of one variable; nothing was "
                                     "written; take a part with --from and --to, or --csv",
                                     curve.name, size_of(curve), kMostValues));
  }
  const std::vector<std::string> names = mat_names(series);
  const std::string head = fmt::format("MATLAB 5.0 MAT-file, written by slewring {}", origin.build).substr(0, 115);
  bool is_written = false;
  {
    const File file(Mat_CreateVer(path.c_str(), head.c_str(), MAT_FT_MAT5));
    is_written = file != nullptr && add_origin(file.get(), origin);
    for (std::size_t i = 0; is_written && i < series.size(); ++i) {
      is_written = add_curve(file.get(), names[i], series[i]);
    }
  }
  if (is_written && is_as_written(path, names, series)) return Status::ok();
  return Status::error(ExitCode::storage,
                       fmt::format("{}: the MAT-file cannot be written, or does not read back as it was written; "
                                   "nothing whole was written; free space or choose another place with -o",
                                   path.string()));
}

}  // namespace slew::plotting
