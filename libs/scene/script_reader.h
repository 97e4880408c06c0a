// SPDX-License-Identifier: Apache-2.0
// Reads `script:`: the scene's own operator, in the scene or in a file beside it.
//
//   script:
//     interpolation: linear
//     inputs:
//       Input_Lift: [[0, 0], [1 s, 1], [3 s, 1], [3.5 s, 0]]      points [time, raw value]
//     parameters:
//       - {at: 5 s, set: Bag.mass, value: 1500 kg, over: 1 s}
// or
//   script: {file: manoeuvre.csv}      a column `time` and one for each input, in any order (csv_table.h)
//   script: {file: log.csv, columns: [Stick]}       these columns of it
//   script: {file: levers.lcm}         the inputs of an LCM event log (lcm_log/input_table.h)
//   script: {file: manoeuvre.yaml}     the keys of `script:` except file
#pragma once

#include "scene/expand.h"
#include "scene/field_reader.h"
#include "scene/names.h"
#include "scene/scene.h"
#include "scene/yaml_tree.h"

namespace slew::scene {

// Pre-condition: all elements of the scene are read. Problems go to the context's report.
void read_script(const Node& section, const Mark& place, const LoadContext& load_context, const NameTable& names,
                 Scene& scene, const ReadContext& context);

}  // namespace slew::scene
