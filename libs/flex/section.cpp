// SPDX-License-Identifier: Apache-2.0
#include "flex/section.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/check.h"

namespace slew::flex {
namespace {

constexpr double kNoTorsion = std::numeric_limits<double>::infinity();
// terms of the series for rectangles: the last one left out is below 1e-9 of the sum
constexpr int kLastTerm = 99;
// Catalan's constant: the sum of (-1)^((n-1)/2)/n^2 over odd n, which converges too slowly for summation
constexpr double kCatalan = 0.915965594177219015;

double cube(double x) {
  return x * x * x;
}

double fourth(double x) {
  return x * x * x * x;
}

double rectangle_factor(double nu) {
  return 10 * (1 + nu) / (12 + 11 * nu);
}

// (4) for walls: m flanges over webs, extra E
double wall_factor(double m, double extra, double nu) {
  const double own = 12 + 72 * m + 150 * m * m + 90 * cube(m);
  const double lateral = nu * (11 + 66 * m + 135 * m * m + 90 * cube(m));
  return 10 * (1 + nu) * (1 + 3 * m) * (1 + 3 * m) / (own + lateral + extra);
}

double box_factor(double across, double along, double wall_across, double wall_along, double nu) {
  const double m = across * wall_across / (along * wall_along), n = across / along;
  return wall_factor(m, 10 * n * n * ((3 + nu) * m + 3 * m * m), nu);
}

// J of (1) and the torsion moduli in the middles of the long and the short sides, for sides h >= t
struct RectangleTorsion {
  double constant, modulus_long, modulus_short;
};

RectangleTorsion rectangle_torsion(double h, double t) {
  double fifths = 0, long_side = 0, short_side = kCatalan, sign = 1;
  for (int n = 1; n <= kLastTerm; n += 2, sign = -sign) {
    const double argument = n * M_PI * h / (2 * t), square = static_cast<double>(n) * n;
    fifths += std::tanh(argument) / (square * square * n);
    long_side += 1 / (square * std::cosh(std::min(argument, 700.0)));
    short_side -= sign * (1 - std::tanh(argument)) / square;
  }
  const double J = h * cube(t) * (1.0 / 3 - 64 / std::pow(M_PI, 5) * (t / h) * fifths);
  // shear stress per G and rate of twist: t [1 - (8/pi^2) sum ...] and (8 t/pi^2) sum ...
  const double eight = 8 / (M_PI * M_PI);
  return {J, J / (t * (1 - eight * long_side)), J / (t * eight * short_side)};
}

// corners without torsional stress of their own or with the given modulus, then middles of the sides
std::vector<SectionPoint> box_points(double b, double h, double corner, double at_y, double at_z) {
  return {{b / 2, h / 2, corner}, {-b / 2, h / 2, corner}, {-b / 2, -h / 2, corner}, {b / 2, -h / 2, corner},
          {b / 2, 0, at_y},       {0, h / 2, at_z},        {-b / 2, 0, at_y},        {0, -h / 2, at_z}};
}

std::vector<SectionPoint> round_points(double radius, double modulus) {
  return {{radius, 0, modulus}, {0, radius, modulus}, {-radius, 0, modulus}, {0, -radius, modulus}};
}

Section solid_rectangle(const SectionDef& def, double nu) {
  const double b = def.width, h = def.height;
  const RectangleTorsion torsion = rectangle_torsion(std::max(b, h), std::min(b, h));
  // a side along z is at y = b/2; it is a long one when h >= b
  const double at_y = h >= b ? torsion.modulus_long : torsion.modulus_short;
  const double at_z = h >= b ? torsion.modulus_short : torsion.modulus_long;
  return {b * h,
          b * cube(h) / 12,
          h * cube(b) / 12,
          torsion.constant,
          rectangle_factor(nu),
          rectangle_factor(nu),
          box_points(b, h, kNoTorsion, at_y, at_z)};
}

Section hollow_rectangle(const SectionDef& def, double nu) {
  const double b = def.width, h = def.height, web = def.wall, flange = def.flange > 0 ? def.flange : def.wall;
  const double b_in = b - 2 * web, h_in = h - 2 * flange, b_mid = b - web, h_mid = h - flange;
  const double enclosed = b_mid * h_mid;
  const double bredt = 4 * enclosed * enclosed / (2 * b_mid / flange + 2 * h_mid / web);
  const double J = bredt + (2 * b_mid * cube(flange) + 2 * h_mid * cube(web)) / 3;
  // shear flow T/(2 A_m); the corners get that of the thinner wall
  const double at_y = 2 * enclosed * web, at_z = 2 * enclosed * flange;
  return {b * h - b_in * h_in,
          (b * cube(h) - b_in * cube(h_in)) / 12,
          (h * cube(b) - h_in * cube(b_in)) / 12,
          J,
          box_factor(h_mid, b_mid, web, flange, nu),
          box_factor(b_mid, h_mid, flange, web, nu),
          box_points(b, h, std::min(at_y, at_z), at_y, at_z)};
}

Section i_section(const SectionDef& def, double nu) {
  const double b = def.width, h = def.height, tw = def.wall, tf = def.flange;
  const double h_in = h - 2 * tf, h_mid = h - tf, ratio = tw / tf;
  const double alpha = -0.042 + 0.2204 * ratio - 0.0725 * ratio * ratio, D = tf + tw * tw / (4 * tf);
  const double J = (2 * b * cube(tf) + h_in * cube(tw)) / 3 + 2 * alpha * fourth(D) - 0.42 * fourth(tf);  // (3)
  const double m = 2 * b * tf / (h_mid * tw), n = b / h_mid, A = 2 * b * tf + h_in * tw;
  const double extra = 30 * n * n * (m + m * m) + 5 * nu * n * n * (8 * m + 9 * m * m);
  const double tip = J / tf, web = J / tw;
  return {A,
          (b * cube(h) - (b - tw) * cube(h_in)) / 12,
          (2 * tf * cube(b) + h_in * cube(tw)) / 12,
          J,
          rectangle_factor(nu) * 2 * b * tf / A,
          wall_factor(m, extra, nu),
          {{b / 2, h / 2, tip},
           {-b / 2, h / 2, tip},
           {-b / 2, -h / 2, tip},
           {b / 2, -h / 2, tip},
           {tw / 2, 0, web},
           {-tw / 2, 0, web}}};
}

Section round_section(double outer, double inner, double nu) {
  const double A = M_PI / 4 * (outer * outer - inner * inner), I = M_PI / 64 * (fourth(outer) - fourth(inner));
  const double m2 = inner * inner / (outer * outer), sum2 = (1 + m2) * (1 + m2);
  const double factor = 6 * (1 + nu) * sum2 / ((7 + 6 * nu) * sum2 + (20 + 12 * nu) * m2);
  return {A, I, I, 2 * I, factor, factor, round_points(outer / 2, 2 * I / (outer / 2))};
}

Section shaped(const SectionDef& def, double nu) {
  switch (def.shape) {
    case SectionShape::hollow_rectangle:
      return hollow_rectangle(def, nu);
    case SectionShape::i_section:
      return i_section(def, nu);
    case SectionShape::tube:
      return round_section(def.diameter, def.diameter - 2 * def.wall, nu);
    case SectionShape::solid_rectangle:
      return solid_rectangle(def, nu);
    case SectionShape::solid_circle:
      return round_section(def.diameter, 0, nu);
    case SectionShape::given:
      break;
  }
  return {def.area, def.second_moment_y, def.second_moment_z, def.torsion_constant, 0, 0, def.points};
}

class SectionChecker {
 public:
  SectionChecker(const std::string& owner, Problems& problems) : owner_(owner), problems_(problems) {}

