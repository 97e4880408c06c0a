// One curve over time: plain numbers with a name and a unit, wherever they come from.
#pragma once

#include <string>
#include <vector>

namespace slew::plotting {

struct Series {
  std::string name;            // "Cyl_Lift.force"
  std::string unit;            // "kN", as it shall be shown; empty: dimensionless
  std::vector<double> time;    // s, ascending; a step back (a reset of the session) starts a new line
  std::vector<double> values;  // as many as times, in the unit; NaN and infinity are gaps
};

}  // namespace slew::plotting
