// SPDX-License-Identifier: Apache-2.0
#include "plotting/html_text.h"

#include "core/json.h"

namespace slew::plotting {

std::string in_script(std::string text) {
  for (std::size_t at = 0; (at = text.find("</", at)) != std::string::npos; at += 3) text.replace(at, 2, "<\\/");
  return text;
}

std::string json_string(std::string_view text) {
  return Json(text).dump();
}

}  // namespace slew::plotting
