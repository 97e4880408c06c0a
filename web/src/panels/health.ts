// SPDX-License-Identifier: Apache-2.0
// Nodes and how they keep time, and the coupling of every actuator as a lamp.
import type { Context } from "../context";
import { atMostEvery, h, setText } from "../dom";
import { panel } from "./panel";

const kShowEveryMs = 250;
// docs/variables.md: coupling_eta, coupling_net
const kGreenEta = 5e-4;
const kAmberEta = 5e-3;
const kCreatesEnergy = -3e-3;
const kMilliseconds = 1e3;

const meanings = {
  good: "The halves of this actuator agree.",
  fair: "The force of this actuator is off by about a percent. Choose a shorter step, or the coupling 'two'.",
  bad: "This actuator's results are not reliable. Choose a shorter step, or the coupling 'two'.",
  off: "No value yet.",
};

export class HealthPanel {
  readonly root: HTMLElement;
  #context: Context;
  #nodes = h("table", { class: "nodes" });
  #lamps = h("div", { class: "lamps" });
  #facts = h("dl", { class: "facts" });
  #watched = new Map<string, () => void>();

  constructor(context: Context) {
    this.#context = context;
    this.root = panel("health", "Health", [], this.#nodes, this.#facts, this.#lamps);
    const show = atMostEvery(kShowEveryMs, () => this.#show());
    context.session.changed.on(() => this.#watch());
    context.session.stateChanged.on(show);
    context.session.valuesChanged.on(show);
  }

  #watch(): void {
    const { session } = this.#context;
    const wanted = new Set<string>();
    for (const [element, variables] of session.elements)
      if (element === "session" || variables.some((variable) => variable.label === "coupling_eta")) wanted.add(element);
    for (const [element, end] of this.#watched) {
      if (wanted.has(element)) continue;
      end();
      this.#watched.delete(element);
    }
    for (const element of wanted) if (!this.#watched.has(element)) this.#watched.set(element, session.watch(element));
    this.#show();
  }

  #show(): void {
    const { session } = this.#context;
    const { values } = session;
    const rows = (session.state?.nodes ?? []).map((node) => {
      const kind = ["fault", "lost"].includes(node.state) ? "bad" : node.state === "holding" ? "fair" : "good";
      const more = [
        node.overruns > 0 ? `${node.overruns} overruns` : "",
        node.refused > 0 ? `${node.refused} messages refused` : "",
      ].filter((text) => text !== "");
      return h(
        "tr",
        {},
        h("td", {}, h("i", { class: `lamp is-${kind}` }), node.role),
        h("td", {}, node.state),
        h("td", { class: "number" }, more.join(", ")),
      );
    });
    this.#nodes.replaceChildren(h("tbody", {}, ...rows));
    this.#nodes.hidden = rows.length === 0;

    const facts: [string, string][] = [];
    const time = (name: string, text: string) => {
      const value = values.get(name);
      if (typeof value === "number") facts.push([text, `${(value * kMilliseconds).toFixed(1)} ms`]);
    };
    time("session.lag", "Lag");
    time("session.release_jitter", "Tick delay");
    time("session.response", "Response");
    const overruns = values.get("session.overruns");
    if (typeof overruns === "number") facts.push(["Overruns", String(overruns)]);
    this.#facts.replaceChildren(...facts.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]));
    this.#facts.hidden = facts.length === 0;
    this.#showLamps();
  }

  #showLamps(): void {
    const { session } = this.#context;
    const elements = [...this.#watched.keys()].filter((element) => element !== "session");
    if (this.#lamps.childElementCount !== elements.length) {
      this.#lamps.replaceChildren(
        ...elements.map((element) =>
          h(
            "button",
            { class: "lamp-row", type: "button", onclick: () => this.#context.select(element) },
            h("i", { class: "lamp" }),
            h("span", {}, element),
            h("span", { class: "number" }),
          ),
        ),
      );
    }
    elements.forEach((element, i) => {
      const row = this.#lamps.children[i] as HTMLElement;
      const eta = session.values.get(`${element}.coupling_eta`);
      const net = session.values.get(`${element}.coupling_net`) ?? 0;
      let kind: keyof typeof meanings = "off";
      if (typeof eta === "number") kind = eta < kGreenEta ? "good" : eta < kAmberEta ? "fair" : "bad";
      if (net < kCreatesEnergy) kind = "bad";
      row.children[0]!.className = `lamp is-${kind}`;
      row.title = `Coupling of ${element}: ${meanings[kind]}`;
      setText(row.children[1]!, element);
      setText(row.children[2]!, typeof eta === "number" ? `η ${eta.toExponential(1)}` : "");
    });
  }
}
