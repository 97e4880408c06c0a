// SPDX-License-Identifier: Apache-2.0
#include "tests/validation/flexible/linear_crane.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <cstddef>
#include <functional>

#include "tests/support/reference_algebra.h"

namespace slew::testing {

using Eigen::Matrix3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;
using Matrix = Dense<double>;
using Vector = Dense<double>;

namespace {

constexpr double kSide = 0.3, kWall = 2.139e-3, kDensity = 7700, kPoisson = 0.3, kShearFactor = 0.44;
constexpr double kInside = kSide - 2 * kWall;
constexpr double kArea = kSide * kSide - kInside * kInside;
constexpr double kSecondMoment = (kSide * kSide * kSide * kSide - kInside * kInside * kInside * kInside) / 12;
constexpr double kGravity = 9.81;

double degrees(double angle) {
  return angle * M_PI / 180;
}

Matrix3d about(const Vector3d& axis, double angle) {
  return Eigen::AngleAxisd(angle, axis).toRotationMatrix();
}

Matrix3d turned_by(const Vector3d& turn) {
  const double angle = turn.norm();
  return angle == 0 ? Matrix3d(Matrix3d::Identity()) : about(turn / angle, angle);
}

Vector3d turn_of(const Matrix3d& R) {
  const Eigen::AngleAxisd turn(R);
  return turn.angle() * turn.axis();
}

Vector3d part_at(const Vector& v, Index i) {
  return {v[i], v[i + 1], v[i + 2]};
}

// from this row on of a column
void put(Matrix& A, Index row, Index column, const Vector3d& part) {
  for (int k = 0; k < 3; ++k) A(row + k, column) = part[k];
}

}  // namespace

double BoxBeam::EI() const {
  return youngs_modulus * kSecondMoment;
}
double BoxBeam::EA() const {
  return youngs_modulus * kArea;
}
double BoxBeam::kGA() const {
  return kShearFactor * youngs_modulus / (2 * (1 + kPoisson)) * kArea;
}
// thin closed box (Bredt): 4 A_m^2 t/s with the middle line's area and length
double BoxBeam::GJ() const {
  const double middle = kSide - kWall;
  return youngs_modulus / (2 * (1 + kPoisson)) * middle * middle * middle * kWall;
}
double BoxBeam::rho_A() const {
  return kDensity * kArea;
}
double BoxBeam::rho_I() const {
  return kDensity * kSecondMoment;
}

namespace {

// Element in one plane, freedoms w1 theta1 w2 theta2 with theta = dw/dx without shear: exact static shapes, integrated
// by four Gauss points.
void plane_element(const BoxBeam& beam, double l, Matrix4d& K, Matrix4d& M) {
  constexpr double kPoint[2] = {0.3399810435848563, 0.8611363115940526};
  constexpr double kWeight[2] = {0.6521451548625461, 0.3478548451374538};
  const double P = 12 * beam.EI() / (beam.kGA() * l * l), D = 1 + P;
  K.setZero();
  M.setZero();
  for (int i = 0; i < 4; ++i) {
    const double x = 0.5 * (1 + (i % 2 == 0 ? 1 : -1) * kPoint[i / 2]), weight = 0.5 * l * kWeight[i / 2];
    Eigen::Vector4d w, theta, bend, slope;
    w << 1 - 3 * x * x + 2 * x * x * x + P * (1 - x), l * (x - 2 * x * x + x * x * x + P / 2 * (x - x * x)),
        3 * x * x - 2 * x * x * x + P * x, l * (-x * x + x * x * x + P / 2 * (x * x - x));
    slope << -6 * x + 6 * x * x - P, l * (1 - 4 * x + 3 * x * x + P / 2 * (1 - 2 * x)), 6 * x - 6 * x * x + P,
        l * (-2 * x + 3 * x * x + P / 2 * (2 * x - 1));
    theta << 6 / l * (x * x - x), 1 - 4 * x + 3 * x * x + P * (1 - x), 6 / l * (x - x * x), -2 * x + 3 * x * x + P * x;
    bend << 6 / l * (2 * x - 1), -4 + 6 * x - P, 6 / l * (1 - 2 * x), -2 + 6 * x + P;
    const Eigen::Vector4d shear = (slope / l - theta) / D;
    K += weight * (beam.EI() / (l * l * D * D) * bend * bend.transpose() + beam.kGA() * shear * shear.transpose());
    M += weight / (D * D) * (beam.rho_A() * w * w.transpose() + beam.rho_I() * theta * theta.transpose());
  }
}

// Matrices of the boom along -x, six freedoms a node: shifts along and turns about x, y, z.
void beam_matrices(const BoxBeam& beam, int elements, Matrix& K, Matrix& M) {
  const double l = beam.length / elements;
  Matrix4d K_plane, M_plane;
  plane_element(beam, l, K_plane, M_plane);
  K = M = Matrix(6 * (elements + 1), 6 * (elements + 1));
  for (int e = 0; e < elements; ++e) {
    const int a = 6 * e, b = a + 6;
    // the way goes along -x: w = u_y has the slope -theta_z, w = u_z the slope theta_y
    const int planes[2][4] = {{a + 1, a + 5, b + 1, b + 5}, {a + 2, a + 4, b + 2, b + 4}};
    for (int plane = 0; plane < 2; ++plane) {
      const double sign = plane == 0 ? -1 : 1;
      for (int i = 0; i < 4; ++i) {
        for (int j = 0; j < 4; ++j) {
          const double both = (i % 2 == 1 ? sign : 1) * (j % 2 == 1 ? sign : 1);
          K(planes[plane][i], planes[plane][j]) += both * K_plane(i, j);
          M(planes[plane][i], planes[plane][j]) += both * M_plane(i, j);
        }
      }
    }
    const double stiff[2] = {beam.EA() / l, beam.GJ() / l};
    const double mass[2] = {beam.rho_A() * l / 6, 2 * beam.rho_I() * l / 6};
    for (int k = 0; k < 2; ++k) {
      const int i = a + 3 * k, j = b + 3 * k;
      K(i, i) += stiff[k], K(j, j) += stiff[k], K(i, j) -= stiff[k], K(j, i) -= stiff[k];
      M(i, i) += 2 * mass[k], M(j, j) += 2 * mass[k], M(i, j) += mass[k], M(j, i) += mass[k];
    }
  }
}

struct RigidBody {
  double mass = 0;
  Vector3d inertia = Vector3d::Zero();  // about the centre, body axes
  Vector3d centre;
  Matrix3d R;
};

// a cylinder's two halves: masses that stay at a distance from either end of its line
struct Line {
  Vector3d P1, P2;
  double m1, c1, m2, c2, transverse;
  [[nodiscard]] double length() const { return (P1 - P2).norm(); }
  [[nodiscard]] Vector3d e() const { return (P1 - P2) / length(); }
};

// Everything where the coordinates have it: turn of the lift boom, turn of the jib, turn of the bag (3), then shifts
// and turns of the boom's nodes beyond its root.
struct Pose {
  std::vector<RigidBody> bodies;
  std::vector<Vector3d> nodes;
  std::vector<Matrix3d> node_R;
  Matrix3d boom_R;
  Line lift, jib;
};

constexpr int kRigid = 5;
constexpr double kStep = 1e-4;  // step of differences: m, rad

class Crane {
 public:
  explicit Crane(const LinearCraneDef& def) : def_(def), count_(kRigid + 6 * def.elements) {
    beam_matrices(def.boom, def.elements, K_beam_, M_beam_);
    settle();
  }

