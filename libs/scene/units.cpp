// SPDX-License-Identifier: Apache-2.0
#include "scene/units.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <udunits2.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cmath>
#include <mutex>
#include <numbers>
#include <stdexcept>
#include <system_error>
#include <utility>
#include <vector>

#include "core/suggestion.h"
#include "scene/number.h"

namespace slew::scene {
namespace {

// UDUNITS keeps its last status and its scanner in static variables
std::mutex& udunits_mutex() {
  static std::mutex mutex;
  return mutex;
}

constexpr std::size_t kLongestUnit = 60;

// a unit UDUNITS does not have under this name
struct AddedUnit {
  const char* name;
  const char* definition;
};
// gallons: 231 in3 (NIST Special Publication 811, 2008, appendix B) and 4.54609 l (Weights and Measures Act 1985,
// schedule 1), both exact; UDUNITS rounds that of the US
constexpr AddedUnit kAddedUnits[] = {{"deg", "arc_degree"},
                                     {"rev", "turn"},
                                     {"Nm", "N.m"},
                                     {"Nms", "N.m.s"},
                                     {"Ns", "N.s"},
                                     {"lpm", "l/min"},
                                     {"US_gal", "3.785411784e-3 m^3"},
                                     {"imp_gal", "4.54609e-3 m^3"}};

// names suggested for an unknown unit
constexpr std::string_view kCommonUnits[] = {
    "m",       "mm",    "cm",    "km",    "inch",  "m2",     "mm2",    "cm2",     "m3",     "cm3",     "cc",
    "l",       "kg",    "g",     "t",     "s",     "ms",     "us",     "min",     "h",      "rad",     "deg",
    "rev",     "m/s",   "mm/s",  "km/h",  "rad/s", "deg/s",  "rpm",    "m/s2",    "rad/s2", "N",       "kN",
    "Nm",      "kNm",   "kg m2", "Pa",    "kPa",   "MPa",    "bar",    "psi",     "1/Pa",   "1/bar",   "m3/s",
    "l/min",   "m2/s",  "mm2/s", "cSt",   "K",     "degC",   "J",      "kJ",      "W",      "kW",      "Hz",
    "kHz",     "N/m",   "kN/m",  "Ns/m",  "N s/m", "Nm/rad", "Nm/deg", "Nms/rad", "m3/rad", "cm3/rev", "cc/rev",
    "m3/s/Pa", "bar/s", "Pa/s",  "kg/m3", "%"};

// ---- restoring exact scales

constexpr long double kPi = std::numbers::pi_v<long double>;
// a few units in the last place of UDUNITS' double
constexpr long double kScaleTolerance = 2e-15L;
constexpr long double kLargestNumerator = 1e8L;

// x as numerator * 10^exponent / divisor with a short numerator, or nothing
std::optional<long double> short_decimal(long double x, long double divisor) {
  const long double t = x * divisor;
  const int exponent = static_cast<int>(std::floor(std::log10(t)));
  for (int digits = 0; digits <= 7; ++digits) {
    const int shift = digits - exponent;
    const long double power = std::pow(10.0L, static_cast<long double>(std::abs(shift)));
    const long double scaled = shift >= 0 ? t * power : t / power;
    const long double numerator = std::round(scaled);
    if (numerator < 1 || numerator > kLargestNumerator || std::abs(scaled - numerator) > kScaleTolerance * scaled)
      continue;
    return shift >= 0 ? numerator / (power * divisor) : numerator * power / divisor;
  }
  return std::nullopt;
}

long double exact_scale(double scale) {
  for (const long double factor : {1.0L, kPi}) {
    for (const long double divisor : {1.0L, 3.0L, 9.0L, 60.0L, 3600.0L}) {
      const auto found = short_decimal(static_cast<long double>(scale) / factor, divisor);
      if (found) return *found * factor;
      // also factor / decimal: deg/rev, 1/deg
      const auto inverse = short_decimal(factor / static_cast<long double>(scale), divisor);
      if (inverse) return factor / *inverse;
    }
  }
  // 1 / pi: per degree, per revolution
  for (const long double divisor : {1.0L, 60.0L}) {
    const auto found = short_decimal(static_cast<long double>(scale) * kPi, divisor);
    if (found) return *found / kPi;
  }
  return static_cast<long double>(scale);
}

long double exact_offset(double offset) {
  const auto found = offset > 0 ? short_decimal(static_cast<long double>(offset), 1.0L) : std::nullopt;
  return found.value_or(static_cast<long double>(offset));
}

// ---- properties of a unit from UDUNITS, through its visitor

struct Visit {
  const ut_system* system = nullptr;
  Unit unit;
  double scale = 1;
  double offset = 0;
};

constexpr const char* kBaseNames[] = {"kilogram", "meter", "second", "kelvin", "radian"};

void add_base(const ut_unit* base, int power, Visit& visit) {
  const char* name = ut_get_name(base, UT_ASCII);
  for (std::size_t i = 0; i < std::size(kBaseNames); ++i) {
    if (name != nullptr && std::string_view(name) == kBaseNames[i]) {
      visit.unit.exponent[i] = static_cast<std::int8_t>(visit.unit.exponent[i] + power);
      return;
    }
  }
  visit.unit.has_other_base = true;
}

ut_status visit_basic(const ut_unit* unit, void* context) {
  add_base(unit, 1, *static_cast<Visit*>(context));
  return UT_SUCCESS;
}
ut_status visit_product(const ut_unit*, int count, const ut_unit* const* bases, const int* powers, void* context) {
  for (int i = 0; i < count; ++i) {
    if (std::abs(powers[i]) > 100) return UT_MEANINGLESS;
    add_base(bases[i], powers[i], *static_cast<Visit*>(context));
  }
  return UT_SUCCESS;
}
ut_status visit_galilean(const ut_unit*, double scale, const ut_unit* inner, double offset, void* context);
ut_status visit_timestamp(const ut_unit*, const ut_unit*, double, void*) {
  return UT_MEANINGLESS;
}
ut_status visit_logarithmic(const ut_unit*, double, const ut_unit*, void*) {
  return UT_MEANINGLESS;
}

constexpr ut_visitor kVisitor = {visit_basic, visit_product, visit_galilean, visit_timestamp, visit_logarithmic};

// value = scale * (number + offset) in UDUNITS' terms
ut_status visit_galilean(const ut_unit*, double scale, const ut_unit* inner, double offset, void* context) {
  auto& visit = *static_cast<Visit*>(context);
  visit.scale = scale;
  visit.offset = offset;
  return ut_accept_visitor(inner, &kVisitor, context);
}

struct UnitDeleter {
  void operator()(ut_unit* unit) const noexcept { ut_free(unit); }
};
using UnitHandle = std::unique_ptr<ut_unit, UnitDeleter>;

bool is_letter(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
}

// A unit is words with digits as powers; "1" stands only before a slash ("1/Pa"). Keeps UDUNITS' scale factors
// out of scene files; its visitor refuses time stamps and logarithms.
bool looks_like_unit(std::string_view text) {
  if (text.empty() || text.size() > kLongestUnit) return false;
  if (text.starts_with("1/")) text.remove_prefix(2);
  if (text.empty() || !(is_letter(text.front()) || text.front() == '%')) return false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    const bool is_number = c >= '0' && c <= '9';
    if (is_number && i > 0 && (text[i - 1] == ' ' || text[i - 1] == '/' || text[i - 1] == '.' || text[i - 1] == '*'))
      return false;
    if (!is_number && !is_letter(c) && std::string_view(" /.*^-%_()").find(c) == std::string_view::npos) return false;
  }
  return true;
}

std::string article(std::string_view noun) {
  const bool vowel = std::string_view("aeiou").find(noun.front()) != std::string_view::npos;
  return (vowel ? "an " : "a ") + std::string(noun);
}

std::string name_of(Dimension dimension) {
  return article(info(dimension).name);
}

// The dimensions with these powers.
std::vector<Dimension> dimensions_of(const Exponents& exponent) {
  std::vector<Dimension> found;
  for (int i = 0; i < static_cast<int>(Dimension::number_of_dimensions); ++i) {
    const auto dimension = static_cast<Dimension>(i);
    // a unit of temperatures is named by these alone
    if (dimension == Dimension::flow_coefficient || dimension == Dimension::electric_signal ||
        dimension == Dimension::temperature_difference) {
      continue;
    }
    if (info(dimension).exponent == exponent) found.push_back(dimension);
  }
  return found;
}

// "a torque or an energy"; empty where no dimension has the unit.
std::string names_of(const Unit& unit) {
  std::string names;
  if (unit.has_other_base) return names;
  for (const Dimension dimension : dimensions_of(unit.exponent)) {
    names += (names.empty() ? "" : " or ") + name_of(dimension);
  }
  return names;
}

bool has_dimension(const Unit& unit, Dimension dimension) {
  if (dimension == Dimension::electric_signal || dimension == Dimension::flow_coefficient ||
      dimension == Dimension::number_of_dimensions) {
    return false;
  }
  return !unit.has_other_base && unit.exponent == info(dimension).exponent &&
         (unit.offset == 0 || dimension == Dimension::temperature);
}

// Spaces that a printed text holds and that look like a plain one: U+00A0, U+2007, U+2009, U+202F; empty: none.
std::string_view typographic_space_in(std::string_view text) {
  constexpr std::pair<std::string_view, std::string_view> kSpaces[] = {
      {"\xC2\xA0", "no-break space (U+00A0)"},
      {"\xE2\x80\x87", "figure space (U+2007)"},
      {"\xE2\x80\x89", "thin space (U+2009)"},
      {"\xE2\x80\xAF", "narrow no-break space (U+202F)"}};
  for (const auto& [bytes, name] : kSpaces) {
    if (text.find(bytes) != std::string_view::npos) return name;
  }
  return {};
}

// A word for several units, of which UDUNITS takes one, or another unit altogether: its ton is the short one, its
// gallon that of the US, its gpm a metre of geopotential.
struct AmbiguousWord {
  std::string_view word, meanings, choices;
};
constexpr std::string_view kGallons = "US_gal (3.785411784 l) or imp_gal (4.54609 l)";
constexpr std::string_view kGallonsPerMinute = "US_gal/min (3.785411784 l/min) or imp_gal/min (4.54609 l/min)";
constexpr std::string_view kQuarts = "a part of a US_gal (3.785411784 l) or of an imp_gal (4.54609 l), or l";
constexpr AmbiguousWord kAmbiguousWords[] = {
    {"ton", "several meanings", "t (1000 kg), short_ton (907.18474 kg) or long_ton (1016.0469088 kg)"},
    {"gal", "two meanings, US and imperial", kGallons},
    {"gallon", "two meanings, US and imperial", kGallons},
    {"gpm", "two meanings, US and imperial", kGallonsPerMinute},
    {"GPM", "two meanings, US and imperial", kGallonsPerMinute},
    {"quart", "two meanings, US and imperial", kQuarts},
    {"pint", "two meanings, US and imperial", kQuarts}};

// The ambiguous word in a unit; null: none.
const AmbiguousWord* ambiguous_word_in(std::string_view text) {
  const auto is_of_word = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; };
  for (std::size_t i = 0; i < text.size();) {
    std::size_t end = i;
    while (end < text.size() && is_of_word(text[end])) ++end;
    std::string_view word = text.substr(i, end - i);
    for (const std::string_view prefix : {"kilo", "mega"}) {
      if (word.starts_with(prefix)) word.remove_prefix(prefix.size());
    }
    for (const AmbiguousWord& ambiguous : kAmbiguousWords) {
      if (word == ambiguous.word || (word.ends_with('s') && word.substr(0, word.size() - 1) == ambiguous.word)) {
        return &ambiguous;
      }
    }
    i = end + 1;
  }
  return nullptr;
}

