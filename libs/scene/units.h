// SPDX-License-Identifier: Apache-2.0
// Quantities: a number with a unit, checked against a dimension, in SI.
//
// UDUNITS-2 parses the unit and provides the scales; the dimension check is done here, because UDUNITS takes Hz for
// rad/s and rad for 1. Here the angle is a base dimension (core/dimension.h). Added to its database: deg, rev, Nm, Nms,
// Ns, lpm, US_gal, imp_gal; refused in it, with the choices: ton, gal, gallon, gpm, quart, pint. Scales that are short
// decimals, such decimals over 60 or 3600, or those times pi are restored exactly: UDUNITS keeps an inch as
// 0.025400000000000002 m. So "1050 mm" and 1.05 are the same bits.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "core/dimension.h"
#include "scene/diagnostic.h"

namespace slew::scene {

using Exponents = std::array<std::int8_t, 5>;  // powers of kg, m, s, K, rad

struct Unit {
  long double scale = 1;        // SI value = number * scale + offset
  long double offset = 0;       // degC, degF
  Exponents exponent{};         // powers of kg, m, s, K, rad
  bool has_other_base = false;  // mole, ampere, candela, ...
};

// Not for use by two threads at once; the instances of one process share UDUNITS' database, under a lock.
class UnitSystem {
 public:
  // Throws std::runtime_error when the database cannot be read.
  UnitSystem();

  // Null if the unit does not exist.
  [[nodiscard]] const Unit* find(std::string_view text);

 private:
  std::map<std::string, std::optional<Unit>, std::less<>> known_;
};

// Notation of a quantity.
enum class Writing { plain, quoted };

// The value in SI of "250 bar", of "2.5e7" (plain: already SI), or its problem.
struct QuantityResult {
  std::optional<double> value;
  ValueProblem problem;
};
[[nodiscard]] QuantityResult read_quantity(std::string_view text, Writing writing, Dimension dimension,
                                           UnitSystem& units);

// The unit of a column of numbers, or its problem: "mm" for a length. The pointer lasts as long as `units`.
struct UnitResult {
  const Unit* unit = nullptr;
  ValueProblem problem;
};
[[nodiscard]] UnitResult read_unit(std::string_view text, Dimension dimension, UnitSystem& units);

// True for dimensions whose values are written without a unit; a fraction may be in %.
[[nodiscard]] bool is_plain_number(Dimension dimension);

// "a pressure such as '250 bar', or a bare number in Pa"
[[nodiscard]] std::string expected_quantity(Dimension dimension);

// Dimensions with these powers, for messages: "a torque or an energy", "a quantity in kg m s-2 rad", "a number".
[[nodiscard]] std::string name_of(const Exponents& exponent);

// SI unit with these powers, as a scene may state it: "N m", "kg m2 rad"; empty for a number.
[[nodiscard]] std::string si_unit_of(const Exponents& exponent);

// A value with its SI unit for messages: "0.5 kg", "0.5".
[[nodiscard]] std::string with_unit(double value, Dimension dimension);

}  // namespace slew::scene
