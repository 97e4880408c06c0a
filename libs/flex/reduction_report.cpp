#include "flex/reduction_report.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <iterator>

namespace slew::flex {

using Eigen::Index;
using Eigen::MatrixXd;
using math::Mat3;
using math::Vec3;

namespace {

double component(Vec3 v, int a) {
  return v[a];
}

// rows of phi (and psi) of the nodes by mode
MatrixXd displacements(const FeModel& model, const ReducedBody& body, const std::vector<std::size_t>& nodes) {
  Index rows = 0;
  for (const std::size_t i : nodes) rows += model.nodes[i].freedoms;
  MatrixXd u(rows, static_cast<Index>(body.modes()));
  Index row = 0;
  for (const std::size_t i : nodes) {
    for (int a = 0; a < model.nodes[i].freedoms; ++a, ++row) {
      for (std::size_t k = 0; k < body.modes(); ++k) {
        const ReducedNode& node = body.nodes[i];
        u(row, static_cast<Index>(k)) = a < 3 ? component(node.phi[k], a) : component(node.psi[k], a - 3);
      }
    }
  }
  return u;
}

std::vector<int> rows_of(const FeModel& model, const std::vector<std::size_t>& nodes) {
  std::vector<int> rows;
  for (const std::size_t i : nodes) {
    for (int a = 0; a < model.nodes[i].freedoms; ++a) rows.push_back(model.nodes[i].first + a);
  }
  return rows;
}

// (1) by direction and mode; no rows when the reference nodes leave a rigid motion free
MatrixXd seen_from(const FeModel& model, const ReducedBody& body, const std::vector<std::size_t>& reference,
                   std::size_t tip) {
  const Eigen::Matrix<double, Eigen::Dynamic, 6> R = rigid_motions(model, model.nodes[reference.front()].position);
  const std::vector<int> rows = rows_of(model, reference);
  MatrixXd held(static_cast<Index>(rows.size()), 6);
  for (std::size_t i = 0; i < rows.size(); ++i) held.row(static_cast<Index>(i)) = R.row(rows[i]);
  const SmallSolution motion = solve_small(held, displacements(model, body, reference));
  if (motion.rank < 6) return MatrixXd(0, static_cast<Index>(body.modes()));
  const MatrixXd tip_motion = displacements(model, body, {tip}).topRows(3);
  return tip_motion - R.middleRows(model.nodes[tip].first, 3) * motion.x;
}

void add_compliance(ReductionReport& report, const FeModel& model, const Reduction& all,
                    const std::vector<std::size_t>& kept) {
  const Source& source = all.source;
  report.tip = source.interface_nodes.back();
  report.reference_nodes = source.clamped_nodes;
  if (source.attachment == Attachment::free) report.reference_nodes = {source.interface_nodes.front()};
  const std::size_t tip = find_node(model, report.tip, "tip");
  std::vector<std::size_t> reference;
  for (const int id : report.reference_nodes) reference.push_back(find_node(model, id, "reference_nodes"));
  const MatrixXd Psi = seen_from(model, all.body, reference, tip);
  if (Psi.rows() == 0 || std::find(reference.begin(), reference.end(), tip) != reference.end()) return;
  std::vector<int> held = rows_of(model, reference);
  std::sort(held.begin(), held.end());
  const int first = model.nodes[tip].first;
  const MatrixXd full = static_answer(model, held, {first, first + 1, first + 2});
  for (int a = 0; a < 3; ++a) {
    ComplianceFigures figures{"xyz"[a], full(first + a, a), 0};
    for (const std::size_t k : kept) {
      const double share = Psi(a, static_cast<Index>(k)) / all.body.omega[k];
      figures.kept += share * share;
    }
    report.compliance.push_back(figures);
  }
}

void add_modes(ReductionReport& report, const FeModel& model, const ReductionDef& def, const Reduction& all,
               const std::vector<std::size_t>& kept, const std::vector<int>& held) {
  const ReducedBody& body = all.body;
  const double lowest = body.modes() > 0 ? body.omega[0] * body.omega[0] : 1;
  const std::vector<double> full =
      full_frequencies(model, held, static_cast<int>(body.modes()), lowest, def.modes.method);
  for (std::size_t k = 0; k < body.modes(); ++k) {
    ModeFigures mode;
    mode.ordinal = static_cast<int>(k) + 1;
    mode.is_kept = std::find(kept.begin(), kept.end(), k) != kept.end();
    mode.full = k < full.size() ? full[k] : 0;
    mode.reduced = body.omega[k];
    mode.relative_error = mode.full > 0 ? mode.reduced / mode.full - 1 : 0;
    for (int a = 0; a < 3; ++a) {
      const double mass = component(body.C[k], a) * component(body.C[k], a);
      mode.effective_mass[static_cast<std::size_t>(a)] = mass;
      if (mode.is_kept) report.kept_effective_mass[a] += mass;
    }
    report.modes.push_back(mode);
  }
}

// values below this share of their scale are rounding, printed as 0
constexpr double kRounding = 1e-12;

std::string vector_text(Vec3 v, double scale, const char* form = "{:.6g}, {:.6g}, {:.6g}") {
  const auto clean = [&](double x) { return std::abs(x) > kRounding * scale ? x : 0.0; };
  return fmt::format(fmt::runtime(form), clean(v.x()), clean(v.y()), clean(v.z()));
}

Vec3 centre_of(const RigidMass& m) {
  return m.first * (1 / m.mass);
}

Mat3 central_inertia(const RigidMass& m) {
  const Vec3 c = centre_of(m);
  return inertia_of(m.second - outer(c, c) * m.mass);
}

void add_mass_text(std::string& text, const ReductionReport& report) {
  const auto line = [&](const char* what, const std::string& full, const std::string& reduced) {
    fmt::format_to(std::back_inserter(text), "  {:<34}{:<40}{}\n", what, full, reduced);
  };
  const RigidMass &a = report.full_mass, &b = report.reduced_mass;
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
  fmt::format_to(out,
                 "\n  mode          whole model [Hz]  reduced [Hz]  relative error   effective mass x, y, z [kg]\n");
  for (const ModeFigures& mode : report.modes) {
    const auto& m = mode.effective_mass;
    fmt::format_to(out, "  {:>4} {:<8}{:>17.6g}{:>14.6g}{:>16.2e}   {}\n", mode.ordinal,
                   mode.is_kept ? "kept" : "dropped", mode.full / (2 * M_PI), mode.reduced / (2 * M_PI),
                   mode.relative_error,
                   vector_text({m[0], m[1], m[2]}, report.full_mass.mass, "{:.4g}, {:.4g}, {:.4g}"));
  }
  const double mass = report.full_mass.mass;
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
  fmt::format_to(out, "  direction   whole model [m/N]   kept modes [m/N]   reached\n");
  for (const ComplianceFigures& c : report.compliance)
    fmt::format_to(out, "  {:<12}{:>17.6g}{:>19.6g}{:>8.2f} %\n", c.direction, c.full, c.kept, 100 * c.share());
}

}  // namespace

ReductionReport report_reduction(const FeModel& model, const ReductionDef& def, const Reduction& all,
                                 std::span<const int> kept) {
  std::vector<int> ordinals(kept.begin(), kept.end());
  for (std::size_t k = 0; kept.empty() && k < all.body.modes(); ++k) ordinals.push_back(static_cast<int>(k) + 1);
  const std::vector<std::size_t> places = places_of(ordinals, all.body.modes());
  ReductionReport report;
  report.source = all.source;
  report.freedoms = model.freedoms();
  std::vector<std::size_t> clamped;
  for (const int id : all.source.clamped_nodes) clamped.push_back(find_node(model, id, "clamped_nodes"));
  std::vector<int> held = rows_of(model, clamped);
  std::sort(held.begin(), held.end());
  report.held_freedoms = static_cast<int>(held.size());
  report.full_mass = rigid_mass(model);
  report.reduced_mass = {all.body.mass, all.body.s0, all.body.W0};
  add_modes(report, model, def, all, places, held);
  add_compliance(report, model, all, places);
  return report;
}

std::string text_of(const ReductionReport& report) {
  const Source& s = report.source;
  std::string text = fmt::format("{}: {}\n", s.model, s.made_of);
  const auto out = std::back_inserter(text);
  fmt::format_to(out, "  body frame {}{}{}, interface nodes {}\n",
                 s.attachment == Attachment::clamped ? "clamped at node " : "free", fmt::join(s.clamped_nodes, ", "),
                 s.attachment == Attachment::clamped ? "" : " (modes without momentum)",
                 fmt::join(s.interface_nodes, ", "));
  fmt::format_to(out, "  {} nodes, {} elements, {} freedoms: {} held, {} of interfaces, {} inside\n", s.nodes,
                 s.elements, report.freedoms, report.held_freedoms, s.boundary_freedoms, s.interior_freedoms);
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

}  // namespace slew::flex