ValueProblem unknown_unit(std::string_view text, Dimension dimension, UnitSystem& units) {
  if (const AmbiguousWord* const ambiguous = ambiguous_word_in(text)) {
    return {fmt::format("unit '{}': '{}' has {}", text, ambiguous->word, ambiguous->meanings),
            std::string(ambiguous->choices), ""};
  }
  if (const std::string_view space = typographic_space_in(text); !space.empty()) {
    return {fmt::format("unknown unit '{}': it holds a {}, which looks like a plain space", text, space),
            expected_quantity(dimension), ""};
  }
  std::vector<std::string_view> fitting, all(std::begin(kCommonUnits), std::end(kCommonUnits));
  for (const std::string_view name : all) {
    const Unit* unit = units.find(name);
    if (unit != nullptr && has_dimension(*unit, dimension)) fitting.push_back(name);
  }
  std::string suggestion = closest(text, fitting);
  return {fmt::format("unknown unit '{}'", text), expected_quantity(dimension), std::move(suggestion)};
}

// Throws std::system_error if this process cannot open as many files at once as UDUNITS does, which reports no reason.
void require_files() {
  constexpr std::size_t kFiles = 4;
  std::array<int, kFiles> files{};
  std::size_t opened = 0;
  while (opened < kFiles && (files[opened] = ::open("/dev/null", O_RDONLY | O_CLOEXEC)) >= 0) ++opened;
  const int why = errno;
  for (std::size_t i = 0; i < opened; ++i) ::close(files[i]);
  if (opened < kFiles) throw std::system_error(why, std::generic_category(), "the unit database cannot be opened");
}

