// SPDX-License-Identifier: Apache-2.0
#include "tests/properties/multibody/assembled.h"

#include <cmath>
#include <numbers>
#include <stdexcept>

namespace slew::multibody::testing {
namespace {

Vector3 vec(const Triple& t) {
  return Vector3(t);
}

Matrix3 about(int axis, Real angle) {
  return turn_about(Vector3::unit(axis), angle);
}

Matrix3 euler_zxz(const Triple& a) {
  return about(2, a[0]) * about(0, a[1]) * about(2, a[2]);
}
Matrix3 euler_xyz(const Triple& a) {
  return about(0, a[0]) * about(1, a[1]) * about(2, a[2]);
}

// J += turning x arm: from the velocities of one point to those of a point at `arm` from it
void shift(Columns& J, const Columns& turning, const Vector3& arm) {
  for (std::size_t k = 0; k < J.size(); ++k) J[k] += cross(turning[k], arm);
}

Columns point_jacobian(const BodyMotion& body, const Vector3& arm) {
  Columns J = body.Jp;
  shift(J, body.Jw, arm);
  return J;
}

// J u
Vector3 velocity(const Columns& J, const Vector& u) {
  Vector3 v;
  for (std::size_t k = 0; k < J.size(); ++k) v += J[k] * u[static_cast<Index>(k)];
  return v;
}

// a + J^T f
void add_load(Vector& a, const Columns& J, const Vector3& f) {
  for (std::size_t k = 0; k < J.size(); ++k) a[static_cast<Index>(k)] += dot(J[k], f);
}

Vector3 part_at(const Vector& v, Index i) {
  return {v[i], v[i + 1], v[i + 2]};
}

void put(Vector& v, Index i, const Vector3& part) {
  for (int k = 0; k < 3; ++k) v[i + k] = part[static_cast<std::size_t>(k)];
}

void add_unit_columns(Columns& J, int first) {
  for (int k = 0; k < 3; ++k) J[static_cast<std::size_t>(first + k)] += Vector3::unit(k);
}

// joint frames in parent and child
struct Sides {
  const BodyMotion* parent;
  Matrix3 R_P, R_C;
  Vector3 p_P, p_C;
  Real sign;  // sign of the coordinate: the child is body 2 (+) or body 1 (-)
};

Matrix3 quaternion_matrix(const Vector& q, int i) {
  return turn_of({q[i], part_at(q, i + 1)});
}

}  // namespace

const BodyMotion& Assembled::body(const std::vector<BodyMotion>& bodies, const std::string& name) const {
  if (name == kGroundName) return bodies[0];
  for (std::size_t i = 0; i < def_.bodies.size(); ++i) {
    if (def_.bodies[i].name == name) return bodies[i + 1];
  }
  throw std::runtime_error("unknown body " + name);
}

std::vector<BodyMotion> Assembled::motion(const Vector& q) const {
  const auto n = static_cast<std::size_t>(model_.speed_count());
  std::vector<BodyMotion> bodies(def_.bodies.size() + 1);
  std::vector<bool> is_placed(bodies.size(), false);
  is_placed[0] = true;
  for (BodyMotion& b : bodies) b.Jw = b.Jp = Columns(n);
  const auto index = [this](const std::string& name) { return find_body(model_, name); };
  for (std::size_t placed = 0; placed < def_.bodies.size();) {
    for (std::size_t j = 0; j < def_.joints.size(); ++j) {
      const JointDef& joint = def_.joints[j];
      const Joint& known = model_.joints[j];
      if (known.link == 0 && joint.type != JointType::fixed) continue;  // not in the tree
      const auto b1 = static_cast<std::size_t>(index(joint.body1)), b2 = static_cast<std::size_t>(index(joint.body2));
      if (is_placed[b1] == is_placed[b2]) continue;
      const bool is_forward = is_placed[b1];
      const std::size_t child_index = is_forward ? b2 : b1;
      BodyMotion& child = bodies[child_index];
      const BodyMotion& parent = bodies[is_forward ? b1 : b2];
      const Matrix3 R1 = euler_xyz(joint.orientation1), R2 = euler_xyz(joint.orientation2);
      const Vector3 p1 = vec(joint.point1), p2 = vec(joint.point2);
      const Matrix3& R_P = is_forward ? R1 : R2;
      const Matrix3& R_C = is_forward ? R2 : R1;
      const Vector3& p_P = is_forward ? p1 : p2;
      const Vector3& p_C = is_forward ? p2 : p1;
      const Real sign = is_forward ? 1 : -1;
      const Link& link = model_.links[static_cast<std::size_t>(known.link)];
      const auto u = static_cast<std::size_t>(link.u);
      const Matrix3 frame = parent.R * R_P;
      const Vector3 axis = frame.col(2);
      Vector3 point = parent.p + parent.R * p_P;
      child.Jw = parent.Jw;
      child.Jp = point_jacobian(parent, parent.R * p_P);  // of the joint's point at first
      switch (joint.type) {
        case JointType::fixed:
          child.R = frame * transpose(R_C);
          break;
        case JointType::revolute:
          child.R = frame * about(2, sign * q[link.q]) * transpose(R_C);
          child.Jw[u] += sign * axis;
          break;
        case JointType::prismatic: {
          child.R = frame * transpose(R_C);
          const Vector3 slide = axis * (sign * q[link.q]);
          shift(child.Jp, parent.Jw, slide);
          child.Jp[u] += sign * axis;
          point += slide;
          break;
        }
        case JointType::spherical:
          child.R = quaternion_matrix(q, link.q) * transpose(R_C);
          add_unit_columns(child.Jw, link.u);
          break;
        case JointType::cylindrical: {
          child.R = frame * about(2, sign * q[link.q]) * transpose(R_C);
          const Vector3 slide = axis * (sign * q[link.q + 1]);
          child.Jw[u] += sign * axis;
          shift(child.Jp, parent.Jw, slide);
          child.Jp[u + 1] += sign * axis;
          point += slide;
          break;
        }
        case JointType::universal: {
          // R_12 = Rz(a1) [y z x] Rz(a2); from body 2 to body 1 its coordinates are a2, a1
          const Matrix3 across{{Vector3::unit(1), Vector3::unit(2), Vector3::unit(0)}};
          const Matrix3 R_12 = is_forward ? about(2, q[link.q]) * across * about(2, q[link.q + 1])
                                          : about(2, q[link.q + 1]) * across * about(2, q[link.q]);
          const Matrix3 moved = frame * (is_forward ? R_12 : transpose(R_12));
          child.R = moved * transpose(R_C);
          child.Jw[u] += sign * axis;
          child.Jw[u + 1] += sign * moved.col(2);
          break;
        }
        case JointType::floating:
          child.R = quaternion_matrix(q, link.q + 3) * transpose(R_C);
          point = part_at(q, link.q);
          child.Jw = child.Jp = Columns(n);
          add_unit_columns(child.Jp, link.u);
          add_unit_columns(child.Jw, link.u + 3);
          break;
        case JointType::node:
          place_node(joint, parent, q, child);
          point = child.p;
          break;
        default:
          throw std::logic_error("the tree has no such joint");
      }
      // from the joint's point to the child's origin
      const Vector3 arm = -(child.R * p_C);
      child.p = point + arm;
      shift(child.Jp, child.Jw, arm);
      is_placed[child_index] = true;
      ++placed;
    }
  }
  return bodies;
}

const FlexiblePart& Assembled::part_of(const std::string& body) const {
  for (const FlexiblePart& part : model_.parts) {
    if (part.name == body) return part;
  }
  throw std::runtime_error("not flexible: " + body);
}

void Assembled::place_node(const JointDef& joint, const BodyMotion& frame, const Vector& q, BodyMotion& node) const {
  const FlexiblePart& part = part_of(joint.body1);
  for (const FlexibleBodyDef& def : def_.flexible_bodies) {
    for (const ModalNode& n : def.modes->nodes) {
      if (def.body != joint.body1 || node_name(def.body, n.id) != joint.name) continue;
      const auto sum = [&](const std::vector<math::Vec3>& shapes, const Vector& at) {
        Vector3 result;
        for (std::size_t k = 0; k < shapes.size(); ++k) {
          result += vec(shapes[k].array()) * at[part.q + static_cast<Index>(k)];
        }
        return result;
      };
      const auto turned = [&](const Vector& at) {
        const Vector3 theta = sum(n.turn, at);
        const Real angle = norm(theta);
        return angle == 0 ? Matrix3::identity() : turn_about(theta / angle, angle);
      };
      const Vector3 arm = frame.R * (vec(n.position.array()) + sum(n.shift, q));
      const Matrix3 turn = turned(q);
      node.R = frame.R * turn;
      node.p = frame.p + arm;
      node.Jw = frame.Jw;
      node.Jp = point_jacobian(frame, arm);
      for (std::size_t k = 0; k < part.modes; ++k) {
        const std::size_t u = static_cast<std::size_t>(part.u) + k;
        const Vector e = Vector::unit(q.size(), part.q + static_cast<Index>(k));
        const Matrix3 spin = derivative_at_zero([&](Real t) { return turned(q + t * e); }) * transpose(turn);
        node.Jw[u] += frame.R * Vector3(spin(2, 1), spin(0, 2), spin(1, 0));
        node.Jp[u] += frame.R * vec(n.shift[k].array());
      }
      return;
    }
  }
}

void Assembled::add_points(const std::vector<BodyMotion>& bodies, const Vector& q, std::vector<Mass>& list) const {
  for (const auto& [name, points] : points_) {
    const FlexiblePart& part = part_of(name);
    const BodyMotion& frame = body(bodies, name);
    for (const MassPoint& point : points) {
      Vector3 x = vec(point.x.array());
      for (std::size_t k = 0; k < part.modes; ++k) {
        x += vec(point.phi[k].array()) * q[part.q + static_cast<Index>(k)];
      }
      Mass mass{point.mass, Matrix3(), point_jacobian(frame, frame.R * x), frame.Jw, frame.p + frame.R * x};
      for (std::size_t k = 0; k < part.modes; ++k) {
        mass.Jv[static_cast<std::size_t>(part.u) + k] += frame.R * vec(point.phi[k].array());
      }
      list.push_back(mass);
    }
  }
}

Vector Assembled::coordinate_rates(const Vector& q, const Vector& u) const {
  Vector rates(q.size());
  const std::vector<BodyMotion> bodies = motion(q);
  for (const FlexiblePart& part : model_.parts) {
    const auto modes = static_cast<Index>(part.modes);
    rates.put(part.q, 0, u.block(part.u, 0, modes, 1));
  }
  for (std::size_t j = 0; j < def_.joints.size(); ++j) {
    const Joint& joint = model_.joints[j];
    const Link& link = model_.links[static_cast<std::size_t>(joint.link)];
    if (joint.link == 0) continue;  // not in the tree, or nothing moves
    if (joint.type == JointType::revolute || joint.type == JointType::prismatic) {
      rates[link.q] = u[link.u];
    } else if (joint.type == JointType::universal || joint.type == JointType::cylindrical) {
      rates.put(link.q, 0, u.block(link.u, 0, 2, 1));
    } else if (joint.type == JointType::spherical || joint.type == JointType::floating) {
      const std::string& name = joint.is_reversed ? def_.joints[j].body1 : def_.joints[j].body2;
      const Vector3 w = velocity(body(bodies, name).Jw, u);
      int i = link.q;
      if (joint.type == JointType::floating) {
        rates.put(i, 0, u.block(link.u, 0, 3, 1));
        i += 3;
      }
      const Quaternion rate = Quaternion{0, w / 2} * Quaternion{q[i], part_at(q, i + 1)};
      rates[i] = rate.w;
      put(rates, i + 1, rate.v);
    }
  }
  return rates;
}

std::vector<Assembled::Mass> Assembled::masses(const Vector& q) const {
  const std::vector<BodyMotion> bodies = motion(q);
  std::vector<Mass> list;
  const auto add = [&list](const BodyMotion& on, Real mass, const Vector3& center, const Matrix3& inertia) {
    list.push_back(
        {mass, on.R * inertia * transpose(on.R), point_jacobian(on, on.R * center), on.Jw, on.p + on.R * center});
  };
  for (std::size_t i = 0; i < def_.bodies.size(); ++i) {
    const BodyDef& def = def_.bodies[i];
    if (points_.contains(def.name)) continue;
    Matrix3 I{{Vector3(def.inertia[0], def.products[0], def.products[1]),
               Vector3(def.products[0], def.inertia[1], def.products[2]),
               Vector3(def.products[1], def.products[2], def.inertia[2])}};
    const Vector3 c = vec(def.center_of_mass);
    if (def.inertia_about == InertiaPoint::body_origin) {
      I = I - (Matrix3::identity() * dot(c, c) - outer(c, c)) * def.mass;
    }
    add(bodies[i + 1], def.mass, c, I);
  }
  for (const StaticDummyDef& def : def_.static_dummies) {
    const Matrix3 R = euler_zxz(def.orientation);
    const Matrix3 I = R * Matrix3::diagonal(vec(def.inertia)) * transpose(R);
    add(body(bodies, def.relative_to), def.mass, vec(def.position) + R * vec(def.center_of_mass), I);
  }
  add_force_dummies(bodies, list);
  add_points(bodies, q, list);
  return list;
}

void Assembled::add_force_dummies(const std::vector<BodyMotion>& bodies, std::vector<Mass>& list) const {
  for (const ForceDummyDef& dummy : def_.force_dummies) {
    for (const TranslationalForceDef& force : def_.translational_forces) {
      if (force.name != dummy.relative_to) continue;
      const BodyMotion &b1 = body(bodies, force.body1), &b2 = body(bodies, force.body2);
      const Vector3 s1 = b1.R * vec(force.point1), s2 = b2.R * vec(force.point2);
      const Columns J1 = point_jacobian(b1, s1), J2 = point_jacobian(b2, s2);
      const Vector3 d = b1.p + s1 - b2.p - s2;
      const Real length = norm(d);
      const Vector3 e = d / length;
      const Real c = dummy.center_of_mass[0];
      const bool is_cylinder = dummy.index == 1;
      // it turns with e x e', without spin about e
      Mass mass{dummy.mass, Matrix3::identity() * ((dummy.inertia[1] + dummy.inertia[2]) / 2), is_cylinder ? J1 : J2,
                Columns(J1.size()), (is_cylinder ? b1.p + s1 : b2.p + s2) + c * e};
      for (std::size_t k = 0; k < J1.size(); ++k) {
        const Vector3 apart = J1[k] - J2[k], rate = (apart - e * dot(e, apart)) / length;
        mass.Jv[k] += c * rate;
        mass.Jw[k] = cross(e, rate);
      }
      list.push_back(mass);
    }
  }
}

Matrix Assembled::mass_matrix(const Vector& q) const {
  const auto n = static_cast<std::size_t>(model_.speed_count());
  Matrix M(model_.speed_count(), model_.speed_count());
  for (const Mass& m : masses(q)) {
    for (std::size_t k = 0; k < n; ++k) {
      const Vector3 p = m.mass * m.Jv[k], L = m.inertia * m.Jw[k];
      for (std::size_t l = 0; l < n; ++l) {
        M(static_cast<Index>(l), static_cast<Index>(k)) += dot(m.Jv[l], p) + dot(m.Jw[l], L);
      }
    }
  }
  return M;
}

Real Assembled::potential(const Vector& q) const {
  Real sum = 0;
  for (const Mass& m : masses(q)) sum -= m.mass * dot(vec(def_.gravity), m.center);
  for (const FlexibleBodyDef& def : def_.flexible_bodies) {
    const FlexiblePart& part = part_of(def.body);
    for (std::size_t k = 0; k < part.modes * part.modes; ++k) {
      const auto row = static_cast<Index>(k / part.modes), column = static_cast<Index>(k % part.modes);
      sum += Real(def.modes->stiffness[k]) * q[part.q + row] * q[part.q + column] / 2;
    }
  }
  return sum;
}

Vector Assembled::forces(const Vector& q, const Vector& u) const {
  const Vector rates = coordinate_rates(q, u);
  const std::vector<Mass> now = masses(q);
  Vector result = element_forces(q, u);
  // velocities of all masses along the motion with u held
  const auto velocities = [&](Real t) {
    const std::vector<Mass> then = masses(q + t * rates);
    Vector v(6 * static_cast<Index>(then.size()));
    for (std::size_t i = 0; i < then.size(); ++i) {
      const auto k = 6 * static_cast<Index>(i);
      put(v, k, velocity(then[i].Jv, u));
      put(v, k + 3, velocity(then[i].Jw, u));
    }
    return v;
  };
  const Vector bias = derivative_at_zero(velocities);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Mass& m = now[i];
    const auto k = 6 * static_cast<Index>(i);
    const Vector3 w = velocity(m.Jw, u), a = part_at(bias, k), alpha = part_at(bias, k + 3);
    add_load(result, m.Jv, -(m.mass * (a - vec(def_.gravity))));
    add_load(result, m.Jw, -(m.inertia * alpha + cross(w, m.inertia * w)));
  }
  return result;
}

