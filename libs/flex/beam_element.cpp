// SPDX-License-Identifier: Apache-2.0
#include "flex/beam_element.h"

namespace slew::flex {

using math::Mat3;

namespace {

// internal freedoms
constexpr int kMiddle = kNodalFreedoms;
enum Internal { kUx, kV, kW, kRx, kRy, kRz };

double bubble(double xi) noexcept {
  return 4 * xi * (1 - xi);
}
// per xi
double bubble_slope(double xi) noexcept {
  return 4 * (1 - 2 * xi);
}

// freedoms of one plane: displacement and turn of node 1, of node 2
using PlaneTerms = std::array<double, 4>;

// places of the planes' freedoms among the element's twelve, and the sign of the turn (-ry in the x-z plane)
constexpr std::array<int, 4> kPlaneY = {1, 5, 7, 11}, kPlaneZ = {2, 4, 8, 10};
constexpr std::array<double, 4> kTurnY = {1, 1, 1, 1}, kTurnZ = {1, -1, 1, -1};

// (2)
PlaneTerms displacement(double xi, double l, double phi) noexcept {
  const double x2 = xi * xi, x3 = x2 * xi, s = 1 / (1 + phi);
  return {s * (1 - 3 * x2 + 2 * x3 + phi * (1 - xi)), s * l * (xi - 2 * x2 + x3 + phi / 2 * (xi - x2)),
          s * (3 * x2 - 2 * x3 + phi * xi), s * l * (-x2 + x3 - phi / 2 * (xi - x2))};
}

// d(2)/dx
PlaneTerms slope(double xi, double l, double phi) noexcept {
  const double x2 = xi * xi, s = 1 / (1 + phi);
  return {s / l * (-6 * xi + 6 * x2 - phi), s * (1 - 4 * xi + 3 * x2 + phi / 2 * (1 - 2 * xi)),
          s / l * (6 * xi - 6 * x2 + phi), s * (-2 * xi + 3 * x2 - phi / 2 * (1 - 2 * xi))};
}

// (3)
PlaneTerms turn(double xi, double l, double phi) noexcept {
  const double x2 = xi * xi, s = 1 / (1 + phi);
  return {s * 6 / l * (x2 - xi), s * (1 - 4 * xi + 3 * x2 + phi * (1 - xi)), s * 6 / l * (xi - x2),
          s * (-2 * xi + 3 * x2 + phi * xi)};
}

// d(3)/dx
PlaneTerms curvature(double xi, double l, double phi) noexcept {
  const double s = 1 / ((1 + phi) * l);
  return {s * 6 / l * (2 * xi - 1), s * (-4 + 6 * xi - phi), s * 6 / l * (1 - 2 * xi), s * (-2 + 6 * xi + phi)};
}

template <typename Target>
void put(Target&& row, const PlaneTerms& values, const std::array<int, 4>& where, const std::array<double, 4>& sign,
         double factor = 1) {
  for (std::size_t i = 0; i < 4; ++i) row(where[i]) = factor * sign[i] * values[i];
}

Eigen::Matrix3d matrix_of(const Mat3& a) {
  Eigen::Matrix3d out;
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) out(i, j) = a(i, j);
  }
  return out;
}

// columns per local freedom of the nodes become columns per freedom in body axes
template <int Rows>
Eigen::Matrix<double, Rows, kElementFreedoms> per_body_freedom(
    const Eigen::Matrix<double, Rows, kElementFreedoms>& local, const Mat3& axes) {
  const Eigen::Matrix3d to_local = matrix_of(axes).transpose();
  Eigen::Matrix<double, Rows, kElementFreedoms> out = local;
  for (int block = 0; block < kNodalFreedoms; block += 3) {
    out.template middleCols<3>(block) = (local.template middleCols<3>(block) * to_local).eval();
  }
  return out;
}

Matrix3xElement in_body_axes(const Matrix3xElement& local, const Mat3& axes) {
  return matrix_of(axes) * per_body_freedom<3>(local, axes);
}

// stiffness of one plane, E I and its shear number
void add_bending(ElementMatrix& K, double EI, double l, double phi, const std::array<int, 4>& where,
                 const std::array<double, 4>& sign) {
  const double a = EI / (l * l * l * (1 + phi));
  const double k[4][4] = {{12, 6 * l, -12, 6 * l},
                          {6 * l, (4 + phi) * l * l, -6 * l, (2 - phi) * l * l},
                          {-12, -6 * l, 12, -6 * l},
                          {6 * l, (2 - phi) * l * l, -6 * l, (4 + phi) * l * l}};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < 4; ++j) K(where[i], where[j]) = a * sign[i] * sign[j] * k[i][j];
  }
}

void add_bar(ElementMatrix& K, double stiffness, int at) {
  K(at, at) = K(at + 6, at + 6) = stiffness;
  K(at, at + 6) = K(at + 6, at) = -stiffness;
}

void add_internal(ElementMatrix& K, const BeamElement& element) {
  const Section& s = element.section;
  const double l = element.length, E = element.youngs_modulus, G = element.shear_modulus;
  // integrals of the square of the function and of its slope
  const double square = 8 * l / 15, slope_square = 16 / (3 * l);
  const double shear_y = s.shear_factor_y * G * s.area, shear_z = s.shear_factor_z * G * s.area;
  const double stiffness[] = {E * s.area * slope_square,
                              shear_y * slope_square,
                              shear_z * slope_square,
                              G * s.torsion_constant * slope_square,
                              E * s.second_moment_y * slope_square + shear_z * square,
                              E * s.second_moment_z * slope_square + shear_y * square};
  for (int i = 0; i < 6; ++i) K(kMiddle + i, kMiddle + i) = stiffness[i];
}

}  // namespace

