// SPDX-License-Identifier: Apache-2.0
#include "scene/diagnostic.h"

#include <algorithm>
#include <utility>

#include "core/printable.h"

namespace slew::scene {
namespace {

std::string join(const std::vector<Diagnostic>& diagnostics, std::size_t omitted) {
  std::string text;
  for (const Diagnostic& diagnostic : diagnostics) {
    if (!text.empty()) text += '\n';
    text += diagnostic.text();
  }
  if (omitted > 0) text += "\nand " + std::to_string(omitted) + " more";
  return text;
}

}  // namespace

std::string Diagnostic::text() const {
  std::string text = printable(file);
  if (line > 0) text += ':' + std::to_string(line);
  if (line > 0 && column > 0) text += ':' + std::to_string(column);
  text += ": ";
  if (!path.empty()) text += printable(path) + ": ";
  return text + ValueProblem{what, expected, suggestion}.text();
}

std::string ValueProblem::text() const {
  std::string text = printable_lines(what);
  if (!expected.empty()) text += "; expected " + printable(expected);
  if (!suggestion.empty()) text += "; did you mean '" + printable(suggestion) + "'?";
  return text;
}

LoadError::LoadError(std::vector<Diagnostic> diagnostics, std::size_t omitted)
    : std::runtime_error(join(diagnostics, omitted)), diagnostics_(std::move(diagnostics)), omitted_(omitted) {}

std::string LoadError::first_reason() const {
  const Diagnostic& first = diagnostics_.front();
  std::string text = first.path.empty() ? first.what : first.path + ": " + first.what;
  if (!first.expected.empty()) text += "; expected " + first.expected;
  return printable_lines(text);
}

int Report::add_source(std::string label, Lines lines) {
  sources_.push_back({std::move(label), lines});
  return static_cast<int>(sources_.size()) - 1;
}

bool Report::is_override(const Mark& mark) const noexcept {
  return sources_[static_cast<std::size_t>(mark.source)].lines == Lines::none;
}

int Report::layer(const Mark& mark) const noexcept {
  return is_override(mark) ? layers_ + 1 : sources_[static_cast<std::size_t>(mark.source)].layer;
}

Diagnostic Report::at(const Mark& mark, std::string path, ValueProblem problem) const {
  const Source& source = sources_.at(static_cast<std::size_t>(mark.source));
  const bool is_numbered = source.lines == Lines::numbered;
  // the label of an override contains its path
  if (!is_numbered && source.label.starts_with("--set " + path + "=")) path.clear();
  return {.file = source.label,
          .line = is_numbered ? mark.line : 0,
          .column = is_numbered ? mark.column : 0,
          .path = std::move(path),
          .what = std::move(problem.what),
          .expected = std::move(problem.expected),
          .suggestion = std::move(problem.suggestion)};
}

void Report::add(const Mark& mark, std::string path, ValueProblem problem) {
  entries_.push_back({mark, at(mark, std::move(path), std::move(problem))});
}

void Report::fail(std::size_t limit) const {
  std::vector<Entry> sorted = entries_;
  std::stable_sort(sorted.begin(), sorted.end(), [](const Entry& a, const Entry& b) { return a.mark < b.mark; });
  const std::size_t shown = std::min(limit, sorted.size());
  std::vector<Diagnostic> diagnostics;
  for (std::size_t i = 0; i < shown; ++i) diagnostics.push_back(std::move(sorted[i].diagnostic));
  throw LoadError(std::move(diagnostics), sorted.size() - shown);
}

}  // namespace slew::scene
