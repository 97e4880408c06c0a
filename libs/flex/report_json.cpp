// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "core/json.h"
#include "flex/attachment_comparison.h"
#include "flex/reduction_report.h"

namespace slew::flex {
namespace {

Json list(math::Vec3 v) {
  return Json::array({v.x(), v.y(), v.z()});
}

Json mass_json(const RigidMass& mass) {
  const math::Mat3 inertia = central_inertia(mass);
  return {{"mass", mass.mass},
          {"centre", list(centre_of(mass))},
          {"inertia", Json::array({inertia(0, 0), inertia(1, 1), inertia(2, 2)})},
          {"products", Json::array({inertia(0, 1), inertia(0, 2), inertia(1, 2)})}};
}

Json source_json(const Source& source) {
  return {{"model", source.model},
          {"made_of", source.made_of},
          {"attachment", source.attachment == Attachment::clamped ? "clamped" : "free"},
          {"clamped_nodes", source.clamped_nodes},
          {"interface_nodes", source.interface_nodes},
          {"nodes", source.nodes},
          {"elements", source.elements},
          {"boundary_freedoms", source.boundary_freedoms},
          {"interior_freedoms", source.interior_freedoms},
          {"fixed_interface_modes", source.fixed_interface_modes},
          {"stiffening", source.stiffening == GeometricStiffening::straight_beam ? "straight_beam" : "none"}};
}

Json mode_json(const ModeFigures& mode, bool has_model) {
  Json out = {{"mode", mode.ordinal},     {"kept", mode.is_kept},
              {"full_hz", Json()},        {"reduced_hz", mode.reduced / (2 * M_PI)},
              {"relative_error", Json()}, {"effective_mass", mode.effective_mass}};
  if (!has_model) return out;
  out["full_hz"] = mode.full / (2 * M_PI);
  out["relative_error"] = mode.relative_error;
  return out;
}

}  // namespace

Json report_json(const ReductionReport& report) {
  Json modes = Json::array(), directions = Json::array();
  for (const ModeFigures& mode : report.modes) modes.push_back(mode_json(mode, report.has_model));
  for (const ComplianceFigures& c : report.compliance) {
    directions.push_back({{"direction", std::string(1, c.direction)},
                          {report.has_model ? "full" : "all_modes", c.full},
                          {"kept", c.kept},
                          {"share", c.share()}});
  }
  Json out = {
      {"has_model", report.has_model},
      {"source", source_json(report.source)},
      {"freedoms", Json()},
      {"held_freedoms", Json()},
      {"full_mass", Json()},
      {"reduced_mass", mass_json(report.reduced_mass)},
      {"modes", modes},
      {"kept_effective_mass", report.kept_effective_mass},
      {"compliance", {{"tip", report.tip}, {"reference_nodes", report.reference_nodes}, {"directions", directions}}}};
  if (!report.has_model) return out;
  out["freedoms"] = report.freedoms;
  out["held_freedoms"] = report.held_freedoms;
  out["full_mass"] = mass_json(report.full_mass);
  return out;
}

Json report_json(const AttachmentComparison& comparison) {
  Json rows = Json::array();
  for (const AttachmentShares& row : comparison.rows) {
    Json one = {{"modes", row.modes}, {"clamped", Json()}, {"free", Json()}};
    if (row.clamped) one["clamped"] = *row.clamped;
    if (row.free) one["free"] = *row.free;
    rows.push_back(one);
  }
  return {{"tip", comparison.tip},
          {"reference_nodes", comparison.reference_nodes},
          {"rows", rows},
          {"obstacle", comparison.obstacle}};
}

}  // namespace slew::flex
