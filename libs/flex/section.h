// SPDX-License-Identifier: Apache-2.0
// Cross-sections of beams: from dimensions, or from given numbers.
//
// y and z are the section's principal axes through its centroid, which is taken as the shear centre too.
//   A = integral dA,  Iyy = integral z^2 dA,  Izz = integral y^2 dA                      exact for sharp corners
//   J: solid circle, tube   J = Iyy + Izz                                                exact
//      solid rectangle      J = h t^3 [1/3 - (64/pi^5) (t/h) sum tanh(n pi h/(2 t))/n^5], n odd, t <= h       (1)
//      hollow rectangle     J = 4 A_m^2/oint(ds/t) + oint(t^3 ds)/3                      Bredt, and the wall  (2)
//      I                    J = (2 b t_f^3 + (h - 2 t_f) t_w^3)/3 + 2 alpha D^4 - 0.42 t_f^4                  (3)
//                           alpha = -0.042 + 0.2204 t_w/t_f - 0.0725 (t_w/t_f)^2,  D = t_f + t_w^2/(4 t_f)
//   shear factors by Cowper with Poisson's ratio nu (A_s = k A); 0 stands for a section that is rigid in shear:
//      solid circle 6(1+nu)/(7+6nu),  solid rectangle 10(1+nu)/(12+11nu)
//      tube, m = d_i/d_o: 6(1+nu)(1+m^2)^2/[(7+6nu)(1+m^2)^2 + (20+12nu) m^2]
//      walls, n = b/h, m = flanges over webs: 10(1+nu)(1+3m)^2/[(12+72m+150m^2+90m^3) + nu(11+66m+135m^2+90m^3) + E],
//      hollow rectangle: m = b t_f/(h t_w), E = 10 n^2 ((3+nu) m + 3 m^2)
//      I along its web:  m = 2 b t_f/(h t_w), E = 30 n^2 (m+m^2) + 5 nu n^2 (8m+9m^2)                         (4)
//      I along its flanges: that of the two flanges as solid rectangles, over the whole area
// b, h in (4) are between the middles of the walls.
// Sources: (1) Timoshenko & Goodier 1970, art. 109; (2) Bredt 1896, as in EN 10219-2; (3) El Darwish & Johnston 1965,
// without fillet; (4) Cowper 1966, table 1. Not covered: warping, fillets, sections without two axes of symmetry other
// than by given numbers, shear stress of transverse forces. Card: docs/models/flex_beam_elements.md.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/problem.h"

namespace slew::flex {

// Point of stress output.
struct SectionPoint {
  double y = 0, z = 0;                    // m, from the centroid
  std::optional<double> torsion_modulus;  // torque over shear stress there [m3], infinite without shear stress
};

struct Section {
  double area = 0;              // A [m2]
  double second_moment_y = 0;   // Iyy [m4]: bending in the x-z plane
  double second_moment_z = 0;   // Izz [m4]: bending in the x-y plane
  double torsion_constant = 0;  // J [m4]
  double shear_factor_y = 0;    // k_y, 0: rigid in shear along y
  double shear_factor_z = 0;    // k_z
  std::vector<SectionPoint> points;
};

enum class SectionShape : int { given, hollow_rectangle, i_section, tube, solid_rectangle, solid_circle };
enum class Shear : int { timoshenko, none };  // none: Euler and Bernoulli's beam

struct SectionDef {
  SectionShape shape = SectionShape::given;
  double width = 0;     // along y [m]: rectangles, flanges of I
  double height = 0;    // along z [m]: rectangles, I over all
  double wall = 0;      // wall of a tube, webs (normal to y) of hollow rectangle and I [m]
  double flange = 0;    // the walls normal to z [m]; 0 in a hollow rectangle: as wall
  double diameter = 0;  // outer diameter of tube and solid circle [m]
  // shape given: the numbers and points themselves; its shear factors default to 0
  double area = 0, second_moment_y = 0, second_moment_z = 0, torsion_constant = 0;
  std::vector<SectionPoint> points = {};
  Shear shear = Shear::timoshenko;
  // replaces Cowper's [1], > 0
  std::optional<double> shear_factor_y = {}, shear_factor_z = {};
};

// Appends problems, under owner.
void check_section(const std::string& owner, const SectionDef& def, Problems& problems);

// poisson_ratio: -1 < nu < 0.5, of the section's material. Pre-condition: check_section found no problem. Points:
// corners and middles of the sides (rectangles), tips of the flanges and middle of the web (I), four on the
// circumference (round ones).
[[nodiscard]] Section make_section(const SectionDef& def, double poisson_ratio);

}  // namespace slew::flex