// UDUNITS' units and ours, read once in a process. Under udunits_mutex().
class Database {
 public:
  Database() {
    ut_set_error_message_handler(ut_ignore);
    system_.reset(ut_read_xml(nullptr));
    if (system_ == nullptr) {
      require_files();
      throw std::runtime_error("the unit database of UDUNITS-2 cannot be read; install libudunits2-data");
    }
    for (const AddedUnit& added : kAddedUnits) add(added);
  }

  [[nodiscard]] std::optional<Unit> parse(const std::string& text) const {
    const UnitHandle handle(ut_parse(system_.get(), text.c_str(), UT_UTF8));
    if (!handle) return std::nullopt;
    Visit visit;
    if (ut_accept_visitor(handle.get(), &kVisitor, &visit) != UT_SUCCESS) return std::nullopt;
    if (!std::isfinite(visit.scale) || visit.scale <= 0) return std::nullopt;
    visit.unit.scale = exact_scale(visit.scale);
    visit.unit.offset = visit.unit.scale * exact_offset(visit.offset);
    return visit.unit;
  }

 private:
  struct SystemDeleter {
    void operator()(ut_system* system) const { ut_free_system(system); }
  };

  void add(const AddedUnit& added) {
    const UnitHandle unit(ut_parse(system_.get(), added.definition, UT_UTF8));
    if (!unit) throw std::runtime_error(std::string("the unit database lacks ") + added.definition);
    // as a symbol it also takes the short prefixes: kNm
    ut_map_symbol_to_unit(added.name, UT_ASCII, unit.get());
  }