  [[nodiscard]] std::vector<double> frequencies() {
    const Matrix K = stiffness(), M = mass();
    std::vector<double> f;
    for (const double square : symmetric_modes(K, M).lambda) {
      const double hertz = std::sqrt(std::abs(square)) / (2 * M_PI);
      if (hertz > 0.01) f.push_back(hertz);
    }
    return f;
  }

 private:
  [[nodiscard]] Pose pose(const Vector& x) const {
    const Vector3d z = Vector3d::UnitZ();
    Pose p;
    const Matrix3d R_p = about(Vector3d::UnitY(), degrees(37.5));
    const Vector3d o_p(3.21922, 0.8830184, 0.00036178);
    const Matrix3d R_l = R_p * about(z, degrees(-15) + x[0]);
    const Vector3d o_l = o_p + R_p * Vector3d(0.5, 2, 0);
    const Matrix3d R_a = R_l * about(z, degrees(25) + x[1]);
    const Vector3d o_a = o_l + R_l * Vector3d(-2.6, 0, 0);
    p.bodies.push_back({400, {12, 230, 230}, o_l + R_l * Vector3d(-1.3, 0, 0), R_l});
    p.bodies.push_back({30, {0.6, 0.6, 0.6}, o_a + R_a * Vector3d(-0.1, 0, 0), R_a});
    // boom
    const Vector3d root(0, 0.02904, 0.1507), o_j = o_a + R_a * Vector3d(0.3, 0, -0.195);
    p.boom_R = R_a;
    for (int i = 0; i <= def_.elements; ++i) {
      Vector3d place = root, turn = Vector3d::Zero();
      place.x() -= def_.boom.length * i / def_.elements;
      if (i > 0) {
        place += part_at(x, kRigid + 6 * (i - 1));
        turn = part_at(x, kRigid + 6 * (i - 1) + 3);
      }
      p.nodes.push_back(o_j + R_a * place);
      p.node_R.push_back(R_a * turned_by(turn));
    }
    const Vector3d tip(-def_.boom.length, root.y(), root.z());
    const Matrix3d R_h = p.node_R.back();
    const Vector3d o_h = p.nodes.back() + R_h * (Vector3d(-6.5, -0.15, 0.15) - tip);
    p.bodies.push_back({20, {0.2, 0.2, 0.2}, o_h + R_h * Vector3d(0, -0.1, 0), R_h});
    // the bag hangs plumb
    const Matrix3d R_b = turned_by(part_at(x, 2)) * R_p;
    const double turning = 100 * def_.payload / 500;
    p.bodies.push_back({def_.payload,
                        {turning, turning, turning},
                        o_h + R_h * Vector3d(0, -0.3, 0) + R_b * Vector3d(0, -0.6, 0),
                        R_b});
    p.lift = {o_p + R_p * Vector3d(-0.221712, 0.22223, -0.00376529),
              o_l + R_l * Vector3d(-0.221712, 0.165, -0.00376529),
              31.63103,
              -0.56644,
              25,
              0.55,
              4.015 + 1.44};
    p.jib = {
        o_l + R_l * Vector3d(-0.7, -0.25, 0), o_a + R_a * Vector3d(0, -0.35, 0), 22, -0.45, 18, 0.45, 1.545 + 1.355};
    return p;
  }

