// SPDX-License-Identifier: Apache-2.0
// Variables by the schemas of their channels: /Cyl_Lift with the fields force and stroke gives Cyl_Lift.force, ...

export interface Variable {
  name: string; // Bag.position.x
  element: string; // Bag
  label: string; // position.x
  unit: string; // SI; 1 for a number
}

interface Schema {
  type?: string;
  unit?: string;
  properties?: Record<string, Schema>;
}

export type Values = Map<string, number | null>; // by the variable's name

export function variablesOf(element: string, schemaText: string): Variable[] {
  const found: Variable[] = [];
  const walk = (schema: Schema, label: string) => {
    for (const [key, field] of Object.entries(schema.properties ?? {})) {
      const path = label ? `${label}.${key}` : key;
      if (field.type === "object") walk(field, path);
      else if (field.type === "number")
        found.push({ name: `${element}.${path}`, element, label: path, unit: field.unit ?? "1" });
    }
  };
  walk(JSON.parse(schemaText) as Schema, "");
  return found;
}

// The numbers of a message into the values of its element.
export function readValues(element: string, message: unknown, values: Values): void {
  const walk = (part: Record<string, unknown>, prefix: string) => {
    for (const [key, value] of Object.entries(part)) {
      if (typeof value === "number" || value === null) values.set(`${prefix}.${key}`, value);
      else if (typeof value === "object") walk(value as Record<string, unknown>, `${prefix}.${key}`);
    }
  };
  walk(message as Record<string, unknown>, element);
}

// ---- kinds of elements, by the variables that they have

export const kinds = [
  "Inputs",
  "Actuators",
  "Bodies",
  "Joints",
  "Forces",
  "Contacts",
  "Volumes",
  "Hydraulics",
  "Sensors and others",
  "Scene",
  "Session",
] as const;
export type Kind = (typeof kinds)[number];

const nodes = new Set(["session", "mechanics", "hydraulics", "flex", "sensors", "sensor", "io", "recorder"]);

export function kindOf(element: string, labels: Set<string>): Kind {
  const has = (...names: string[]) => names.some((name) => labels.has(name));
  if (nodes.has(element)) return "Session";
  if (has("raw") && has("control")) return "Inputs";
  if (has("coupling_eta", "stroke")) return "Actuators";
  if (has("position.x") && has("orientation.w")) return "Bodies";
  if (has("contacts")) return "Contacts";
  if (has("reaction_force.x")) return "Joints";
  if (has("pressure") && has("content")) return "Volumes";
  if (has("rate", "tension", "deflection.x") && !has("flow")) return "Forces";
  if (has("flow", "opening", "spool_position", "ls_pressure", "swash", "flow_pa", "pressure", "nominal_flow"))
    return "Hydraulics";
  if ([...labels].some((label) => /damping_constant|spring_constant|free_length/.test(label))) return "Forces";
  if ([...labels].some((label) => /friction|stiffness/.test(label))) return "Contacts";
  if ([...labels].some((label) => /flow|pressure|bulk_modulus|spool|orifice/.test(label))) return "Hydraulics";
  return "Sensors and others";
}

const kindsOfSections: Record<string, Kind> = {
  inputs: "Inputs",
  bodies: "Bodies",
  joints: "Joints",
  forces: "Forces",
  contacts: "Contacts",
  volumes: "Volumes",
  components: "Hydraulics",
  sensors: "Sensors and others",
};

// Of an element that has no variables, by its section in the scene.
export function kindOfSection(section: string): Kind {
  return kindsOfSections[section] ?? "Scene";
}
