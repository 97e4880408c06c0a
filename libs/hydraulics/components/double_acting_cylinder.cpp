#include "hydraulics/components/double_acting_cylinder.h"

#include <numbers>
#include "hydraulics/components/chamber_pair.h"
#include "hydraulics/components/cylinder_rules.h"

namespace slew::hydraulics {
namespace {

constexpr Field kDoubleActingCylinderFields[] = {
    field<&DoubleActingCylinderDef::force>(
        "force",
        {.presence = Presence::required, .reference = "force", .doc = "force element that the cylinder drives"}),
    field<&DoubleActingCylinderDef::friction_curve>(
        "friction_curve", {.reference = "curve", .doc = "friction coefficient over piston speed"}),
    field<&DoubleActingCylinderDef::port_a>(
        "port_a", {.presence = Presence::required, .reference = "volume", .doc = "volume at port A"}),
    field<&DoubleActingCylinderDef::port_b>(
        "port_b", {.presence = Presence::required, .reference = "volume", .doc = "volume at port B"}),
    field<&DoubleActingCylinderDef::piston_diameter>("piston_diameter", {.dimension = Dimension::length,
                                                                         .range = kPositive,
                                                                         .presence = Presence::required,
                                                                         .doc = "diameter of the piston"}),
    field<&DoubleActingCylinderDef::rod_diameter>("rod_diameter", {.dimension = Dimension::length,
                                                                   .range = kPositive,
                                                                   .presence = Presence::required,
                                                                   .doc = "diameter of the piston rod"}),
    field<&DoubleActingCylinderDef::piston_length>("piston_length", {.dimension = Dimension::length,
                                                                     .range = kNotNegative,
                                                                     .presence = Presence::required,
                                                                     .doc = "length of the piston"}),
    field<&DoubleActingCylinderDef::chamber_length>("chamber_length", {.dimension = Dimension::length,
                                                                       .range = kPositive,
                                                                       .presence = Presence::required,
                                                                       .doc = "inner length of the barrel"}),
    field<&DoubleActingCylinderDef::rod_length>("rod_length", {.dimension = Dimension::length,
                                                               .range = kNotNegative,
                                                               .presence = Presence::required,
                                                               .doc = "length of the piston rod"}),
    field<&DoubleActingCylinderDef::attachment_length>(
        "attachment_length",
        {.dimension = Dimension::length, .range = kNotNegative, .doc = "length of the attachment"}),
    field<&DoubleActingCylinderDef::minimum_stroke>("minimum_stroke", {.dimension = Dimension::length,
                                                                       .range = kNotNegative,
                                                                       .presence = Presence::required,
                                                                       .doc = "stroke at the lower end damper"}),
    field<&DoubleActingCylinderDef::maximum_stroke>("maximum_stroke", {.dimension = Dimension::length,
                                                                       .range = kPositive,
                                                                       .presence = Presence::required,
                                                                       .doc = "stroke at the upper end damper"}),
    field<&DoubleActingCylinderDef::bulk_modulus>(
        "bulk_modulus", {.dimension = Dimension::pressure, .range = kPositive, .doc = "bulk modulus of the barrel"}),
    field<&DoubleActingCylinderDef::cylinder_coefficient>(
        "cylinder_coefficient", {.range = kFraction, .doc = "efficiency eta; 1 - eta scales the friction curve"}),
    field<&DoubleActingCylinderDef::seal_friction>(
        "seal_friction", {.dimension = Dimension::force, .range = kNotNegative, .doc = "friction at equal pressures"}),
    field<&DoubleActingCylinderDef::leak_flow>("leak_flow", {.dimension = Dimension::volume_flow,
                                                             .range = kNotNegative,
                                                             .change = Change::live,
                                                             .doc = "leak across the piston at leak_pressure"}),
    field<&DoubleActingCylinderDef::leak_pressure>(
        "leak_pressure",
        {.dimension = Dimension::pressure, .range = kPositive, .doc = "pressure difference of leak_flow"}),
    field<&DoubleActingCylinderDef::end_stiffness>(
        "end_stiffness",
        {.dimension = Dimension::stiffness, .range = kNotNegative, .doc = "spring constant of the end dampers"}),
    field<&DoubleActingCylinderDef::end_damping>(
        "end_damping",
        {.dimension = Dimension::damping, .range = kNotNegative, .doc = "damping constant of the end dampers"}),
    field<&DoubleActingCylinderDef::dead_volume>(
        "dead_volume",
        {.dimension = Dimension::volume, .range = kNotNegative, .doc = "oil in each chamber beyond the stroke"}),
};

Actuator actuator_of(const DoubleActingCylinderDef& def, const CircuitBuilder& builder) {
  const double D = def.piston_diameter, d = def.rod_diameter;
  return {.name = def.name,
          .force = def.force,
          .port_a = builder.volume(def.port_a),
          .port_b = builder.volume(def.port_b),
          .area_a = 0.25 * std::numbers::pi * D * D,
          .area_b = 0.25 * std::numbers::pi * (D * D - d * d),
          .coordinate = {.offset = -(def.attachment_length + def.rod_length), .ratio = 1},
          .line_force = {.friction_curve = def.friction_curve,
                         .cylinder_coefficient = def.cylinder_coefficient,
                         .seal_friction = def.seal_friction,
                         .end_stiffness = def.end_stiffness,
                         .end_damping = def.end_damping,
                         .minimum_stroke = def.minimum_stroke,
                         .maximum_stroke = def.maximum_stroke},
          .start = StartRule::return_pressure};
}

class DoubleActingCylinder final : public HydraulicComponent {
 public:
  DoubleActingCylinder(const DoubleActingCylinderDef& def, CircuitBuilder& builder)
      : HydraulicComponent(def),
        def_(def),
        chambers_(builder, actuator_of(def, builder), def.chamber_length - def.piston_length, def.dead_volume,
                  def.bulk_modulus) {
    apply_parameters();
  }
  void declare_dependencies(DependencyList& dependencies) const override {
    chambers_.declare_dependencies(dependencies);
  }
  void add_rates(const CircuitView& view, Rates& rates) const noexcept override { chambers_.add_rates(view, rates); }
  void add_jacobian(const CircuitView&, JacobianStamp& jacobian) const noexcept override {
    chambers_.add_jacobian(jacobian);
  }
  void list_variables(std::vector<ElementVariable>& variables) const override {
    variables.push_back(variable("stroke", Dimension::length));
    variables.push_back(variable("speed", Dimension::velocity));
    variables.push_back(variable("pressure_a", Dimension::pressure));
    variables.push_back(variable("pressure_b", Dimension::pressure));
    variables.push_back(variable("pressure_force", Dimension::force));
    variables.push_back(variable("force", Dimension::force));
    variables.push_back(variable("flow_a", Dimension::volume_flow));
    variables.push_back(variable("flow_b", Dimension::volume_flow));
    variables.push_back(variable("leak_flow", Dimension::volume_flow));
  }
  double* read_variables(const CircuitView& view, double* values) const noexcept override {
    const double v = view[chambers_.speed()], line_force = view.line_force[chambers_.actuator()];
    *values++ = view[chambers_.position()];
    *values++ = v;
    *values++ = view[chambers_.port_a()];
    *values++ = view[chambers_.port_b()];
    *values++ = chambers_.pressure_force(view);
    *values++ = line_force;
    // into the chambers
    *values++ = v * chambers_.area_a();
    *values++ = -v * chambers_.area_b();
    *values++ = chambers_.leak(view);
    return values;
  }
  [[nodiscard]] void* def_address() noexcept override { return &def_; }
  void apply_parameters() noexcept override { chambers_.set_leak(def_.leak_flow / def_.leak_pressure); }

