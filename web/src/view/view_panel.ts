// SPDX-License-Identifier: Apache-2.0
// The panel with the machine in space.
import * as THREE from "three";
import type { Context } from "../context";
import { atMostEvery, download, h, setText } from "../dom";
import { panel, toolButton } from "../panels/panel";
import { Camera, type CameraState, type Preset, presets } from "./camera";
import { Machine } from "./machine";
import { type Graphics, Stage } from "./stage";

const kClickPixels = 5; // a longer way of the pointer turns the view
const kHoverEveryMs = 60;
const presetNames: Record<Preset, string> = { iso: "Iso", front: "Front", side: "Side", top: "Top" };

export interface ViewState {
  camera?: CameraState;
  follow: string; // body; empty: none
  graphics: Graphics;
}

export class ViewPanel {
  readonly root: HTMLElement;
  #context: Context;
  #stage: Stage;
  #camera: Camera;
  #machine: Machine;
  #follow = h("select", { title: "Body that the camera follows", "aria-label": "Follow a body" });
  #followed = "";
  #quality = h("select", { title: "Quality of the picture", "aria-label": "Graphics" });
  #hover = h("div", { class: "hover" });
  #empty = h("p", { class: "empty" }, "Waiting for the machine.");
  #isFramed = false; // the camera has seen the machine
  #kept?: CameraState; // of a workspace

  constructor(context: Context) {
    this.#context = context;
    const canvas = h("canvas", { "aria-label": "Machine", tabIndex: 0 });
    const frame = h("div", { class: "view" }, canvas, this.#hover, this.#empty);
    this.root = panel(
      "view",
      "View",
      [
        h(
          "div",
          { class: "segments", role: "group", "aria-label": "Direction of view" },
          ...(Object.keys(presets) as Preset[]).map((preset) =>
            h(
              "button",
              { type: "button", title: `Look from: ${presetNames[preset]}`, onclick: () => this.#look(preset) },
              presetNames[preset],
            ),
          ),
        ),
        this.#follow,
        this.#quality,
        toolButton("image", "Save the picture as PNG", () => void this.#save()),
      ],
      frame,
    );
    this.#stage = new Stage(canvas);
    this.#camera = new Camera(this.#stage);
    this.#machine = new Machine(
      context.session,
      () => {
        this.#camera.keepUp();
        if (!this.#isFramed) this.#frame();
        this.#stage.draw();
      },
      () => this.#takeScene(),
    );
    this.#stage.scene.add(this.#machine.root);
    for (const [value, text] of [
      ["auto", "Graphics: auto"],
      ["high", "Graphics: high"],
      ["low", "Graphics: low"],
    ] as const)
      this.#quality.append(h("option", { value }, text));
    this.#quality.onchange = () => {
      this.#stage.setGraphics(this.#quality.value as Graphics);
      context.workspaceChanged.emit();
    };
    this.#follow.onchange = () => {
      this.#setFollowed(this.#follow.value);
      context.workspaceChanged.emit();
    };
    this.#offerBodies();
    this.#takeClicks(canvas);
    this.#camera.controls.addEventListener("end", () => context.workspaceChanged.emit());
    context.themeChanged.on(() => this.#stage.setTheme(context.isDark));
    context.selectionChanged.on(() => this.#highlight());
    this.#stage.setTheme(context.isDark);
  }

  get state(): ViewState {
    return {
      camera: this.#isFramed ? this.#camera.state : this.#kept,
      follow: this.#followed,
      graphics: this.#quality.value as Graphics,
    };
  }
  set state(state: ViewState) {
    this.#kept = state.camera;
    this.#isFramed = false;
    this.#quality.value = state.graphics;
    this.#stage.setGraphics(state.graphics);
    this.#setFollowed(state.follow);
    if (this.#machine.bodies.length > 0) this.#frame();
  }

  #takeScene(): void {
    this.#offerBodies();
    this.#highlight();
    if (this.#isFramed) this.#setExtent();
    else this.#frame();
    this.#stage.draw();
  }

  // When shapes, models and poses are there: light and camera for the size of the machine.
  #frame(): void {
    if (!this.#machine.isComplete) return;
    this.#isFramed = true;
    this.#empty.hidden = true;
    this.#setExtent();
    if (this.#kept) this.#camera.state = this.#kept;
    else this.#look("iso");
    this.#setFollowed(this.#followed);
  }

  #setExtent(): void {
    const { center, radius, ground } = this.#machine.extent();
    this.#stage.setExtent(center, radius, ground);
  }

  #look(preset: Preset): void {
    const { center, radius } = this.#machine.extent();
    this.#camera.look(preset, center, radius);
    this.#stage.draw();
    this.#context.workspaceChanged.emit();
  }

  #offerBodies(): void {
    const option = (value: string, text: string) => h("option", { value }, text);
    this.#follow.replaceChildren(
      option("", "Follow: none"),
      ...(this.#machine?.bodies.map((name) => option(name, `Follow: ${name}`)) ?? []),
    );
    this.#follow.value = this.#followed;
  }

  #setFollowed(body: string): void {
    this.#followed = body;
    this.#follow.value = body;
    this.#camera.follow(body === "" ? undefined : this.#machine.frame(body));
  }

  #highlight(): void {
    this.#machine.highlight(this.#context.selected, new THREE.Color(this.#context.color("--accent")));
    this.#stage.draw();
  }

  #pick(event: PointerEvent): string | undefined {
    const box = this.#stage.canvas.getBoundingClientRect();
    const point = new THREE.Vector2(
      ((event.clientX - box.left) / box.width) * 2 - 1,
      1 - ((event.clientY - box.top) / box.height) * 2,
    );
    const ray = new THREE.Raycaster();
    ray.setFromCamera(point, this.#stage.camera);
    return Machine.elementOf(ray.intersectObject(this.#machine.root, true)[0]?.object ?? null);
  }

  #takeClicks(canvas: HTMLCanvasElement): void {
    let start: PointerEvent | undefined;
    let last: PointerEvent | undefined;
    const hover = atMostEvery(kHoverEveryMs, () => {
      const element = last && this.#pick(last);
      setText(this.#hover, element ?? "");
      canvas.style.cursor = element === undefined ? "" : "pointer";
    });
    canvas.addEventListener("pointerdown", (event) => (start = event));
    canvas.addEventListener("pointermove", (event) => {
      last = event.buttons === 0 && event.pointerType === "mouse" ? event : undefined;
      if (last) hover();
    });
    canvas.addEventListener("pointerleave", () => {
      last = undefined;
      setText(this.#hover, "");
    });
    canvas.addEventListener("pointerup", (event) => {
      if (!start || event.button !== 0) return;
      const way = Math.hypot(event.clientX - start.clientX, event.clientY - start.clientY);
      start = undefined;
      if (way > kClickPixels) return;
      const element = this.#pick(event);
      this.#context.select(element === "Ground" ? undefined : element);
    });
  }

  async #save(): Promise<void> {
    const picture = await this.#stage.picture();
    if (picture) download(`${this.#context.session.description?.scene ?? "machine"}.png`, picture);
  }
}
