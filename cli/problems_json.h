// SPDX-License-Identifier: Apache-2.0
// What --json prints where a verb has no result: the same object for every verb.
#pragma once

#include "core/failure.h"
#include "core/json.h"
#include "scene/diagnostic.h"

namespace slew::cli {

// {"ok": false, "code": 2, "problems": [{"file", "line", "column", "path", "what", "expected", "suggestion"}],
// "omitted"}
[[nodiscard]] Json problems_json(const scene::LoadError& error);

// The same form with one problem, whose "what" is the whole message.
[[nodiscard]] Json problems_json(const Failure& failure);

}  // namespace slew::cli
