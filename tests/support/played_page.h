// SPDX-License-Identifier: Apache-2.0
// Runs the script of a page with Node.js and a stand-in for the browser, page_stub.js.
#pragma once

#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>

#include "build_paths.h"
#include "tests/support/temporary_folder.h"

namespace slew::testing {

inline bool has_node() {
  return std::system("node --version > /dev/null 2>&1") == 0;
}

// Result of the driver's drive(); null when the script failed, with its messages on standard error.
inline nlohmann::json played_page(const std::string& page, const std::string& driver) {
  const TemporaryFolder folder("played_page");
  const std::string html = (folder.path() / "page.html").string(), script = (folder.path() / "driver.js").string();
  std::ofstream(html, std::ios::binary) << page;
  std::ofstream(script, std::ios::binary) << driver;
  const std::string command = "node " SLEWRING_SOURCE_DIR "/tests/support/page_stub.js '" + html + "' '" + script + "'";
  FILE* const pipe = popen(command.c_str(), "r");
  if (pipe == nullptr) return nullptr;
  std::string out;
  std::array<char, 4096> block{};
  for (std::size_t got = 0; (got = fread(block.data(), 1, block.size(), pipe)) > 0;) out.append(block.data(), got);
  const bool has_failed = pclose(pipe) != 0;
  const nlohmann::json result = nlohmann::json::parse(out, nullptr, false);
  return has_failed || result.is_discarded() ? nlohmann::json(nullptr) : result;
}

}  // namespace slew::testing
