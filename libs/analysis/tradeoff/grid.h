// SPDX-License-Identifier: Apache-2.0
// The settings of a scene that are tried: axes of restart parameters, and rows that choose a value on some of them.
//
// An axis is a path as `--set` takes it ("session.step") with its values as texts. This code does not depend on the
// meaning of a setting: the scene's own rules decide whether it can run with a value, and a refused row stays in the
// table with the reason. Only the list of default axes is fixed; each is present when the scene contains its subject,
// with the choices that the field tables list.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scene/scene.h"
#include "scene/scene_options.h"

namespace slew::analysis {

struct Axis {
  std::string path;
  std::vector<std::string> values;
};

// Path and value: the changes of a row, in the order of the axes.
using Settings = std::vector<std::pair<std::string, std::string>>;

enum class GridSize { modest, full };

// "session.step=0.5ms,1ms,2ms"; values with commas of their own in brackets or quotes. Throws Failure (bad_input).
[[nodiscard]] Axis parse_axis(const std::string& text);

// Default axes of the scene: communication step, coupling, formulation, integrators, tolerances, modes, contact.
[[nodiscard]] std::vector<Axis> default_axes(const scene::Scene& scene);

// Grid of the scene's own axes: nothing changed, then every value alone, then the product: of the steps, couplings and
// tolerances that matter most together (modest), or of all (full). Without repetitions.
[[nodiscard]] std::vector<Settings> default_grid(std::span<const Axis> axes, GridSize size);
// Nothing changed, then the product.
[[nodiscard]] std::vector<Settings> product_grid(std::span<const Axis> axes);

// "session.step=2ms"
[[nodiscard]] scene::Overrides overrides_of(const Settings& settings);
// "step 2ms, coupling hold"; "as it is" without settings
[[nodiscard]] std::string text_of(const Settings& settings);

}  // namespace slew::analysis
