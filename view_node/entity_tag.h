// SPDX-License-Identifier: Apache-2.0
// Entity tags of HTTP (RFC 9110, 8.8.3 and 13.1): a client names the state of a content that it has.
#pragma once

#include <string>
#include <string_view>

namespace slew::view_node {

// Conditions of a request; empty: not stated.
struct Conditions {
  std::string_view if_match, if_none_match;
};

// Strong entity tag of a content, with its quotes.
[[nodiscard]] std::string entity_tag(std::string_view content);

// A list of tags, or *, has this one.
[[nodiscard]] bool has_tag(std::string_view list, std::string_view tag) noexcept;

}  // namespace slew::view_node
