// SPDX-License-Identifier: Apache-2.0
// The common look of all pictures: fonts and colours.
#pragma once

#include <array>
#include <string_view>

namespace slew::plotting {

// distinguishable also with a colour deficiency and in print
inline constexpr std::array<std::string_view, 8> kColours = {"#1b6ca8", "#d95f02", "#2a9d5c", "#b8327a",
                                                             "#7b5cc4", "#b8860b", "#2ba3b8", "#5f6670"};

[[nodiscard]] constexpr std::string_view colour_of(std::size_t i) {
  return kColours[i % kColours.size()];
}

inline constexpr std::string_view kStyle =
    "text{font-family:Inter,'Helvetica Neue',Arial,'DejaVu Sans',sans-serif;font-size:12px;fill:#3c434b}"
    ".title{font-size:17px;font-weight:600;fill:#1d2227}.sub{fill:#6a727b}"
    ".heading{font-size:13px;font-weight:600;fill:#1d2227}"
    ".unit{font-weight:600;fill:#1d2227}.tick{fill:#5d656e}.end{text-anchor:end}.mid{text-anchor:middle}"
    ".grid{stroke:#e7eaed;stroke-width:1}.zero{stroke:#b3bac1;stroke-width:1}.axis{stroke:#8a929a;stroke-width:1}"
    ".curve{fill:none;stroke-width:1.6;stroke-linejoin:round;stroke-linecap:round}.dash{stroke-dasharray:6 4}";

// Width at 12 px [px], of the widest of the fonts.
[[nodiscard]] double text_width(std::string_view text);

}  // namespace slew::plotting
