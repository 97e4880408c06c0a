// SPDX-License-Identifier: Apache-2.0
// Elements that all pictures have, appended to their text.
#pragma once

#include <fmt/format.h>

#include <iterator>
#include <string>
#include <string_view>
#include <utility>

namespace slew::plotting {

template <typename... Values>
void put(std::string& out, fmt::format_string<Values...> format, Values&&... values) {
  fmt::format_to(std::back_inserter(out), format, std::forward<Values>(values)...);
}

// The beginning: size [px], common look, white background. "</svg>" ends the picture.
void put_head(std::string& out, double width, double height);

// kind: class of kStyle. The line is at half pixels, where one of one pixel is sharp.
void put_line(std::string& out, std::string_view kind, double x1, double y1, double x2, double y2);

// Ten with a raised exponent, as content of a text.
[[nodiscard]] std::string power_of_ten(int exponent);
// Behind an axis' unit: the factor of its labels; empty for 1.
[[nodiscard]] std::string factor_text(int exponent);

}  // namespace slew::plotting
