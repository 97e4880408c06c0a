// SPDX-License-Identifier: Apache-2.0
// Names of pictures, and the colours of the lamps.
#include <gtest/gtest.h>

#include "cli/status_line.h"
#include "plotting/html_plot.h"

namespace slew::cli {
namespace display_test {

TEST(PictureName, EndsInSvgOrHtml) {
  for (const char* name : {"a.svg", "folder.d/a.html", "-", "/dev/stdout"})
    EXPECT_EQ(plotting::problem_of_picture_name(name), "");
  for (const char* name : {"a.png", "a", "a.svg.gz", "svg", "a.SVG"}) {
    EXPECT_NE(plotting::problem_of_picture_name(name).find("ends neither in .svg nor in .html"), std::string::npos)
        << name;
  }
}

TEST(Lamps, HaveTheirColoursAndNothingElseHas) {
  EXPECT_EQ(with_coloured_lamps("  1.00 s  running  coupling green  Green.x 1 m"),
            "  1.00 s  running  coupling \x1b[32mgreen\x1b[0m  Green.x 1 m");
  EXPECT_EQ(with_coloured_lamps("  coupling red/amber/green, force off"),
            "  coupling \x1b[31mred\x1b[0m/\x1b[33mamber\x1b[0m/\x1b[32mgreen\x1b[0m, force off");
  EXPECT_EQ(with_coloured_lamps("waiting for the session, red"), "waiting for the session, red");
  EXPECT_EQ(with_coloured_lamps("  coupling "), "  coupling ");
}

}  // namespace display_test
}  // namespace slew::cli
