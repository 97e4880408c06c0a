// SPDX-License-Identifier: Apache-2.0
// Warnings of values that no hydraulic liquid has, most of them numbers in another unit.
//
//   bulk modulus          1e8 .. 1e10 Pa      oil 1.4e9 to 2e9, water 2.2e9; below: walls or air counted with the oil
//   density               500 .. 2500 kg/m3   petrol 700, oil 870, phosphate ester 1150, fluorinated liquids 1900
//   kinematic viscosity   1e-8 .. 0.02 m2/s   water 1e-6, oil 5e-6 to 1e-3, cold oil 0.01
//   compressibility       1e-10 .. 1e-8 1/Pa  of the density parabola
//   specific heat         500 .. 10000 J/(kg K)  oil 1900, water 4200
//   reference of the air  1e3 .. 1e7 Pa
// The limits are wider than the liquids by a factor of 2 to 100: they find wrong units, not wrong oils. A warning names
// the unit in which the number would be that of an oil.
#pragma once

#include "core/problem.h"
#include "hydraulics/hydraulics_def.h"

namespace slew::hydraulics {

void find_implausible_oil(const HydraulicsDef& def, Problems& warnings);

}  // namespace slew::hydraulics
