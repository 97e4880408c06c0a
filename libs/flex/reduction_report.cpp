// SPDX-License-Identifier: Apache-2.0
#include "flex/reduction_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace slew::flex {

using math::Mat3;
using math::Vec3;

namespace {

std::vector<int> held_rows(const FeModel& model, const std::vector<int>& clamped) {
  std::vector<int> rows;
  for (const int id : clamped) {
    const FeNode& node = model.nodes[find_node(model, id, "clamped_nodes")];
    for (int a = 0; a < node.freedoms; ++a) rows.push_back(node.first + a);
  }
  std::sort(rows.begin(), rows.end());
  return rows;
}

void add_compliance(ReductionReport& report, const TipCompliance& tip, const std::vector<std::size_t>& kept) {
  report.tip = tip.tip;
  report.reference_nodes = tip.reference_nodes;
  for (std::size_t a = 0; a < 3 && tip.is_known(); ++a)
    report.compliance.push_back({"xyz"[a], tip.full[a], tip.share(kept)[a] * tip.full[a]});
}

// full: frequencies of the whole model, none without it
void add_modes(ReductionReport& report, const ReducedBody& body, const std::vector<std::size_t>& kept,
               const std::vector<double>& full) {
  for (std::size_t k = 0; k < body.modes(); ++k) {
    ModeFigures mode;
    mode.ordinal = static_cast<int>(k) + 1;
    mode.is_kept = std::find(kept.begin(), kept.end(), k) != kept.end();
    mode.full = k < full.size() ? full[k] : 0;
    mode.reduced = body.omega[k];
    mode.relative_error = mode.full > 0 ? mode.reduced / mode.full - 1 : 0;
    for (int a = 0; a < 3; ++a) {
      const double mass = body.C[k][a] * body.C[k][a];
      mode.effective_mass[static_cast<std::size_t>(a)] = mass;
      if (mode.is_kept) report.kept_effective_mass[a] += mass;
    }
    report.modes.push_back(mode);
  }
}

std::vector<std::size_t> kept_places(std::span<const int> kept, std::size_t modes) {
  std::vector<int> ordinals(kept.begin(), kept.end());
  for (std::size_t k = 0; kept.empty() && k < modes; ++k) ordinals.push_back(static_cast<int>(k) + 1);
  return places_of(ordinals, modes);
}

// values below this share of their scale are rounding, printed as 0
constexpr double kRounding = 1e-12;

std::string vector_text(Vec3 v, double scale, const char* form = "{:.6g}, {:.6g}, {:.6g}") {
  const auto clean = [&](double x) { return std::abs(x) > kRounding * scale ? x : 0.0; };
  return fmt::format(fmt::runtime(form), clean(v.x()), clean(v.y()), clean(v.z()));
}

void add_mass_text(std::string& text, const ReductionReport& report) {
  const auto line = [&](const char* what, const std::string& full, const std::string& reduced) {
    if (report.has_model)
      fmt::format_to(std::back_inserter(text), "  {:<34}{:<40}{}\n", what, full, reduced);
    else
      fmt::format_to(std::back_inserter(text), "  {:<34}{}\n", what, reduced);
  };
  const RigidMass &b = report.reduced_mass, &a = report.has_model ? report.full_mass : b;
  const Mat3 I = central_inertia(a), J = central_inertia(b);
  const double whole = I(0, 0) + I(1, 1) + I(2, 2), size = norm(centre_of(a)) + std::sqrt(whole / a.mass);
  line("", "whole model", "reduced body");
  line("mass [kg]", fmt::format("{:.9g}", a.mass), fmt::format("{:.9g}", b.mass));
  line("centre [m]", vector_text(centre_of(a), size), vector_text(centre_of(b), size));
  line("inertia about it xx yy zz [kg m2]", vector_text({I(0, 0), I(1, 1), I(2, 2)}, whole),
       vector_text({J(0, 0), J(1, 1), J(2, 2)}, whole));
  line("inertia about it xy xz yz [kg m2]", vector_text({I(0, 1), I(0, 2), I(1, 2)}, whole),
       vector_text({J(0, 1), J(0, 2), J(1, 2)}, whole));
}

void add_mode_text(std::string& text, const ReductionReport& report) {
  const auto out = std::back_inserter(text);
  const double mass = report.reduced_mass.mass;
  fmt::format_to(out, "\n  mode          {}reduced [Hz]{}   effective mass x, y, z [kg]\n",
                 report.has_model ? "whole model [Hz]  " : "  ", report.has_model ? "  relative error" : "");
  for (const ModeFigures& mode : report.modes) {
    const auto& m = mode.effective_mass;
    const std::string effective = vector_text({m[0], m[1], m[2]}, mass, "{:.4g}, {:.4g}, {:.4g}");
    fmt::format_to(out, "  {:>4} {:<8}", mode.ordinal, mode.is_kept ? "kept" : "dropped");
    if (report.has_model)
      fmt::format_to(out, "{:>17.6g}{:>14.6g}{:>16.2e}   {}\n", mode.full / (2 * M_PI), mode.reduced / (2 * M_PI),
                     mode.relative_error, effective);
    else
      fmt::format_to(out, "{:>13.6g}   {}\n", mode.reduced / (2 * M_PI), effective);
  }
  const double* kept = report.kept_effective_mass;
  fmt::format_to(out, "  effective mass of the kept modes: {:.1f} %, {:.1f} %, {:.1f} % of the mass along x, y, z\n",
                 100 * kept[0] / mass, 100 * kept[1] / mass, 100 * kept[2] / mass);
}

void add_compliance_text(std::string& text, const ReductionReport& report) {
  const auto out = std::back_inserter(text);
  if (report.compliance.empty()) {
    fmt::format_to(out, "\n  static compliance: not available, the reference node does not hold the body\n");
    return;
  }
  fmt::format_to(out, "\n  static compliance of node {} with node {} held\n", report.tip,
                 fmt::join(report.reference_nodes, ", "));
  fmt::format_to(out, "  direction   {} [m/N]   kept modes [m/N]   reached\n",
                 report.has_model ? "whole model" : "  all modes");
  for (const ComplianceFigures& c : report.compliance)
    fmt::format_to(out, "  {:<12}{:>17.6g}{:>19.6g}{:>8.2f} %\n", c.direction, c.full, c.kept, 100 * c.share());
}

void add_head_text(std::string& text, const ReductionReport& report) {
  const Source& s = report.source;
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "{}: {}\n", s.model, s.made_of);
  fmt::format_to(out, "  body frame {}{}{}, interface nodes {}\n",
                 s.attachment == Attachment::clamped ? "clamped at node " : "free", fmt::join(s.clamped_nodes, ", "),
                 s.attachment == Attachment::clamped ? "" : " (modes without momentum)",
                 fmt::join(s.interface_nodes, ", "));
}

}  // namespace