  // of gravity; the boom's with its consistent mass
  [[nodiscard]] double weight(const Pose& p) const {
    double V = 0;
    for (const RigidBody& body : p.bodies) V += body.mass * kGravity * body.centre.y();
    for (const Line* line : {&p.lift, &p.jib}) {
      V += kGravity *
           (line->m1 * (line->P1 + line->e() * line->c1).y() + line->m2 * (line->P2 + line->e() * line->c2).y());
    }
    const Vector3d up = p.boom_R.transpose() * Vector3d::UnitY();
    Vector lift(M_beam_.rows()), place = lift;
    for (std::size_t i = 0; i < p.nodes.size(); ++i) {
      const auto k = static_cast<Index>(6 * i);
      put(lift, k, 0, up);
      put(place, k, 0, p.boom_R.transpose() * p.nodes[i]);
      put(place, k + 3, 0, turn_of(p.boom_R.transpose() * p.node_R[i]));
    }
    return V + kGravity * lift.dot(M_beam_ * place);
  }
  // less the work of the cylinders' static forces; strain is not in it
  [[nodiscard]] double potential(const Vector& x) const {
    const Pose p = pose(x);
    return weight(p) - lift_force_ * p.lift.length() - jib_force_ * p.jib.length();
  }

  [[nodiscard]] Vector gradient(const std::function<double(const Vector&)>& V) const {
    Vector g(count_);
    Vector x = x_;
    for (int k = 0; k < count_; ++k) {
      x[k] = x_[k] + kStep;
      const double above = V(x);
      x[k] = x_[k] - kStep;
      g[k] = (above - V(x)) / (2 * kStep);
      x[k] = x_[k];
    }
    return g;
  }

