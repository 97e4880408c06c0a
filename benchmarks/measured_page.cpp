// SPDX-License-Identifier: Apache-2.0
#include "benchmarks/measured_page.h"

#include <fstream>
#include <sstream>

namespace slew::benchmarks {

bool replace_measured(const std::filesystem::path& page, const std::string& text) {
  const std::string begin = "<!-- measured: begin -->\n", end = "<!-- measured: end -->";
  std::stringstream old;
  old << std::ifstream(page, std::ios::binary).rdbuf();
  const std::string content = old.str();
  const std::size_t from = content.find(begin), to = content.find(end);
  if (from == std::string::npos || to == std::string::npos || to < from) return false;
  std::ofstream out(page, std::ios::binary);
  out << content.substr(0, from + begin.size()) << text << content.substr(to);
  out.close();
  return out.good();
}

}  // namespace slew::benchmarks
