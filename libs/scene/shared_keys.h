// SPDX-License-Identifier: Apache-2.0
// The keys of a section's types for the reference (schema.h): each fact once, however many types have it.
//
// A type refers to an earlier one that it has nearly all keys of; keys of three types or more stand once before all
// types; a type names those that it has of another one. What remains are its own items.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "scene/field_entry.h"

namespace slew::scene {

struct TypeOfSection {
  std::string name;
  std::vector<FieldEntry> entries;
};

struct SharedKeys {
  std::vector<FieldEntry> common;            // of several types, shown before them
  std::vector<std::string> references;       // by type: sentences, empty without one
  std::vector<std::vector<FieldEntry>> own;  // by type: entries that it shows itself
};

[[nodiscard]] SharedKeys shared_keys(const std::vector<TypeOfSection>& types);

}  // namespace slew::scene
