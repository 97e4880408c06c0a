// SPDX-License-Identifier: Apache-2.0
// The question for a name, and for the kind of a new element.
import { h } from "../dom";
import type { KindInfo } from "./scene_file";

export interface NameRequest {
  title: string;
  name: string;
  action: string; // of the button
  kinds?: KindInfo[]; // to choose from
  // Result: the reason of a refusal; empty: the dialog closes.
  submit: (name: string, kind: KindInfo | undefined) => Promise<string>;
}

const titleOf = (kind: KindInfo) => (kind.type === "" ? kind.section : kind.type);

export function showNameDialog(request: NameRequest): void {
  const name = h("input", {
    type: "text",
    value: request.name,
    required: true,
    spellcheck: false,
    autocomplete: "off",
    "aria-label": "Name",
  });
  const problem = h("p", { class: "note is-bad", role: "alert" });
  const doc = h("p", { class: "help" });
  const sections = [...new Set((request.kinds ?? []).map((kind) => kind.section))];
  const kind = h(
    "select",
    { "aria-label": "Kind" },
    ...sections.map((section) =>
      h(
        "optgroup",
        { label: section },
        ...request.kinds!.flatMap((one, i) =>
          one.section === section ? [h("option", { value: String(i) }, titleOf(one))] : [],
        ),
      ),
    ),
  );
  const chosen = () => request.kinds?.[Number(kind.value)];
  const showDoc = () => (doc.textContent = chosen()?.doc ?? "");
  kind.onchange = showDoc;
  showDoc();
  const submit = h("button", { class: "primary", type: "submit" }, request.action);
  const dialog = h(
    "dialog",
    { class: "dialog", "aria-label": request.title, onclose: () => dialog.remove() },
    h(
      "form",
      {
        onsubmit: async (event: Event) => {
          event.preventDefault();
          submit.disabled = true;
          const refusal = await request.submit(name.value.trim(), chosen());
          submit.disabled = false;
          problem.textContent = refusal;
          if (refusal === "") dialog.close();
        },
      },
      h("h2", {}, request.title),
      request.kinds && h("label", {}, "Kind", kind),
      request.kinds && doc,
      h("label", {}, "Name", name),
      problem,
      h(
        "div",
        { class: "buttons" },
        h("button", { type: "button", onclick: () => dialog.close() }, "Cancel"),
        submit,
      ),
    ),
  );
  document.body.append(dialog);
  dialog.showModal();
  name.select();
}
