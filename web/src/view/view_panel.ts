// SPDX-License-Identifier: Apache-2.0
// The panel with the machine in space.
import * as THREE from "three";
import type { Context } from "../context";
import { atMostEvery, download, h, setText } from "../dom";
import type { NamedPoint } from "../edit/scene_file";
import { panel, toolButton } from "../panels/panel";
import { Bending } from "./bending";
import { Camera, type CameraState, type Preset, presets } from "./camera";
import { Machine } from "./machine";
import { PointMarks, textOf } from "./points";
import { type Graphics, Stage } from "./stage";

const kClickPixels = 5; // a longer way of the pointer turns the view
const kHoverEveryMs = 60;
const none: NamedPoint[] = [];
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
  #bending: Bending;
  #points: PointMarks;
  #showsPoints = true;
  #pointsTool = toolButton("target", "Named points of bodies: a click puts one into the field that was used last", () => this.#togglePoints());
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
        this.#pointsTool,
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
        this.#bending.update();
        this.#camera.keepUp();
        if (!this.#isFramed) this.#frame();
        this.#stage.draw();
      },
      () => this.#takeScene(),
    );
    this.#stage.scene.add(this.#machine.root);
    this.#bending = new Bending(context.session, this.#machine);
    this.#points = new PointMarks(this.#machine);
    context.scene.changed.on(() => this.#showPoints());
    this.#showPoints();
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
    context.themeChanged.on(() => {
      this.#stage.setTheme(context.isDark);
      this.#points.color = new THREE.Color(context.color("--accent"));
    });
    this.#points.color = new THREE.Color(context.color("--accent"));
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
    this.#bending.rebuild();
    this.#points.showAgain();
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

  // Those of the scene's text while it is edited.
  #showPoints(): void {
    const { points } = this.#context.scene;
    this.#pointsTool.hidden = points.length === 0;
    this.#pointsTool.setAttribute("aria-pressed", String(this.#showsPoints));
    if (this.#points.show(this.#showsPoints ? points : none)) this.#stage.draw();
  }

  #togglePoints(): void {
    this.#showsPoints = !this.#showsPoints;
    this.#showPoints();
  }

  #rayAt(event: PointerEvent): THREE.Raycaster {
    const box = this.#stage.canvas.getBoundingClientRect();
    const point = new THREE.Vector2(
      ((event.clientX - box.left) / box.width) * 2 - 1,
      1 - ((event.clientY - box.top) / box.height) * 2,
    );
    const ray = new THREE.Raycaster();
    ray.setFromCamera(point, this.#stage.camera);
    return ray;
  }

  #elementAt(ray: THREE.Raycaster): string | undefined {
    return Machine.elementOf(ray.intersectObject(this.#machine.root, true).find((hit) => !(hit.object instanceof THREE.Sprite))?.object ?? null);
  }

  #takeClicks(canvas: HTMLCanvasElement): void {
    let start: PointerEvent | undefined; // of a click, with one finger
    let last: PointerEvent | undefined;
    const down = new Set<number>(); // pointers
    const hover = atMostEvery(kHoverEveryMs, () => {
      const ray = last && this.#rayAt(last);
      const point = ray && this.#points.pick(ray);
      const text = point ? textOf(point) : ray && this.#elementAt(ray);
      setText(this.#hover, text ?? "");
      canvas.style.cursor = text === undefined ? "" : "pointer";
    });
    canvas.addEventListener("pointerdown", (event) => {
      down.add(event.pointerId);
      start = down.size === 1 ? event : undefined;
    });
    for (const name of ["pointerup", "pointercancel"] as const)
      canvas.addEventListener(name, (event) => down.delete(event.pointerId));
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
      if (way <= kClickPixels) this.#click(event);
    });
  }

  #click(event: PointerEvent): void {
    const ray = this.#rayAt(event);
    const point = this.#points.pick(ray);
    if (point) return this.#context.pointPicked.emit(point);
    const element = this.#elementAt(ray);
    this.#context.select(element === "Ground" ? undefined : element);
  }

  async #save(): Promise<void> {
    const picture = await this.#stage.picture();
    if (picture) download(`${this.#context.session.description?.scene ?? "machine"}.png`, picture);
  }
}