  std::unique_ptr<ut_system, SystemDeleter> system_;
};

const Database& database() {
  static const Database database;
  return database;
}

}  // namespace

UnitSystem::UnitSystem() {
  const std::lock_guard lock(udunits_mutex());
  static_cast<void>(database());
}

const Unit* UnitSystem::find(std::string_view text) {
  auto found = known_.find(text);
  if (found == known_.end()) {
    std::optional<Unit> unit;
    if (looks_like_unit(text) && ambiguous_word_in(text) == nullptr) {
      const std::lock_guard lock(udunits_mutex());
      unit = database().parse(std::string(text));
    }
    found = known_.emplace(std::string(text), unit).first;
  }
  return found->second ? &*found->second : nullptr;
}

bool is_plain_number(Dimension dimension) {
  return dimension == Dimension::none || dimension == Dimension::electric_signal ||
         dimension == Dimension::flow_coefficient || dimension == Dimension::number_of_dimensions;
}

std::string expected_quantity(Dimension dimension) {
  if (is_plain_number(dimension)) return "a number without unit";
  const DimensionInfo& about = info(dimension);
  return article(about.name) + " such as '" + std::string(about.example) + "', or a bare number in " +
         std::string(about.si_unit);
}

std::string name_of(const Exponents& exponent) {
  if (exponent == Exponents{}) return "a number";
  const std::string names = names_of(Unit{.exponent = exponent});
  return names.empty() ? "a quantity in " + si_unit_of(exponent) : names;
}

