// SPDX-License-Identifier: Apache-2.0
#include "scene/source.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <utility>

#include "core/input_file.h"
#include "core/printable.h"

namespace slew::scene {
namespace {

// The fault of the character at a byte, or nothing.
std::string character_problem(std::string_view text, std::size_t at) {
  const auto byte = static_cast<std::uint8_t>(text[at]);
  if (byte == 0) return "NUL byte";
  if (byte == 0x7F || (byte < 0x20 && byte != '\t' && byte != '\n' && byte != '\r')) {
    return fmt::format("control character 0x{:02X}", byte);
  }
  if (sequence_length(text, at) == 0) return fmt::format("bad UTF-8: byte 0x{:02X} does not belong here", byte);
  return {};
}

std::string megabytes(std::size_t bytes) {
  return fmt::format("{:.1f} MB", static_cast<double>(bytes) * 1e-6);
}

int characters(std::string_view text) {
  // continuation bytes are not characters of their own
  return static_cast<int>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<std::uint8_t>(c) & 0xC0) != 0x80; }));
}

}  // namespace

Mark SourceText::mark_at(std::size_t byte) const {
  const auto next = std::upper_bound(line_start.begin(), line_start.end(), byte);
  const auto line = static_cast<std::size_t>(next - line_start.begin());
  const std::size_t start = line_start[line - 1];
  return {source, static_cast<int>(line), 1 + characters(std::string_view(text).substr(start, byte - start))};
}

std::size_t SourceText::byte_of(const Mark& mark) const {
  const auto line = static_cast<std::size_t>(mark.line);
  if (line == 0 || line > line_start.size()) return text.size();
  std::size_t at = line_start[line - 1];
  for (int passed = 1; at < text.size(); ++at) {
    const bool begins_character = (static_cast<std::uint8_t>(text[at]) & 0xC0) != 0x80;
    if (begins_character && passed++ == mark.column) break;
  }
  return at;
}

std::string text_problem(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); i += sequence_length(text, i)) {
    std::string problem = character_problem(text, i);
    if (!problem.empty()) return problem;
  }
  return {};
}

std::optional<SourceText> check_source(std::string text, int source, Report& report, std::size_t most) {
  if (text.size() > most) {
    report.add({source, 0, 0}, "", {"is " + megabytes(text.size()) + " large", "at most " + megabytes(most), ""});
    return std::nullopt;
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  SourceText result{source, std::move(text), {0}};
  if (result.text.starts_with("\xFF\xFE") || result.text.starts_with("\xFE\xFF")) {
    report.add({source, 1, 1}, "", {"the file is UTF-16", "UTF-8 text: save it as UTF-8", ""});
    return std::nullopt;
  }
  for (std::size_t i = 0; i < result.text.size();) {
    const char c = result.text[i];
    const bool is_printable = c >= 0x20 && c < 0x7F;
    if (!is_printable) {
      std::string problem = character_problem(result.text, i);
      if (!problem.empty()) {
        if (c == '\0') problem += ": this is not a text file";
        report.add(result.mark_at(i), "", {std::move(problem), "UTF-8 text", ""});
        return std::nullopt;
      }
      if (c == '\n') result.line_start.push_back(i + 1);
    }
    i += is_printable ? 1 : sequence_length(result.text, i);
  }
  return result;
}

std::optional<SourceText> read_source(const std::string& path, int source, Report& report, std::size_t most) {
  std::string text;
  if (std::optional<InputFault> fault = read_input(path, most, text)) {
    report.add({source, 0, 0}, "", {std::move(fault->what), std::move(fault->expected), ""});
    return std::nullopt;
  }
  return check_source(std::move(text), source, report, most);
}

}  // namespace slew::scene
