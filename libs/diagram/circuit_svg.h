// SPDX-License-Identifier: Apache-2.0
// The diagram of a hydraulic circuit as SVG.
//
// Elements for programs: every symbol is a group with `data-element`, the name of the component; every volume has its
// name and lines in groups with `data-volume`. Both have an empty text of class `value`, in which a page shows values.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "diagram/circuit_layout.h"

namespace slew::diagram {

// Colours of the diagram for a light and for a dark ground, and its kinds of lines; beside plotting::kStyle.
extern const std::string_view kDiagramStyle;

// The diagram with its legend, without <svg> and style: for a picture that holds more. Its size: layout_size().
[[nodiscard]] std::string circuit_group(const CircuitLayout& layout);

struct PictureSize {
  double width = 0, height = 0;  // px
};
[[nodiscard]] PictureSize circuit_size(const CircuitLayout& layout);

// A file of its own.
[[nodiscard]] std::string circuit_svg(const CircuitLayout& layout);

}  // namespace slew::diagram
