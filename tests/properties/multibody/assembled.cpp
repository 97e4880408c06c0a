#include "tests/properties/multibody/assembled.h"

#include <cmath>
#include <stdexcept>

namespace slew::multibody::testing {
namespace {

Vector3 vec(const Triple& t) {
  return {t[0], t[1], t[2]};
}

Matrix3 about(int axis, Real angle) {
  return Eigen::AngleAxis<Real>(angle, Vector3::Unit(axis)).toRotationMatrix();
}

Matrix3 euler_zxz(const Triple& a) {
  return about(2, a[0]) * about(0, a[1]) * about(2, a[2]);
}
Matrix3 euler_xyz(const Triple& a) {
  return about(0, a[0]) * about(1, a[1]) * about(2, a[2]);
}

Matrix3 cross_matrix(const Vector3& v) {
  Matrix3 m;
  m << 0, -v[2], v[1], v[2], 0, -v[0], -v[1], v[0], 0;
  return m;
}

Columns point_jacobian(const BodyMotion& body, const Vector3& arm) {
  return body.Jp - cross_matrix(arm) * body.Jw;
}

// joint frames in parent and child
struct Sides {
  const BodyMotion* parent;
  Matrix3 R_P, R_C;
  Vector3 p_P, p_C;
  Real sign;  // of the coordinate: the child is body 2 (+) or body 1 (-)
};

Matrix3 quaternion_matrix(const Vector& q, int i) {
  return Eigen::Quaternion<Real>(q[i], q[i + 1], q[i + 2], q[i + 3]).normalized().toRotationMatrix();
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
  const int n = model_.speed_count();
  std::vector<BodyMotion> bodies(def_.bodies.size() + 1);
  std::vector<bool> is_placed(bodies.size(), false);
  is_placed[0] = true;
  for (BodyMotion& b : bodies) b.Jw = b.Jp = Columns::Zero(3, n);
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
      const Matrix3 frame = parent.R * R_P;
      const Vector3 axis = frame.col(2);
      Vector3 point = parent.p + parent.R * p_P;
      child.Jw = parent.Jw;
      child.Jp = point_jacobian(parent, parent.R * p_P);  // of the joint's point for now
      switch (joint.type) {
        case JointType::fixed:
          child.R = frame * R_C.transpose();
          break;
        case JointType::revolute:
          child.R = frame * about(2, sign * q[link.q]) * R_C.transpose();
          child.Jw.col(link.u) += sign * axis;
          break;
        case JointType::prismatic: {
          child.R = frame * R_C.transpose();
          const Vector3 slide = axis * (sign * q[link.q]);
          child.Jp -= cross_matrix(slide) * parent.Jw;
          child.Jp.col(link.u) += sign * axis;
          point += slide;
          break;
        }
        case JointType::spherical:
          child.R = quaternion_matrix(q, link.q) * R_C.transpose();
          child.Jw.middleCols(link.u, 3) += Matrix3::Identity();
          break;
        case JointType::cylindrical: {
          child.R = frame * about(2, sign * q[link.q]) * R_C.transpose();
          const Vector3 slide = axis * (sign * q[link.q + 1]);
          child.Jw.col(link.u) += sign * axis;
          child.Jp -= cross_matrix(slide) * parent.Jw;
          child.Jp.col(link.u + 1) += sign * axis;
          point += slide;
          break;
        }
        case JointType::universal: {
          // R_12 = Rz(a1) [y z x] Rz(a2); from body 2 to body 1 its coordinates are a2, a1
          Matrix3 cross;
          cross << 0, 0, 1, 1, 0, 0, 0, 1, 0;
          const Matrix3 R_12 = is_forward ? Matrix3(about(2, q[link.q]) * cross * about(2, q[link.q + 1]))
                                          : Matrix3(about(2, q[link.q + 1]) * cross * about(2, q[link.q]));
          const Matrix3 moved = frame * (is_forward ? R_12 : Matrix3(R_12.transpose()));
          child.R = moved * R_C.transpose();
          child.Jw.col(link.u) += sign * axis;
          child.Jw.col(link.u + 1) += sign * moved.col(2);
          break;
        }
        case JointType::floating:
          child.R = quaternion_matrix(q, link.q + 3) * R_C.transpose();
          point = q.segment(link.q, 3);
          child.Jw.setZero();
          child.Jp.setZero();
          child.Jp.middleCols(link.u, 3) = Matrix3::Identity();
          child.Jw.middleCols(link.u + 3, 3) = Matrix3::Identity();
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
      child.Jp -= cross_matrix(arm) * child.Jw;
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
        Vector3 result = Vector3::Zero();
        for (std::size_t k = 0; k < shapes.size(); ++k) {
          result += vec(shapes[k].array()) * at[part.q + static_cast<Eigen::Index>(k)];
        }
        return result;
      };
      const auto turned = [&](const Vector& at) {
        const Vector3 theta = sum(n.turn, at);
        const Real angle = theta.norm();
        return angle == 0 ? Matrix3(Matrix3::Identity()) : Eigen::AngleAxis<Real>(angle, theta / angle).matrix();
      };
      const Vector3 arm = frame.R * (vec(n.position.array()) + sum(n.shift, q));
      const Matrix3 turn = turned(q);
      node.R = frame.R * turn;
      node.p = frame.p + arm;
      node.Jw = frame.Jw;
      node.Jp = point_jacobian(frame, arm);
      for (std::size_t k = 0; k < part.modes; ++k) {
        const Eigen::Index u = part.u + static_cast<Eigen::Index>(k);
        const Vector e = Vector::Unit(q.size(), part.q + static_cast<Eigen::Index>(k));
        const Matrix3 spin = derivative_at_zero([&](Real t) { return Matrix3(turned(q + t * e)); }) * turn.transpose();
        node.Jw.col(u) += frame.R * Vector3(spin(2, 1), spin(0, 2), spin(1, 0));
        node.Jp.col(u) += frame.R * vec(n.shift[k].array());
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
        x += vec(point.phi[k].array()) * q[part.q + static_cast<Eigen::Index>(k)];
      }
      Mass mass{point.mass, Matrix3::Zero(), point_jacobian(frame, frame.R * x), frame.Jw, frame.p + frame.R * x};
      for (std::size_t k = 0; k < part.modes; ++k) {
        mass.Jv.col(part.u + static_cast<Eigen::Index>(k)) += frame.R * vec(point.phi[k].array());
      }
      list.push_back(mass);
    }
  }
}

