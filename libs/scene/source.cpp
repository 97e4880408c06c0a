#include "scene/source.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <utility>

#include "core/printable.h"

namespace slew::scene {
namespace {

struct FileCloser {
  void operator()(std::FILE* file) const noexcept { std::fclose(file); }
};

// What is wrong with the character at a byte, or nothing.
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

Complaint too_large(std::size_t bytes) {
  return {"is " + megabytes(bytes) + " large", "at most " + megabytes(kMaxFileBytes), ""};
}

// The kind and size of the file, before it is opened.
std::optional<Complaint> refuse_file(const std::string& path) {
  struct stat status = {};
  if (::stat(path.c_str(), &status) != 0) {
    return Complaint{std::string("cannot be read: ") + std::strerror(errno), "", ""};
  }
  if (S_ISDIR(status.st_mode)) return Complaint{"is a directory", "a file", ""};
  if (!S_ISREG(status.st_mode)) return Complaint{"is not a regular file", "a file", ""};
  if (static_cast<std::size_t>(status.st_size) > kMaxFileBytes) {
    return too_large(static_cast<std::size_t>(status.st_size));
  }
  return std::nullopt;
}

}  // namespace

namespace {

// continuation bytes are not characters of their own
int characters(std::string_view text) {
  return static_cast<int>(
      std::count_if(text.begin(), text.end(), [](char c) { return (static_cast<std::uint8_t>(c) & 0xC0) != 0x80; }));
}

}  // namespace

Mark SourceText::mark_at(std::size_t byte) const {
  return MarkReader(*this).at(byte);
}

Mark MarkReader::at(std::size_t byte) {
  const std::vector<std::size_t>& starts = source_.line_start;
  const auto next = std::upper_bound(starts.begin(), starts.end(), byte);
  const auto line = static_cast<std::size_t>(next - starts.begin());
  const std::size_t end = std::min(byte, source_.text.size());
  const bool goes_on = last_.line > 0 && starts[line - 1] == start_ && end >= byte_;
  const std::size_t from = goes_on ? byte_ : starts[line - 1];
  const int before = goes_on ? last_.column : 1;
  last_ = {source_.source, static_cast<int>(line),
           before + characters(std::string_view(source_.text).substr(from, end - from))};
  byte_ = end;
  start_ = starts[line - 1];
  return last_;
}

std::string text_problem(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); i += sequence_length(text, i)) {
    std::string problem = character_problem(text, i);
    if (!problem.empty()) return problem;
  }
  return {};
}

std::optional<SourceText> check_source(std::string text, int source, Report& report) {
  if (text.size() > kMaxFileBytes) {
    report.add({source, 0, 0}, "", too_large(text.size()));
    return std::nullopt;
  }
  if (text.starts_with("\xEF\xBB\xBF")) text.erase(0, 3);
  SourceText result{source, std::move(text), {0}};
  for (std::size_t i = 0; i < result.text.size();) {
    std::string problem = character_problem(result.text, i);
    if (!problem.empty()) {
      if (result.text[i] == '\0') problem += ": this is not a text file";
      report.add(result.mark_at(i), "", {std::move(problem), "UTF-8 text", ""});
      return std::nullopt;
    }
    if (result.text[i] == '\n') result.line_start.push_back(i + 1);
    i += sequence_length(result.text, i);
  }
  return result;
}

std::optional<SourceText> read_source(const std::string& path, int source, Report& report) {
  const Mark whole{source, 0, 0};
  if (const auto complaint = refuse_file(path)) {
    report.add(whole, "", *complaint);
    return std::nullopt;
  }
  const std::unique_ptr<std::FILE, FileCloser> file(std::fopen(path.c_str(), "rb"));
  if (!file) {
    report.add(whole, "", {std::string("cannot be read: ") + std::strerror(errno), "", ""});
    return std::nullopt;
  }
  // a file that grows while it is read stops at the limit
  std::string text;
  std::array<char, 65536> block;
  while (text.size() <= kMaxFileBytes) {
    const std::size_t count = std::fread(block.data(), 1, block.size(), file.get());
    text.append(block.data(), count);
    if (count < block.size()) break;
  }
  if (std::ferror(file.get()) != 0) {
    report.add(whole, "", {std::string("cannot be read: ") + std::strerror(errno), "", ""});
    return std::nullopt;
  }
  return check_source(std::move(text), source, report);
}

}  // namespace slew::scene
