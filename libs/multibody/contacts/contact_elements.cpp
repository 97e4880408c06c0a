// SPDX-License-Identifier: Apache-2.0
#include "multibody/contacts/contact_elements.h"

#include <utility>

#include "contact/find_named.h"
#include "core/check.h"
#include "multibody/contacts/contact_conversion.h"
#include "multibody/model/model.h"

namespace slew::multibody {
namespace {

const ShapeDef& named(const std::vector<ShapeDef>& shapes, const std::string& name) {
  const ShapeDef* shape = contact::find_named(shapes, name);
  SLEW_CHECK(shape != nullptr);
  return *shape;
}

class ContactBuilder {
 public:
  ContactBuilder(const MechanicsDef& mechanics, const Model& model) : mechanics_(mechanics), model_(model) {}

  std::shared_ptr<const ContactElements> run() {
    std::vector<ContactPairElement> pairs;
    std::vector<int> pair_of_tested;
    for (const ContactPairDef& pair : mechanics_.contacts) {
      ContactPairElement& element =
          pairs.emplace_back(ContactPairElement{pair.name, static_cast<std::size_t>(pair.point_variables)});
      const ShapeDef& a = named(mechanics_.shapes, pair.shape_a);
      const ShapeDef& b = named(mechanics_.shapes, pair.shape_b);
      if (link_of(a) == link_of(b) || !pair.tested) continue;
      element.tested = static_cast<int>(def_.pairs.size());
      pair_of_tested.push_back(static_cast<int>(pairs.size()) - 1);
      add_shape(a);
      add_shape(b);
      def_.pairs.push_back(contact_pair(mechanics_, pair));
    }
    return std::make_shared<const ContactElements>(ContactElements{contact::build(def_), std::move(frames_),
                                                                   std::move(pairs), std::move(pair_of_tested),
                                                                   mechanics_.contact_substep});
  }

 private:
  [[nodiscard]] const Body& body_of(const ShapeDef& shape) const {
    return model_.bodies[static_cast<std::size_t>(multibody::find_body(model_, shape.body))];
  }
  [[nodiscard]] int link_of(const ShapeDef& shape) const { return body_of(shape).link; }

  void add_shape(const ShapeDef& shape) {
    if (contact::find_named(def_.shapes, shape.name) != nullptr) return;
    def_.shapes.push_back(contact_shape(shape));
    if (contact::find_named(def_.frames, shape.body) != nullptr) return;
    const Body& body = body_of(shape);
    def_.frames.push_back({shape.body, body.link == 0});
    frames_.push_back({multibody::find_body(model_, shape.body), body.link, body.R_LB, body.p_LB});
  }

  const MechanicsDef& mechanics_;
  const Model& model_;
  contact::ContactDef def_;
  std::vector<ContactFrame> frames_;
};

}  // namespace

std::shared_ptr<const ContactElements> build_contacts(const MechanicsDef& mechanics, const Model& model) {
  if (mechanics.contacts.empty()) return nullptr;
  return ContactBuilder(mechanics, model).run();
}

}  // namespace slew::multibody