ReductionReport report_reduction(const FeModel& model, const ReductionDef& def, const Reduction& all,
                                 std::span<const int> kept) {
  const std::vector<std::size_t> places = kept_places(kept, all.body.modes());
  ReductionReport report;
  report.source = all.source;
  report.freedoms = model.freedoms();
  const std::vector<int> held = held_rows(model, all.source.clamped_nodes);
  report.held_freedoms = static_cast<int>(held.size());
  report.full_mass = rigid_mass(model);
  report.reduced_mass = {all.body.mass, all.body.s0, all.body.W0};
  const double lowest = all.body.modes() > 0 ? all.body.omega[0] * all.body.omega[0] : 1;
  add_modes(report, all.body, places,
            full_frequencies(model, held, static_cast<int>(all.body.modes()), lowest, def.modes.method));
  add_compliance(report, tip_compliance(model, all), places);
  return report;
}

ReductionReport report_files(const Reduction& all, std::span<const int> kept) {
  const std::vector<std::size_t> places = kept_places(kept, all.body.modes());
  ReductionReport report;
  report.has_model = false;
  report.source = all.source;
  report.reduced_mass = {all.body.mass, all.body.s0, all.body.W0};
  add_modes(report, all.body, places, {});
  add_compliance(report, tip_compliance(all), places);
  return report;
}

std::string text_of(const ReductionReport& report) {
  const Source& s = report.source;
  std::string text;
  add_head_text(text, report);
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "  {} nodes, {} elements, ", s.nodes, s.elements);
  if (report.has_model) fmt::format_to(out, "{} freedoms: {} held, ", report.freedoms, report.held_freedoms);
  fmt::format_to(out, "{} {}of interfaces, {} inside\n", s.boundary_freedoms, report.has_model ? "" : "freedoms ",
                 s.interior_freedoms);
  const auto kept =
      std::count_if(report.modes.begin(), report.modes.end(), [](const ModeFigures& m) { return m.is_kept; });
  fmt::format_to(out, "  {} modes from {} of the interfaces and {} inside; {} kept\n\n", report.modes.size(),
                 s.boundary_freedoms, s.fixed_interface_modes, kept);
  add_mass_text(text, report);
  if (s.elements == 0)
    fmt::format_to(out, "  the mass matrix is off m_ij 1 by {:.2e}; modal masses of the integrals by {:.2e}\n",
                   s.deviation.block, s.deviation.modal);
  add_mode_text(text, report);
  add_compliance_text(text, report);
  return text;
}

std::string summary_of(const Reduction& all, const TipCompliance& tip) {
  ReductionReport report;
  report.source = all.source;
  const RigidMass mass{all.body.mass, all.body.s0, all.body.W0};
  std::string text;
  add_head_text(text, report);
  const auto out = std::back_inserter(text);
  const Vec3 centre = centre_of(mass);
  fmt::format_to(out, "  mass {:.6g} kg, centre {} m\n", mass.mass, vector_text(centre, norm(centre)));
  std::vector<std::string> hertz;
  for (const double omega : all.body.omega) hertz.push_back(fmt::format("{:.4g}", omega / (2 * M_PI)));
  fmt::format_to(out, "  {} modes: {} Hz\n", hertz.size(), fmt::join(hertz, ", "));
  if (!tip.is_known()) return text;
  fmt::format_to(out, "  static compliance of node {} along x, y, z: {:.4g}, {:.4g}, {:.4g} m/N\n", tip.tip,
                 tip.full[0], tip.full[1], tip.full[2]);
  std::vector<std::size_t> places;
  for (std::size_t k = 0; k < all.body.modes(); ++k) {
    places.push_back(k);
    if (k != 1 && k != 3 && k + 1 != all.body.modes()) continue;
    const std::array<double, 3> share = tip.share(places);
    fmt::format_to(out, "    modes 1 to {:<4} reach {:.2f}, {:.2f}, {:.2f} %\n", k + 1, 100 * share[0], 100 * share[1],
                   100 * share[2]);
  }
  return text;
}

}  // namespace slew::flex