Vector Assembled::element_forces(const Vector& q, const Vector& u) const {
  const std::vector<BodyMotion> bodies = motion(q);
  Vector result(u.size());
  for (const FlexibleBodyDef& def : def_.flexible_bodies) {
    const FlexiblePart& part = part_of(def.body);
    const auto n = static_cast<Index>(part.modes);
    for (Index k = 0; k < n; ++k) {
      for (Index l = 0; l < n; ++l) {
        result[part.u + k] -= def.modes->stiffness[static_cast<std::size_t>(k * n + l)] * q[part.q + l];
      }
      const std::size_t own = static_cast<std::size_t>(k * n + k);
      const Real omega = std::sqrt(Real(def.modes->stiffness[own]) * def.modes->mass_matrix[own]);
      result[part.u + k] -= 2 * Real(def.relative_damping[0]) * omega * u[part.u + k];
    }
  }
  for (const TranslationalForceDef& force : def_.translational_forces) {
    const Real x = row_value(force.name, q);
    const Vector J = row_jacobian(force.name, q);
    Real f = -force.spring_constant * (x - force.free_length) - force.damping_constant * J.dot(u);
    if (force.end_spring_constant > 0 && x < force.min_length) {
      f +=
          std::max(Real(0), force.end_spring_constant * (force.min_length - x) - force.end_damping_constant * J.dot(u));
    }
    if (force.end_spring_constant > 0 && x > force.max_length) {
      f -=
          std::max(Real(0), force.end_spring_constant * (x - force.max_length) + force.end_damping_constant * J.dot(u));
    }
    result += J * f;
  }
  for (const RotationalForceDef& force : def_.rotational_forces) {
    const BodyMotion &b1 = body(bodies, force.body1), &b2 = body(bodies, force.body2);
    const Vector3 axis = normalized(b1.R * cross(vec(force.f1), vec(force.g1)));
    Vector damper(u.size());
    add_load(damper, b2.Jw, axis);
    add_load(damper, b1.Jw, -axis);
    result -= damper * (force.damping_constant * damper.dot(u));
    if (force.spring_constant == 0) continue;
    const Real f = -force.spring_constant * (row_value(force.name, q) - force.free_angle);
    result += row_jacobian(force.name, q) * f;
  }
  return result;
}