  void positive(const char* key, double value, const char* unit) {
    if (std::isfinite(value) && value > 0) return;
    problems_.push_back({owner_ + '.' + key,
                         fmt::format("{} {} is out of range", value, unit),
                         fmt::format("a number > 0 {}", unit),
                         {}});
    is_content_ = false;
  }
  void below(const char* key, double value, double bound, const std::string& why) {
    if (!is_content_ || value < bound) return;
    problems_.push_back({owner_ + '.' + key,
                         fmt::format("{} m fills the inside", value),
                         fmt::format("less than {} m, {}", bound, why),
                         {}});
  }
  void factor(const char* key, const std::optional<double>& value) {
    if (value) positive(key, *value, "");
  }
  // finite lengths may have powers that overflow
  void quantities(const Section& section) {
    for (const double value :
         {section.area, section.second_moment_y, section.second_moment_z, section.torsion_constant}) {
      if (std::isfinite(value) && value > 0) continue;
      problems_.push_back({owner_,
                           fmt::format("area {} m2, second moments {} and {} m4, torsion constant {} m4", section.area,
                                       section.second_moment_y, section.second_moment_z, section.torsion_constant),
                           "lengths that give positive ones",
                           {}});
      return;
    }
  }

 private:
  const std::string& owner_;
  Problems& problems_;
  bool is_content_ = true;
};

}  // namespace

void check_section(const std::string& owner, const SectionDef& def, Problems& problems) {
  const std::size_t before = problems.size();
  SectionChecker check(owner, problems);
  const bool is_round = def.shape == SectionShape::tube || def.shape == SectionShape::solid_circle;
  if (def.shape == SectionShape::given) {
    check.positive("area", def.area, "m2");
    check.positive("second_moment_y", def.second_moment_y, "m4");
    check.positive("second_moment_z", def.second_moment_z, "m4");
    check.positive("torsion_constant", def.torsion_constant, "m4");
  } else if (is_round) {
    check.positive("diameter", def.diameter, "m");
  } else {
    check.positive("width", def.width, "m");
    check.positive("height", def.height, "m");
  }
  const double flange = def.flange > 0 || def.shape == SectionShape::i_section ? def.flange : def.wall;
  if (def.shape == SectionShape::tube) {
    check.positive("wall", def.wall, "m");
    check.below("wall", def.wall, def.diameter / 2, "half of the diameter");
  } else if (def.shape == SectionShape::hollow_rectangle || def.shape == SectionShape::i_section) {
    check.positive("wall", def.wall, "m");
    check.positive("flange", flange, "m");
    const double room = def.shape == SectionShape::i_section ? def.width : def.width / 2;
    check.below("wall", def.wall, room, "the free width");
    check.below("flange", flange, def.height / 2, "half of the height");
  }
  check.factor("shear_factor_y", def.shear_factor_y);
  check.factor("shear_factor_z", def.shear_factor_z);
  if (problems.size() == before) check.quantities(shaped(def, 0));
}

Section make_section(const SectionDef& def, double poisson_ratio) {
  SLEW_ASSERT(poisson_ratio > -1 && poisson_ratio < 0.5);
  Section section = shaped(def, poisson_ratio);
  if (def.shear_factor_y) section.shear_factor_y = *def.shear_factor_y;
  if (def.shear_factor_z) section.shear_factor_z = *def.shear_factor_z;
  if (def.shear == Shear::none) section.shear_factor_y = section.shear_factor_z = 0;
  return section;
}

}  // namespace slew::flex
