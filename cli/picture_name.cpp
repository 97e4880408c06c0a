// SPDX-License-Identifier: Apache-2.0
#include "cli/picture_name.h"

#include <filesystem>

namespace slew::cli {

std::string problem_of_picture_name(const std::string& path) {
  const std::string ending = std::filesystem::path(path).extension().string();
  if (path == "-" || path.starts_with("/dev/") || ending == ".svg" || ending == ".html") return "";
  return "'" + path + "' ends neither in .svg nor in .html, the formats of pictures and pages; another program makes " +
         "others of an .svg, such as rsvg-convert a .png";
}

}  // namespace slew::cli
