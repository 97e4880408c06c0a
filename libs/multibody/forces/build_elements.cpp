#include "multibody/forces/build_elements.h"

#include <algorithm>
#include <cstddef>

namespace slew::multibody {
namespace {

using math::Mat3;
using math::Vec3;

class ElementBuilder {
 public:
  ElementBuilder(const MechanicsDef& def, std::span<const Pose> poses, Model& model)
      : def_(def), poses_(poses), model_(model) {}

  void run() {
    for (const PointForceDef& def : def_.point_forces) add_load(def, LoadKind::force, def.force, def.force_table);
    for (const PointTorqueDef& def : def_.point_torques) add_load(def, LoadKind::torque, def.torque, def.torque_table);
    for (const BushingDef& def : def_.bushings) add_bushing(def);
    for (const BeamDef& def : def_.beams) add_beam(def);
    for (const RopeDef& def : def_.ropes) add_rope(def);
    for (const TyreDummyDef& def : def_.tyre_dummies) add_tyre(def);
    for (const PartDummyDef& def : def_.part_dummies) {
      add_mass(def, number_of_(def.carried_by), pose_in(poses_[at(number_of_(def.relative_to))], def));
    }
    for (const ConstraintDummyDef& def : def_.constraint_dummies) add_constraint_dummy(def);
  }

 private:
  static std::size_t at(int index) { return static_cast<std::size_t>(index); }
  [[nodiscard]] const Body& body_at(int body) const { return model_.bodies[at(body)]; }
  [[nodiscard]] Vec3 in_link(int body, const Triple& point) const {
    return body_at(body).p_LB + body_at(body).R_LB * Vec3(point);
  }

  template <typename Def>
  void add_load(const Def& def, LoadKind kind, double constant, const Table& table) {
    const int body = number_of_(def.body);
    PointLoad load{.name = def.name,
                   .kind = kind,
                   .axes = def.axes,
                   .link = body_at(body).link,
                   .body = body,
                   .p_L = {},
                   .direction = Vec3(def.direction) * (1 / norm(Vec3(def.direction))),
                   .constant = constant,
                   .table = math::monotone_cubic(table, math::Ends::hold)};
    if constexpr (requires { def.point; }) load.p_L = in_link(body, def.point);
    if (def.axes == LoadAxes::body) load.direction = body_at(body).R_LB * load.direction;
    model_.elements.loads.push_back(std::move(load));
  }

  [[nodiscard]] FramePair frames_of(const ConnectorFrames& def) const {
    const int body1 = number_of_(def.body1), body2 = number_of_(def.body2);
    return {.link1 = body_at(body1).link,
            .link2 = body_at(body2).link,
            .body1 = body1,
            .body2 = body2,
            .R_L1 = body_at(body1).R_LB * math::rotation_xyz(def.orientation1),
            .R_L2 = body_at(body2).R_LB * math::rotation_xyz(def.orientation2),
            .p_L1 = in_link(body1, def.point1),
            .p_L2 = in_link(body2, def.point2),
            .rest = {}};
  }

  static Six six_of(const Triple& along, const Triple& about) {
    return {along[0], along[1], along[2], about[0], about[1], about[2]};
  }

  void add_bushing(const BushingDef& def) {
    Bushing bushing{.name = def.name,
                    .frames = frames_of(def.frames),
                    .spring = six_of(def.stiffness, def.rotational_stiffness),
                    .damping = six_of(def.damping, def.rotational_damping),
                    .preload = six_of(def.preload_force, def.preload_moment)};
    std::copy(def.stiffness_matrix.begin(), def.stiffness_matrix.end(), bushing.K.begin());
    std::copy(def.damping_matrix.begin(), def.damping_matrix.end(), bushing.D.begin());
    bushing.has_coupling = !def.stiffness_matrix.empty() || !def.damping_matrix.empty();
    for (int i = 0; i < 6; ++i) {
      const Table& spring = *def.spring_tables.all()[at(i)];
      const Table& damper = *def.damper_tables.all()[at(i)];
      if (!spring.empty()) bushing.curves.push_back({i, false, math::monotone_cubic(spring, math::Ends::continued)});
      if (!damper.empty()) bushing.curves.push_back({i, true, math::monotone_cubic(damper, math::Ends::not_falling)});
    }
    model_.elements.bushings.push_back(std::move(bushing));
  }

