// SPDX-License-Identifier: Apache-2.0
// All problems of a scene's mechanics, found before the model is built.
//
// Checked: names, masses, inertia (triangle rule, positive definite), directions, limits, that the joints lead to
// Ground, that the frames of every joint agree at the start within the assembly's tolerance and lie inside its limits,
// that loops close and allow the speeds given, that dummies sit on forces between neighbours. Ranges of single numbers
// (from the field tables) are checked too, so that a Def made in code is safe.
#pragma once

#include "core/problem.h"
#include "multibody/model/defs.h"

namespace slew::multibody {

struct Model;

// Appends to problems; none for a sound Def. Paths are "Element.key".
void validate(const MechanicsDef& mechanics, Problems& problems);

// Appends a warning for every body that the start moves onto its joints, and for every redundant row of a joint.
// Pre-condition: validate() found nothing.
void find_start_changes(const MechanicsDef& mechanics, Problems& warnings);

// Appends a warning for every body with modes that starts undeformed though it has weight, or bent beyond the theory.
// find_start_changes() calls it for mechanisms without loops; with loops the start depends on the actuators
// (MechanicsDef::held_forces), which are read later.
void find_start_deflections(const Model& model, Problems& warnings);

// Appends a warning for every body whose largest radius of gyration about its centre of mass is several times the
// distance of the points that joints and forces have on it: its inertia probably belongs to another body, or has other
// units. Pre-condition: validate() found nothing.
void find_unlikely_inertia(const MechanicsDef& mechanics, Problems& warnings);

// Appends a warning for every rotational force whose axis is not that of the hinge (revolute or cylindrical joint)
// between its two bodies: a turn of the hinge changes its angle in part, or not at all. Pre-condition: validate() found
// nothing.
void find_axes_beside_hinges(const MechanicsDef& mechanics, Problems& warnings);

// Appends a warning for every joint and force that acts on a body with modes between two nodes: it rides on the nearest
// one, and the body bends as if it acted there. Pre-condition: validate() found nothing.
void find_points_between_nodes(const MechanicsDef& mechanics, Problems& warnings);

// Appends an error for every pair whose impact is too fast for the shortest part of a sub-step [s] of the scene's own
// rule, each body taken as free and hit in its centre of mass, where an impact would make energy. An implicit rule
// loses the rebound instead, and the parts of rk4 and `augmented` may be too long for it: the second function appends a
// warning where the restitution is kPlastic or more (contact_rate.h). Pre-condition: validate() found nothing.
void check_contact_rates(const MechanicsDef& mechanics, double substep, Problems& problems);
void find_lost_rebounds(const MechanicsDef& mechanics, double substep, Problems& warnings);
// Appends a warning for every table of a force over time that rises and falls within two sub-steps [s]: an integrator
// sees a table at its stages alone, and the impulse of a shorter pulse depends on where in a sub-step it falls.
void find_short_pulses(const MechanicsDef& mechanics, double substep, Problems& warnings);
// Appends a warning for every motion that the parts of a sub-step [s] do not resolve (motions/motion_pieces.h), and for
// every table of which the spline leaves the range of four points in a row by more than that range.
void find_fast_motions(const MechanicsDef& mechanics, double substep, Problems& warnings);
void find_overshoots(const MechanicsDef& mechanics, Problems& warnings);
// Appends a warning for every pair whose shapes start deep in each other. Pre-condition: validate() found nothing.
void find_unlikely_contacts(const MechanicsDef& mechanics, Problems& warnings);

}  // namespace slew::multibody
