// SPDX-License-Identifier: Apache-2.0
// What an editor of a scene shows, as JSON: the kinds of elements with their fields, and the elements of a text.
#pragma once

#include <string>
#include <vector>

#include "core/failure.h"
#include "core/json.h"
#include "scene/scene.h"

namespace slew::scene {

// [{section, type, doc, is_default, is_single, fields: [{key, type, unit, range, doc, default, required, live, choices,
// reference, read_with}]}] of all elements and of the sections that are one map of fields, from the field tables.
[[nodiscard]] Json kinds_json();

// The content of a scene file in the place of the one that is there:
//   elements  [{name, section, type, line, fields: {key: {text, line, column}}, given: {key: {text, place}}, place}] in
//             the order of the sections. text: as written; given: by a template or an included file; place: "file:line"
//             of an element that the text does not have: an included file's, or an instance's
//   points    [{name, body, position}] named points of bodies, position [m] in the body's frame; none where the scene
//             cannot be written out
//   problems  [{file, line, column, path, what, expected, suggestion}] of the loader, omitted: number of further ones
//   warnings  of the loader
// A text that is no YAML has problems alone. Does not throw for faults of the text.
[[nodiscard]] Json outline_json(const std::string& path, const std::string& text, const Overrides& overrides);

// [{file, line, column, path, what, expected, suggestion}] of the loader.
[[nodiscard]] Json diagnostics_json(const LoadError& error);

// What --json prints where a verb has no result: {"ok": false, "code": 2, "problems": [{"file", "line", "column",
// "path", "what", "expected", "suggestion"}], "omitted"}
[[nodiscard]] Json problems_json(const LoadError& error);

// The same form with one problem, whose "what" is the whole message.
[[nodiscard]] Json problems_json(const Failure& failure);

// A change of a text: {"set": path, "value": text}, {"add": name, "section", "type"}, {"copy": name, "to": name},
// {"rename": name, "to": name}, {"remove": name}, or {}, which changes nothing. A rename is refused while included
// files name the element, which are not edited; the notes list their places.
struct EditedText {
  std::string text;                  // after a refusal as before
  std::string refusal{};             // with the place where it can be changed, if there is one
  std::vector<std::string> notes{};  // of TextEdit
};
// Throws Failure (bad_input) for a request of another form.
[[nodiscard]] EditedText edit_text(const std::string& path, const std::string& text, const Json& request);

}  // namespace slew::scene