  void add_beam(const BeamDef& def) {
    const double shear_modulus =
        def.shear_modulus > 0 ? def.shear_modulus : def.youngs_modulus / (2 * (1 + def.poisson_ratio));
    Beam beam{.name = def.name,
              .frames = frames_of(def.frames),
              .K = stiffness_of({.length = def.length,
                                 .youngs_modulus = def.youngs_modulus,
                                 .shear_modulus = shear_modulus,
                                 .area = def.area,
                                 .second_moment_y = def.second_moment_y,
                                 .second_moment_z = def.second_moment_z,
                                 .torsion_constant = def.torsion_constant,
                                 .shear_factor_y = def.shear_factor_y,
                                 .shear_factor_z = def.shear_factor_z}),
              .damping_time = def.damping_time};
    beam.frames.rest = Vec3(def.length, 0, 0);
    model_.elements.beams.push_back(std::move(beam));
  }

  void add_rope(const RopeDef& def) {
    Rope rope{.name = def.name,
              .points = {},
              .free_length = def.free_length,
              .spring = def.stiffness,
              .rigidity = def.axial_rigidity,
              .damping = def.damping_constant,
              .spring_curve = math::monotone_cubic(def.spring_table, math::Ends::not_falling),
              .damper_curve = math::monotone_cubic(def.damper_table, math::Ends::not_falling)};
    for (std::size_t k = 0; k < def.points.size(); ++k) {
      const int body = number_of_(def.bodies[k]);
      rope.points.push_back({body_at(body).link, body, in_link(body, def.points[k])});
    }
    model_.elements.ropes.push_back(std::move(rope));
  }

  // a dummy's frame in Ground, from the frame that its Def refers to
  template <typename Def>
  static Pose pose_in(const Pose& frame, const Def& def) {
    return {frame.R * math::rotation_zxz(def.orientation), frame.p + frame.R * Vec3(def.position)};
  }

  void add_tyre(const TyreDummyDef& def) {
    const int number = number_of_(def.relative_to);
    const Body& body = body_at(number);
    model_.elements.tyres.push_back({.name = def.name,
                                     .link = body.link,
                                     .body = number,
                                     .c_L = in_link(number, def.position),
                                     .axle_L = body.R_LB * math::rotation_zxz(def.orientation).c[2],
                                     .normal_W = Vec3(def.ground_normal) * (1 / norm(Vec3(def.ground_normal))),
                                     .height = def.ground_height,
                                     .radius = def.radius,
                                     .stiffness = def.stiffness,
                                     .damping = def.damping,
                                     .friction = def.friction,
                                     .longitudinal = def.longitudinal_slip_slope,
                                     .lateral = def.lateral_slip_slope,
                                     .rolling_resistance = def.rolling_resistance,
                                     .slip_speed = def.slip_speed,
                                     .rolling = def.rolling});
    add_mass(def, number, pose_in(poses_[at(number)], def));
  }

  void add_constraint_dummy(const ConstraintDummyDef& def) {
    const auto joint = std::find_if(def_.joints.begin(), def_.joints.end(),
                                    [&](const JointDef& candidate) { return candidate.name == def.relative_to; });
    const int body1 = number_of_(joint->body1), body2 = number_of_(joint->body2);
    const JointFrames frames = joint_frames(*joint, poses_[at(body1)], poses_[at(body2)]);
    const bool is_first = def.index == 1;
    add_mass(def, is_first ? body1 : body2, pose_in(is_first ? frames.frame1 : frames.frame2, def));
  }

  // fixed to the body's link as the start poses have it
  template <typename Def>
  void add_mass(const Def& def, int number, const Pose& dummy) {
    const Body& body = body_at(number);
    const Pose& carrier = poses_[at(number)];
    const Mat3 R_LD = body.R_LB * (math::transpose(carrier.R) * dummy.R);
    const Vec3 p_LD = body.p_LB + body.R_LB * (math::transpose(carrier.R) * (dummy.p - carrier.p));
    Triple inertia = def.inertia;
    Vec3 center;
    if constexpr (requires { def.center_of_mass; }) center = Vec3(def.center_of_mass);
    if constexpr (requires { def.rolling; }) {
      if (def.rolling == TyreRolling::free) inertia[2] = 0;
    }
    const Mat3 I = Mat3::diagonal(inertia[0], inertia[1], inertia[2]);
    model_.lumped.push_back({.c_L = p_LD + R_LD * center,
                             .I_c = R_LD * I * math::transpose(R_LD),
                             .mass = def.mass,
                             .reference_mass = def.mass,
                             .link = body.link,
                             .owner = number});
  }

  const MechanicsDef& def_;
  BodyNumbers number_of_{def_};
  std::span<const Pose> poses_;
  Model& model_;
};

}  // namespace

void add_elements(const MechanicsDef& def, std::span<const Pose> poses, Model& model) {
  ElementBuilder(def, poses, model).run();
}

}  // namespace slew::multibody
