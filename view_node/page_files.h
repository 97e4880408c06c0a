// SPDX-License-Identifier: Apache-2.0
// Files of the page: from a folder, or the built-in page of the program.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace slew::view_node {

enum class Packing : bool { none, gzip };

struct PageFile {
  std::string content;
  std::string_view type;  // of HTTP's Content-Type
  Packing packing = Packing::none;
};

// path: as gateway::judge() gives it, of plain names. None: there is no such file, it is no regular file inside the
// folder, or it has more than 64 MiB. folder: empty for the built-in page.
// packing: gzip: the file with .gz behind its name, if it is beside it and not older.
[[nodiscard]] std::optional<PageFile> read_page_file(const std::string& folder, const std::string& path,
                                                     Packing packing = Packing::none);

// The folder of the built page: share/slewring/web of the program's prefix, or web of its build. Empty: there is none.
[[nodiscard]] std::string find_page();

}  // namespace slew::view_node