Vector Assembled::accelerations(const Vector& q, const Vector& u) const {
  return solve(mass_matrix(q), forces(q, u));
}

Real Assembled::row_value(const std::string& row, const Vector& q) const {
  const std::vector<BodyMotion> bodies = motion(q);
  for (const TranslationalForceDef& force : def_.translational_forces) {
    if (force.name != row) continue;
    const BodyMotion &b1 = body(bodies, force.body1), &b2 = body(bodies, force.body2);
    return norm(b1.p + b1.R * vec(force.point1) - b2.p - b2.R * vec(force.point2));
  }
  for (const RotationalForceDef& force : def_.rotational_forces) {
    if (force.name != row) continue;
    const BodyMotion &b1 = body(bodies, force.body1), &b2 = body(bodies, force.body2);
    const Vector3 f2 = b2.R * vec(force.f2);
    return std::atan2(dot(f2, b1.R * normalized(vec(force.g1))), dot(f2, b1.R * normalized(vec(force.f1))));
  }
  return q[model_.links[static_cast<std::size_t>(model_.joints[static_cast<std::size_t>(find_joint(model_, row))].link)]
               .q];
}

// d(row)/dt for each unit speed, numerically
Vector Assembled::row_jacobian(const std::string& row, const Vector& q) const {
  Vector J(model_.speed_count());
  const Real here = row_value(row, q);
  for (Index k = 0; k < J.size(); ++k) {
    const Vector rates = coordinate_rates(q, Vector::unit(J.size(), k));
    J[k] = derivative_at_zero([&](Real t) {
      const Real there = row_value(row, q + t * rates);
      // an angle may cross pi between two points of the difference
      return here + std::remainder(there - here, 2 * std::numbers::pi_v<Real>);
    });
  }
  return J;
}