std::string si_unit_of(const Exponents& exponent) {
  if (exponent == Exponents{}) return "";
  const std::vector<Dimension> dimensions = dimensions_of(exponent);
  if (!dimensions.empty()) return std::string(info(dimensions.front()).si_unit);
  constexpr std::string_view kBases[] = {"kg", "m", "s", "K", "rad"};
  std::string text;
  for (std::size_t i = 0; i < exponent.size(); ++i) {
    if (exponent[i] == 0) continue;
    text += fmt::format("{}{}", text.empty() ? "" : " ", kBases[i]);
    if (exponent[i] != 1) text += std::to_string(exponent[i]);
  }
  return text;
}

std::string with_unit(double value, Dimension dimension) {
  std::string text = fmt::format("{}", value == 0 ? 0.0 : value);  // -0 is 0
  if (!is_plain_number(dimension)) text += fmt::format(" {}", info(dimension).si_unit);
  return text;
}

namespace {

// quantity: text quoted in the message
UnitResult find_unit(std::string_view text, Dimension dimension, UnitSystem& units, std::string_view quantity) {
  const Unit* unit = units.find(text);
  if (unit == nullptr) return {nullptr, unknown_unit(text, dimension, units)};
  if (has_dimension(*unit, dimension)) return {unit, {}};
  const std::string found = names_of(*unit);
  std::string what = fmt::format("'{}' is {}", quantity, found.empty() ? "not " + name_of(dimension) : found);
  return {nullptr, {std::move(what), expected_quantity(dimension), ""}};
}

}  // namespace

UnitResult read_unit(std::string_view text, Dimension dimension, UnitSystem& units) {
  return find_unit(text, dimension, units, text);
}

QuantityResult read_quantity(std::string_view text, Writing writing, Dimension dimension, UnitSystem& units) {
  const NumberText number = split_number(text);
  if (!number.is_number) {
    ValueProblem problem = number.problem;
    if (problem.expected.empty()) problem.expected = expected_quantity(dimension);
    return {std::nullopt, std::move(problem)};
  }
  // a bare number is SI; in quotes it is a text without its unit
  if (number.rest.empty()) {
    if (writing == Writing::plain) return {static_cast<double>(number.value), {}};
    const std::string what = is_plain_number(dimension) ? " is in quotes" : " is in quotes and has no unit";
    return {std::nullopt, {fmt::format("'{}'{}", text, what), expected_quantity(dimension), ""}};
  }
  UnitResult found = find_unit(number.rest, dimension, units, text);
  const Unit* unit = found.unit;
  if (unit == nullptr) return {std::nullopt, std::move(found.problem)};
  const long double value = number.value * unit->scale + unit->offset;
  if (!std::isfinite(static_cast<double>(value))) {
    return {std::nullopt, {fmt::format("'{}' is beyond what a number can hold", text), "a finite number", ""}};
  }
  return {static_cast<double>(value), {}};
}

}  // namespace slew::scene