 private:
  DoubleActingCylinderDef def_;
  ChamberPair chambers_;
};

void validate_cylinder(const HydraulicsDef& circuit, const ComponentDef& component, Problems& errors, Problems&) {
  const DoubleActingCylinderDef& def = static_cast<const DoubleActingCylinderDef&>(component);
  if (!(def.rod_diameter < def.piston_diameter)) {
    errors.push_back(
        {def.name + ".rod_diameter", "the rod is not thinner than the piston", "less than piston_diameter", ""});
  }
  check_cylinder(circuit,
                 {.def = def,
                  .friction_curve = def.friction_curve,
                  .port_a = def.port_a,
                  .port_b = def.port_b,
                  .minimum_stroke = def.minimum_stroke,
                  .maximum_stroke = def.maximum_stroke,
                  .span = def.chamber_length - def.piston_length,
                  .dead_volume = def.dead_volume,
                  .end_stiffness = def.end_stiffness,
                  .piston_diameter = def.piston_diameter,
                  .rod_diameter = def.rod_diameter},
                 errors);
}

}  // namespace

ComponentType double_acting_cylinder_type() {
  return {.name = "double_acting_cylinder",
          .fields = kDoubleActingCylinderFields,
          .doc = "double-acting cylinder on a translational force",
          .make_def = []() -> std::unique_ptr<ComponentDef> { return std::make_unique<DoubleActingCylinderDef>(); },
          .validate = validate_cylinder,
          .build = [](const ComponentDef& def, CircuitBuilder& builder) -> std::unique_ptr<HydraulicComponent> {
            return std::make_unique<DoubleActingCylinder>(static_cast<const DoubleActingCylinderDef&>(def), builder);
          },
          .is_actuator = true};
}

}  // namespace slew::hydraulics