Vector Assembled::coordinate_rates(const Vector& q, const Vector& u) const {
  Vector rates = Vector::Zero(q.size());
  const std::vector<BodyMotion> bodies = motion(q);
  for (const FlexiblePart& part : model_.parts) {
    const auto modes = static_cast<Eigen::Index>(part.modes);
    rates.segment(part.q, modes) = u.segment(part.u, modes);
  }
  for (std::size_t j = 0; j < def_.joints.size(); ++j) {
    const Joint& joint = model_.joints[j];
    const Link& link = model_.links[static_cast<std::size_t>(joint.link)];
    if (joint.link == 0) continue;  // not in the tree, or nothing moves
    if (joint.type == JointType::revolute || joint.type == JointType::prismatic) {
      rates[link.q] = u[link.u];
    } else if (joint.type == JointType::universal || joint.type == JointType::cylindrical) {
      rates.segment(link.q, 2) = u.segment(link.u, 2);
    } else if (joint.type == JointType::spherical || joint.type == JointType::floating) {
      const std::string& name = joint.is_reversed ? def_.joints[j].body1 : def_.joints[j].body2;
      const Vector3 w = body(bodies, name).Jw * u;
      int i = link.q;
      if (joint.type == JointType::floating) {
        rates.segment(i, 3) = u.segment(link.u, 3);
        i += 3;
      }
      const Eigen::Quaternion<Real> spin(0, w[0] / 2, w[1] / 2, w[2] / 2), now(q[i], q[i + 1], q[i + 2], q[i + 3]);
      const Eigen::Quaternion<Real> rate = spin * now;
      rates.segment(i, 4) << rate.w(), rate.x(), rate.y(), rate.z();
    }
  }
  return rates;
}