  // bends the boom as it rests, and finds the forces that hold the cylinders
  void settle() {
    x_ = Vector(count_);
    const int bending = count_ - kRigid;
    const Matrix K = K_beam_.block(6, 6, bending, bending);
    Vector g;
    for (int i = 0; i < 12; ++i) {
      g = gradient([this](const Vector& x) { return weight(pose(x)); });
      x_.put(kRigid, 0, -solve(K, g.block(kRigid, 0, bending, 1)));
    }
    const auto way = [&](Line Pose::*line) {
      return gradient([&](const Vector& x) { return (pose(x).*line).length(); });
    };
    lift_way_ = way(&Pose::lift);
    jib_way_ = way(&Pose::jib);
    lift_force_ = g[0] / lift_way_[0];
    jib_force_ = g[1] / jib_way_[1];
  }

  [[nodiscard]] Matrix stiffness() const {
    Matrix K(count_, count_);
    Vector x = x_;
    const auto at = [&](int k, double a, int l, double b) {
      x[k] += a;
      x[l] += b;
      const double V = potential(x);
      x[k] = x_[k];
      x[l] = x_[l];
      return V;
    };
    const double h = kStep;
    for (int k = 0; k < count_; ++k) {
      for (int l = 0; l <= k; ++l) {
        K(k, l) = K(l, k) = (at(k, h, l, h) - at(k, h, l, -h) - at(k, -h, l, h) + at(k, -h, l, -h)) / (4 * h * h);
      }
    }
    K += def_.lift_stiffness * lift_way_ * lift_way_.transposed() +
         def_.jib_stiffness * jib_way_ * jib_way_.transposed();
    for (int k = kRigid; k < count_; ++k) {
      for (int l = kRigid; l < count_; ++l) K(k, l) += K_beam_(k - kRigid + 6, l - kRigid + 6);
    }
    return K;
  }

  // speeds of everything that has a mass, by coordinate, times the masses
  [[nodiscard]] Matrix mass() const {
    Matrix J_body(6 * 4, count_), J_boom(6 * (def_.elements + 1), count_), J_line(9 * 2, count_);
    const Pose here = pose(x_);
    Vector x = x_;
    for (int k = 0; k < count_; ++k) {
      x[k] = x_[k] + kStep;
      const Pose above = pose(x);
      x[k] = x_[k] - kStep;
      const Pose below = pose(x);
      x[k] = x_[k];
      const auto speed = [](const Vector3d& a, const Vector3d& b) { return Vector3d((a - b) / (2 * kStep)); };
      const auto spin = [](const Matrix3d& a, const Matrix3d& b) {
        return Vector3d(turn_of(a * b.transpose()) / (2 * kStep));
      };
      for (int b = 0; b < 4; ++b) {
        const auto i = static_cast<std::size_t>(b);
        put(J_body, 6 * b, k, speed(above.bodies[i].centre, below.bodies[i].centre));
        put(J_body, 6 * b + 3, k, here.bodies[i].R.transpose() * spin(above.bodies[i].R, below.bodies[i].R));
      }
      for (int n = 0; n <= def_.elements; ++n) {
        const auto i = static_cast<std::size_t>(n);
        put(J_boom, 6 * n, k, here.boom_R.transpose() * speed(above.nodes[i], below.nodes[i]));
        put(J_boom, 6 * n + 3, k, here.boom_R.transpose() * spin(above.node_R[i], below.node_R[i]));
      }
      int row = 0;
      for (Line Pose::*line : {&Pose::lift, &Pose::jib}) {
        const Line &a = above.*line, &b = below.*line;
        put(J_line, row, k, speed(a.P1 + a.e() * a.c1, b.P1 + b.e() * b.c1));
        put(J_line, row + 3, k, speed(a.P2 + a.e() * a.c2, b.P2 + b.e() * b.c2));
        put(J_line, row + 6, k, speed(a.e(), b.e()));
        row += 9;
      }
    }
    Vector m_body(24), m_line(18);
    for (int b = 0; b < 4; ++b) {
      const RigidBody& body = here.bodies[static_cast<std::size_t>(b)];
      put(m_body, 6 * b, 0, Vector3d::Constant(body.mass));
      put(m_body, 6 * b + 3, 0, body.inertia);
    }
    int row = 0;
    for (const Line* line : {&here.lift, &here.jib}) {
      put(m_line, row, 0, Vector3d::Constant(line->m1));
      put(m_line, row + 3, 0, Vector3d::Constant(line->m2));
      put(m_line, row + 6, 0, Vector3d::Constant(line->transverse));
      row += 9;
    }
    return J_body.transposed() * Matrix::diagonal(m_body) * J_body +
           J_line.transposed() * Matrix::diagonal(m_line) * J_line + J_boom.transposed() * M_beam_ * J_boom;
  }

