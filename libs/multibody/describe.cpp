#include <cstddef>

#include "multibody/observe.h"

namespace slew::multibody {

Description describe(const Model& model) {
  constexpr const char* kTypes[] = {"revolute", "prismatic", "spherical", "fixed", "floating"};
  constexpr int kFreedoms[] = {1, 1, 3, 0, 6};  // by JointType
  Description text;
  text.bodies = static_cast<int>(model.bodies.size()) - 1;
  text.joints = static_cast<int>(model.joints.size());
  text.degrees_of_freedom = model.degrees_of_freedom();
  text.rows = model.row_count();
  text.links.resize(model.links.size() - 1);
  for (const Joint& joint : model.joints) {
    if (joint.link == 0) continue;
    LinkDescription& link = text.links[static_cast<std::size_t>(joint.link) - 1];
    link.joint = joint.name;
    link.joint_type = kTypes[static_cast<std::size_t>(joint.type)];
    link.degrees_of_freedom = kFreedoms[static_cast<std::size_t>(joint.type)];
  }
  for (std::size_t i = 1; i < model.bodies.size(); ++i) {
    const Body& body = model.bodies[i];
    if (body.link == 0) {
      text.fixed_to_ground.push_back(body.name);
    } else {
      text.links[static_cast<std::size_t>(body.link) - 1].bodies.push_back(body.name);
    }
  }
  return text;
}

}  // namespace slew::multibody