std::vector<Assembled::Mass> Assembled::masses(const Vector& q) const {
  const std::vector<BodyMotion> bodies = motion(q);
  std::vector<Mass> list;
  const auto add = [&list](const BodyMotion& on, Real mass, const Vector3& center, const Matrix3& inertia) {
    list.push_back(
        {mass, on.R * inertia * on.R.transpose(), point_jacobian(on, on.R * center), on.Jw, on.p + on.R * center});
  };
  for (std::size_t i = 0; i < def_.bodies.size(); ++i) {
    const BodyDef& def = def_.bodies[i];
    if (points_.contains(def.name)) continue;
    Matrix3 I;
    I << def.inertia[0], def.products[0], def.products[1], def.products[0], def.inertia[1], def.products[2],
        def.products[1], def.products[2], def.inertia[2];
    const Vector3 c = vec(def.center_of_mass);
    if (def.inertia_about == InertiaPoint::body_origin) {
      I -= def.mass * (c.squaredNorm() * Matrix3::Identity() - c * c.transpose());
    }
    add(bodies[i + 1], def.mass, c, I);
  }
  for (const StaticDummyDef& def : def_.static_dummies) {
    const Matrix3 R = euler_zxz(def.orientation);
    const Matrix3 I = R * vec(def.inertia).asDiagonal() * R.transpose();
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
      const Real length = d.norm();
      const Vector3 e = d / length;
      const Columns Je = (Matrix3::Identity() - e * e.transpose()) * (J1 - J2) / length;
      const Real c = dummy.center_of_mass[0];
      const bool is_cylinder = dummy.index == 1;
      // it turns with e x e', without spin about e
      list.push_back({dummy.mass, (dummy.inertia[1] + dummy.inertia[2]) / 2 * Matrix3::Identity(),
                      (is_cylinder ? J1 : J2) + c * Je, cross_matrix(e) * Je,
                      (is_cylinder ? Vector3(b1.p + s1) : Vector3(b2.p + s2)) + c * e});
    }
  }
}

Matrix Assembled::mass_matrix(const Vector& q) const {
  const int n = model_.speed_count();
  Matrix M = Matrix::Zero(n, n);
  for (const Mass& m : masses(q)) {
    M += m.mass * m.Jv.transpose() * m.Jv + m.Jw.transpose() * m.inertia * m.Jw;
  }
  return M;
}