double shear_number(double bending, double shear_factor, double shear_modulus, double area, double length) noexcept {
  return shear_factor > 0 ? 12 * bending / (shear_factor * shear_modulus * area * length * length) : 0.0;
}

std::array<bool, 6> internal_freedoms(const BeamElement& element, RotaryInertia rotary) noexcept {
  const bool is_with = rotary == RotaryInertia::with, y = element.phi_y > 0, z = element.phi_z > 0;
  // turns without inertia stay zero: no load drives them
  return {true, y, z, true, z && is_with, y && is_with};
}

ElementField field_at(const BeamElement& element, double xi, RotaryInertia rotary) {
  const double l = element.length;
  const PlaneTerms v = displacement(xi, l, element.phi_y), rz = turn(xi, l, element.phi_y);
  const PlaneTerms w = displacement(xi, l, element.phi_z), ry = turn(xi, l, element.phi_z);
  Matrix3xElement axis = Matrix3xElement::Zero(), per_y = Matrix3xElement::Zero(), per_z = Matrix3xElement::Zero();
  axis(0, 0) = 1 - xi;
  axis(0, 6) = xi;
  put(axis.row(1), v, kPlaneY, kTurnY);
  put(axis.row(2), w, kPlaneZ, kTurnZ);
  const double b = bubble(xi);
  axis(0, kMiddle + kUx) = axis(1, kMiddle + kV) = axis(2, kMiddle + kW) = b;
  // (4): rx moves along z per y, along -y per z
  per_y(2, 3) = 1 - xi;
  per_y(2, 9) = xi;
  per_z(1, 3) = xi - 1;
  per_z(1, 9) = -xi;
  per_y(2, kMiddle + kRx) = b;
  per_z(1, kMiddle + kRx) = -b;
  if (rotary == RotaryInertia::with) {
    put(per_y.row(0), rz, kPlaneY, kTurnY, -1);
    put(per_z.row(0), ry, kPlaneZ, kTurnZ, -1);  // turn() gives -ry
    per_y(0, kMiddle + kRz) = -b;
    per_z(0, kMiddle + kRy) = b;
  }
  return {in_body_axes(axis, element.axes), in_body_axes(per_y, element.axes), in_body_axes(per_z, element.axes)};
}

Matrix3xElement slope_at(const BeamElement& element, double xi) {
  Matrix3xElement local = Matrix3xElement::Zero();
  put(local.row(1), slope(xi, element.length, element.phi_y), kPlaneY, kTurnY);
  put(local.row(2), slope(xi, element.length, element.phi_z), kPlaneZ, kTurnZ);
  local(1, kMiddle + kV) = local(2, kMiddle + kW) = bubble_slope(xi) / element.length;
  return in_body_axes(local, element.axes);
}

ElementStrain strain_at(const BeamElement& element, double xi) {
  const double l = element.length;
  ElementRow stretch = ElementRow::Zero(), twist = ElementRow::Zero(), bend_y = ElementRow::Zero(),
             bend_z = ElementRow::Zero();
  stretch(0) = twist(3) = -1 / l;
  stretch(6) = twist(9) = 1 / l;
  put(bend_z, curvature(xi, l, element.phi_y), kPlaneY, kTurnY);
  put(bend_y, curvature(xi, l, element.phi_z), kPlaneZ, kTurnZ, -1);  // curvature of ry, not -ry
  stretch(kMiddle + kUx) = twist(kMiddle + kRx) = bend_y(kMiddle + kRy) = bend_z(kMiddle + kRz) = bubble_slope(xi) / l;
  return {per_body_freedom<1>(stretch, element.axes), per_body_freedom<1>(twist, element.axes),
          per_body_freedom<1>(bend_y, element.axes), per_body_freedom<1>(bend_z, element.axes)};
}

ElementMatrix stiffness_of(const BeamElement& element) {
  const Section& s = element.section;
  const double l = element.length, E = element.youngs_modulus;
  ElementMatrix local = ElementMatrix::Zero();
  add_bar(local, E * s.area / l, 0);
  add_bar(local, element.shear_modulus * s.torsion_constant / l, 3);
  add_bending(local, E * s.second_moment_z, l, element.phi_y, kPlaneY, kTurnY);
  add_bending(local, E * s.second_moment_y, l, element.phi_z, kPlaneZ, kTurnZ);
  add_internal(local, element);
  // T^T K T, T turning body axes into local ones
  const Eigen::Matrix3d R = matrix_of(element.axes);
  ElementMatrix K = local;
  for (int i = 0; i < kNodalFreedoms; i += 3) {
    for (int j = 0; j < kNodalFreedoms; j += 3) {
      K.block<3, 3>(i, j) = (R * local.block<3, 3>(i, j) * R.transpose()).eval();
    }
  }
  const ElementMatrix mirrored = K.transpose();
  return 0.5 * (K + mirrored);
}

}  // namespace slew::flex
