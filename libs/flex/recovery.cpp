// SPDX-License-Identifier: Apache-2.0
#include "flex/recovery.h"

#include "core/check.h"
#include "flex/reduced_body.h"

namespace slew::flex {

using Eigen::Index;
using Eigen::MatrixXd;

namespace {

double times_mode(const ElementRow& row, const BeamElement& element, const MatrixXd& Phi, Index mode) {
  double sum = 0;
  for (int j = 0; j < kElementFreedoms; ++j) {
    const int freedom = element.freedoms[static_cast<std::size_t>(j)];
    if (freedom >= 0) sum += row(j) * Phi(freedom, mode);
  }
  return sum;
}

void add_end(Recovery& out, const FeModel& model, const BeamElement& element, const MatrixXd& Phi, int end) {
  const ElementStrain strain = strain_at(element, end);
  const double E = element.youngs_modulus, GJ = element.shear_modulus * element.section.torsion_constant;
  for (const SectionPoint& point : element.section.points) {
    const bool has_shear = point.torsion_modulus.has_value();
    out.points.push_back(
        {element.id, model.nodes[end == 0 ? element.node1 : element.node2].id, point.y, point.z, has_shear});
    for (Index k = 0; k < Phi.cols(); ++k) {
      out.normal.push_back(E * (times_mode(strain.stretch, element, Phi, k) -
                                point.y * times_mode(strain.bend_z, element, Phi, k) +
                                point.z * times_mode(strain.bend_y, element, Phi, k)));  // (1)
      out.shear.push_back(has_shear ? GJ * times_mode(strain.twist, element, Phi, k) / *point.torsion_modulus
                                    : 0);  // (2)
    }
  }
}

}  // namespace

Recovery make_recovery(const FeModel& model, const MatrixXd& Phi) {
  Recovery out;
  out.modes = static_cast<std::size_t>(Phi.cols());
  for (const BeamElement& element : model.elements) {
    add_end(out, model, element, Phi, 0);
    add_end(out, model, element, Phi, 1);
  }
  return out;
}

Recovery select(const Recovery& recovery, std::span<const int> ordinals) {
  const std::vector<std::size_t> places = places_of(ordinals, recovery.modes);
  Recovery out;
  out.modes = places.size();
  out.points = recovery.points;
  for (std::size_t i = 0; i < recovery.points.size(); ++i) {
    for (const std::size_t k : places) {
      out.normal.push_back(recovery.normal[i * recovery.modes + k]);
      out.shear.push_back(recovery.shear[i * recovery.modes + k]);
    }
  }
  return out;
}

PointStress stress_at(const Recovery& recovery, std::size_t point, std::span<const double> q) noexcept {
  SLEW_ASSERT(q.size() == recovery.modes && point < recovery.points.size());
  const std::size_t m = recovery.modes;
  PointStress stress;
  for (std::size_t k = 0; k < m; ++k) {
    stress.normal += recovery.normal[point * m + k] * q[k];
    stress.shear += recovery.shear[point * m + k] * q[k];
  }
  return stress;
}

}  // namespace slew::flex