Real Assembled::row_bias(const std::string& row, const Vector& q, const Vector& u) const {
  const Vector rates = coordinate_rates(q, u);
  return derivative_at_zero([&](Real t) { return row_jacobian(row, q + t * rates).dot(u); });
}

Vector Assembled::cut_values(std::size_t j, const Vector& q) const {
  const JointDef& joint = def_.joints[j];
  const std::vector<BodyMotion> bodies = motion(q);
  const BodyMotion &b1 = body(bodies, joint.body1), &b2 = body(bodies, joint.body2);
  const Matrix3 R1 = b1.R * euler_xyz(joint.orientation1), R2 = b2.R * euler_xyz(joint.orientation2);
  const Vector3 d = b2.p + b2.R * vec(joint.point2) - b1.p - b1.R * vec(joint.point1);
  const Vector3 z1 = R1.col(2), z2 = R2.col(2);
  std::vector<Real> g;
  const auto add = [&g](const Vector3& values) { g.insert(g.end(), values.x.begin(), values.x.end()); };
  // the definitions themselves, with more rows than needed where that is simpler
  const Vector3 across = d - z1 * dot(z1, d);
  switch (joint.type) {
    case JointType::spherical:
      add(d);
      break;
    case JointType::revolute:
      add(d), add(cross(z1, z2));
      break;
    case JointType::fixed:
      add(d), add(R1.col(0) - R2.col(0)), add(R1.col(1) - R2.col(1));
      break;
    case JointType::prismatic:
      add(across), add(R1.col(0) - R2.col(0)), add(R1.col(1) - R2.col(1));
      break;
    case JointType::cylindrical:
      add(across), add(cross(z1, z2));
      break;
    case JointType::universal:
      add(d), g.push_back(dot(z1, z2));
      break;
    case JointType::in_plane:
      g.push_back(dot(z1, d));
      break;
    case JointType::in_line:
      add(across);
      break;
    case JointType::perpendicular:
      g.push_back(dot(z1, z2));
      break;
    case JointType::spherical_spherical:
      g.push_back(norm(d));
      break;
    case JointType::revolute_spherical:
      add(Vector3(norm(d), dot(z1, d), 0));
      break;
    case JointType::revolute_revolute:
      g.insert(g.end(), {norm(d), dot(z1, d), dot(z2, d), dot(z1, z2)});
      break;
    default:
      throw std::logic_error("a floating joint holds nothing");
  }
  return Vector::column(std::move(g));
}

Matrix Assembled::cut_jacobian(std::size_t j, const Vector& q) const {
  const Index n = model_.speed_count();
  Matrix J(cut_values(j, q).size(), n);
  for (Index k = 0; k < n; ++k) {
    const Vector rates = coordinate_rates(q, Vector::unit(n, k));
    J.put(0, k, derivative_at_zero([&](Real t) { return cut_values(j, q + t * rates); }));
  }
  return J;
}

Vector Assembled::cut_bias(std::size_t j, const Vector& q, const Vector& u) const {
  const Vector rates = coordinate_rates(q, u);
  return derivative_at_zero([&](Real t) { return cut_jacobian(j, q + t * rates) * u; });
}

}  // namespace slew::multibody::testing
