// SPDX-License-Identifier: Apache-2.0
#include "plotting/csv_export.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <ostream>
#include <string_view>
#include <vector>

namespace slew::plotting {
namespace {

constexpr std::size_t kBlockBytes = 1u << 16;

void append_text(fmt::memory_buffer& line, std::string_view text) {
  if (text.find_first_of(",\"\r\n") == std::string_view::npos) {
    line.append(text);
    return;
  }
  line.push_back('"');
  for (const char c : text) {
    if (c == '"') line.push_back('"');
    line.push_back(c);
  }
  line.push_back('"');
}

void append_number(fmt::memory_buffer& line, double value) {
  // the spellings that spreadsheets, MATLAB and pandas read
  if (std::isnan(value)) {
    line.append(std::string_view("NaN"));
  } else if (std::isinf(value)) {
    line.append(value > 0 ? std::string_view("Inf") : std::string_view("-Inf"));
  } else {
    fmt::format_to(fmt::appender(line), "{}", value);
  }
}

void append_head(fmt::memory_buffer& line, std::span<const Series> series) {
  append_text(line, "time [s]");
  for (const Series& s : series) {
    line.push_back(',');
    append_text(line, s.unit.empty() ? s.name : fmt::format("{} [{}]", s.name, s.unit));
  }
  line.push_back('\n');
}

}  // namespace

void write_csv(std::span<const Series> series, std::ostream& out) {
  fmt::memory_buffer block;
  append_head(block, series);
  // merge the curves by time
  std::vector<std::size_t> next(series.size(), 0);
  while (true) {
    bool any = false;
    double time = 0;
    for (std::size_t i = 0; i < series.size(); ++i) {
      while (next[i] < size_of(series[i]) && std::isnan(series[i].time[next[i]])) ++next[i];
      if (next[i] == size_of(series[i])) continue;
      const double candidate = series[i].time[next[i]];
      if (!any || candidate < time) time = candidate;
      any = true;
    }
    if (!any) break;
    append_number(block, time);
    for (std::size_t i = 0; i < series.size(); ++i) {
      block.push_back(',');
      if (next[i] < size_of(series[i]) && series[i].time[next[i]] == time) {
        append_number(block, series[i].values[next[i]++]);
      }
    }
    block.push_back('\n');
    if (block.size() > kBlockBytes) {
      out.write(block.data(), static_cast<std::streamsize>(block.size()));
      block.clear();
    }
  }
  out.write(block.data(), static_cast<std::streamsize>(block.size()));
}

Status export_csv(std::span<const Series> series, const std::filesystem::path& path) {
  std::ofstream file(path, std::ios::binary | std::ios::trunc);
  if (file) write_csv(series, file);
  file.close();
  if (file) return Status::ok();
  return Status::error(ExitCode::storage,
                       fmt::format("{}: cannot write the table ({}); nothing whole was written; free space or choose "
                                   "another place with -o",
                                   path.string(), std::strerror(errno)));
}

}  // namespace slew::plotting
