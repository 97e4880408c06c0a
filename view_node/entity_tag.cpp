// SPDX-License-Identifier: Apache-2.0
#include "view_node/entity_tag.h"

#include "core/comma_list.h"
#include "scene/assets.h"

namespace slew::view_node {
namespace {

constexpr std::size_t kTagDigits = 32;

}  // namespace

std::string entity_tag(std::string_view content) {
  return "\"" + scene::hex_text(scene::sha256_of(content)).substr(0, kTagDigits) + "\"";
}

bool has_tag(std::string_view list, std::string_view tag) noexcept {
  while (!list.empty()) {
    const std::string_view one = take_listed(list);
    if (one == "*" || one == tag) return true;
  }
  return false;
}

}  // namespace slew::view_node