Real Assembled::potential(const Vector& q) const {
  Real sum = 0;
  for (const Mass& m : masses(q)) sum -= m.mass * vec(def_.gravity).dot(m.center);
  for (const FlexibleBodyDef& def : def_.flexible_bodies) {
    const FlexiblePart& part = part_of(def.body);
    for (std::size_t k = 0; k < part.modes * part.modes; ++k) {
      const auto row = static_cast<Eigen::Index>(k / part.modes), column = static_cast<Eigen::Index>(k % part.modes);
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
    Vector v(6 * static_cast<Eigen::Index>(then.size()));
    for (std::size_t i = 0; i < then.size(); ++i) {
      const auto k = 6 * static_cast<Eigen::Index>(i);
      v.segment(k, 3) = then[i].Jv * u;
      v.segment(k + 3, 3) = then[i].Jw * u;
    }
    return v;
  };
  const Vector bias = derivative_at_zero(velocities);
  for (std::size_t i = 0; i < now.size(); ++i) {
    const Mass& m = now[i];
    const auto k = 6 * static_cast<Eigen::Index>(i);
    const Vector3 w = m.Jw * u, a = bias.segment(k, 3), alpha = bias.segment(k + 3, 3);
    result -= m.Jv.transpose() * (m.mass * (a - vec(def_.gravity)));
    result -= m.Jw.transpose() * (m.inertia * alpha + w.cross(m.inertia * w));
  }
  return result;
}

Vector Assembled::element_forces(const Vector& q, const Vector& u) const {
  const std::vector<BodyMotion> bodies = motion(q);
  Vector result = Vector::Zero(u.size());
  for (const FlexibleBodyDef& def : def_.flexible_bodies) {
    const FlexiblePart& part = part_of(def.body);
    const auto n = static_cast<Eigen::Index>(part.modes);
    for (Eigen::Index k = 0; k < n; ++k) {
      for (Eigen::Index l = 0; l < n; ++l) {
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
    const Vector3 axis = (b1.R * vec(force.f1).cross(vec(force.g1))).normalized();
    const Vector damper = (b2.Jw - b1.Jw).transpose() * axis;
    result -= damper * (force.damping_constant * damper.dot(u));
    if (force.spring_constant == 0) continue;
    const Real f = -force.spring_constant * (row_value(force.name, q) - force.free_angle);
    result += row_jacobian(force.name, q) * f;
  }
  return result;
}

Vector Assembled::accelerations(const Vector& q, const Vector& u) const {
  return mass_matrix(q).ldlt().solve(forces(q, u));
}

Real Assembled::row_value(const std::string& row, const Vector& q) const {
  const std::vector<BodyMotion> bodies = motion(q);
  for (const TranslationalForceDef& force : def_.translational_forces) {
    if (force.name != row) continue;
    const BodyMotion &b1 = body(bodies, force.body1), &b2 = body(bodies, force.body2);
    return (b1.p + b1.R * vec(force.point1) - b2.p - b2.R * vec(force.point2)).norm();
  }
  for (const RotationalForceDef& force : def_.rotational_forces) {
    if (force.name != row) continue;
    const BodyMotion &b1 = body(bodies, force.body1), &b2 = body(bodies, force.body2);
    const Vector3 f2 = b2.R * vec(force.f2);
    return std::atan2(f2.dot(b1.R * vec(force.g1).normalized()), f2.dot(b1.R * vec(force.f1).normalized()));
  }
  return q[model_.links[static_cast<std::size_t>(model_.joints[static_cast<std::size_t>(find_joint(model_, row))].link)]
               .q];
}

// d(row)/dt for each unit speed, numerically
Vector Assembled::row_jacobian(const std::string& row, const Vector& q) const {
  Vector J(model_.speed_count());
  const Real here = row_value(row, q);
  for (Eigen::Index k = 0; k < J.size(); ++k) {
    const Vector rates = coordinate_rates(q, Vector::Unit(J.size(), k));
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
  const auto add = [&g](const auto& values) { g.insert(g.end(), values.begin(), values.end()); };
  // the definitions themselves, with more rows than needed where that is simpler
  const Vector3 across = d - z1 * z1.dot(d);
  switch (joint.type) {
    case JointType::spherical:
      add(d);
      break;
    case JointType::revolute:
      add(d), add(Vector3(z1.cross(z2)));
      break;
    case JointType::fixed:
      add(d), add(Vector3(R1.col(0) - R2.col(0))), add(Vector3(R1.col(1) - R2.col(1)));
      break;
    case JointType::prismatic:
      add(across), add(Vector3(R1.col(0) - R2.col(0))), add(Vector3(R1.col(1) - R2.col(1)));
      break;
    case JointType::cylindrical:
      add(across), add(Vector3(z1.cross(z2)));
      break;
    case JointType::universal:
      add(d), g.push_back(z1.dot(z2));
      break;
    case JointType::in_plane:
      g.push_back(z1.dot(d));
      break;
    case JointType::in_line:
      add(across);
      break;
    case JointType::perpendicular:
      g.push_back(z1.dot(z2));
      break;
    case JointType::spherical_spherical:
      g.push_back(d.norm());
      break;
    case JointType::revolute_spherical:
      add(Vector3(d.norm(), z1.dot(d), 0));
      break;
    case JointType::revolute_revolute:
      g.insert(g.end(), {d.norm(), z1.dot(d), z2.dot(d), z1.dot(z2)});
      break;
    default:
      throw std::logic_error("a floating joint holds nothing");
  }
  return Eigen::Map<Vector>(g.data(), static_cast<Eigen::Index>(g.size()));
}

Matrix Assembled::cut_jacobian(std::size_t j, const Vector& q) const {
  const Eigen::Index n = model_.speed_count();
  Matrix J(cut_values(j, q).size(), n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const Vector rates = coordinate_rates(q, Vector::Unit(n, k));
    J.col(k) = derivative_at_zero([&](Real t) { return cut_values(j, q + t * rates); });
  }
  return J;
}

Vector Assembled::cut_bias(std::size_t j, const Vector& q, const Vector& u) const {
  const Vector rates = coordinate_rates(q, u);
  return derivative_at_zero([&](Real t) { return Vector(cut_jacobian(j, q + t * rates) * u); });
}

}  // namespace slew::multibody::testing