  LinearCraneDef def_;
  int count_;
  Matrix K_beam_, M_beam_;
  Vector x_, lift_way_, jib_way_;
  double lift_force_ = 0, jib_force_ = 0;
};

// (w, theta, M, Q) along the beam at a frequency: w' = theta + Q/kGA, theta' = M/EI, M' = -Q - rho I omega^2 theta,
// Q' = -rho A omega^2 w. What is left of the tip's balance with clamped root: Q = m omega^2 w, M = J omega^2 theta.
double tip_determinant(const BoxBeam& beam, double mass, double inertia, double omega) {
  const double square = omega * omega;
  Matrix4d A = Matrix4d::Zero();
  A(0, 1) = 1, A(0, 3) = 1 / beam.kGA(), A(1, 2) = 1 / beam.EI();
  A(2, 3) = -1, A(2, 1) = -beam.rho_I() * square, A(3, 0) = -beam.rho_A() * square;
  // exponential by its series over a part of the length, then repeated squares
  constexpr int kSquares = 12;
  const Matrix4d part = A * (beam.length / (1 << kSquares));
  Matrix4d T = Matrix4d::Identity(), term = T;
  for (int k = 1; k < 12; ++k) {
    term = term * part / k;
    T += term;
  }
  for (int k = 0; k < kSquares; ++k) T = T * T;
  Eigen::Matrix<double, 2, 4> tip;
  tip << -mass * square, 0, 0, 1, 0, -inertia * square, 1, 0;
  return (tip * T).rightCols<2>().determinant();
}

}  // namespace

std::vector<double> linear_crane_frequencies(const LinearCraneDef& def) {
  return Crane(def).frequencies();
}

std::vector<double> loaded_beam_frequencies(const BoxBeam& beam, double mass, double rotary_inertia, int count) {
  std::vector<double> roots;
  constexpr double kSweep = 1.0;  // rad/s, well below the distance of two roots
  double below = tip_determinant(beam, mass, rotary_inertia, kSweep);
  for (double omega = 2 * kSweep; static_cast<int>(roots.size()) < count; omega += kSweep) {
    const double above = tip_determinant(beam, mass, rotary_inertia, omega);
    if (below * above < 0) {
      double a = omega - kSweep, b = omega;
      for (int i = 0; i < 60; ++i) {
        const double middle = 0.5 * (a + b);
        (tip_determinant(beam, mass, rotary_inertia, middle) * below > 0 ? a : b) = middle;
      }
      roots.push_back(0.5 * (a + b) / (2 * M_PI));
    }
    below = above;
  }
  return roots;
}

}  // namespace slew::testing
