// SPDX-License-Identifier: Apache-2.0
// The page of `slewring window`: puts its parts together and keeps the workspace.
import "uplot/dist/uPlot.min.css";
import "./style/base.css";
import "./style/frame.css";
import "./style/machine.css";
import "./style/view.css";
import "./style/circuit.css";
import "./style/plots.css";
import "./style/operate.css";
import "./style/health.css";
import "./style/edit.css";
import "./style/narrow.css";
import { Context } from "./context";
import { download } from "./dom";
import { EditBar } from "./edit/edit_bar";
import { Layout } from "./layout";
import { OperatePanel } from "./operate/operate_panel";
import { CircuitPanel } from "./panels/circuit";
import { HealthPanel } from "./panels/health";
import { LogPanel, noticesOf } from "./panels/log";
import { menuOf } from "./panels/menu";
import { ObjectPanel } from "./panels/object";
import { PlaybackBar } from "./panels/playback_bar";
import { TopBar } from "./panels/top_bar";
import { TreePanel, usualClosed } from "./panels/tree";
import { PlotsPanel, type PlotsState } from "./plots/plots_panel";
import { Session } from "./session";
import { ViewPanel } from "./view/view_panel";
import { kVersion, parseWorkspace, type Workspace } from "./workspace";
import { WorkspaceStore } from "./workspace_store";

const kKeepAfterMs = 500;

const session = new Session();
const context = new Context(session);
const tree = new TreePanel(context);
const view = new ViewPanel(context);
const circuit = new CircuitPanel(context);
const plots = new PlotsPanel(context);
const operate = new OperatePanel(context);
const layout = new Layout(
  {
    tree: tree.root,
    object: new ObjectPanel(context).root,
    view: view.root,
    circuit: circuit.root,
    plots: plots.root,
    operate: operate.root,
    health: new HealthPanel(context).root,
    log: new LogPanel(context).root,
  },
  () => context.workspaceChanged.emit(),
);

layout.centerChanged.on((center) => circuit.setShown(center === "circuit"));

// ---- workspace

const store = new WorkspaceStore(session);
let scene: string | undefined; // whose workspace is shown
let isLoaded = false;
let timer: ReturnType<typeof setTimeout> | undefined;

function workspace(): Workspace {
  return {
    version: kVersion,
    theme: context.theme,
    units: context.units,
    layout: layout.sizes,
    closedGroups: tree.closed,
    center: layout.center,
    view: view.state,
    plots: plots.state,
    gamepad: operate.map,
  };
}

function show(wanted: Workspace): void {
  context.theme = wanted.theme;
  context.units = wanted.units;
  layout.sizes = wanted.layout;
  tree.closed = wanted.closedGroups;
  layout.showCenter(wanted.center ?? "view");
  view.state = wanted.view;
  plots.state = wanted.plots;
  operate.map = wanted.gamepad;
}

function keepSoon(): void {
  if (!isLoaded) return;
  clearTimeout(timer);
  timer = setTimeout(() => void store.save(scene!, workspace()), kKeepAfterMs);
}

// Some plots to begin with: what an operator watches first.
function usualPlots(): PlotsState {
  const named = (label: string) =>
    [...session.elements.values()].flat().filter((one) => one.label === label && one.element !== "session");
  const strokes = named("stroke").slice(0, 4);
  const forces = named("force").filter((one) => strokes.some((stroke) => stroke.element === one.element));
  const bodies = named("position.y").slice(-1);
  const first = strokes.length > 0 ? strokes : bodies;
  const lists = [first, forces].filter((list) => list.length > 0);
  return { length: session.isRecording ? null : 10, plots: lists.map((list) => list.map((one) => one.name)) };
}

session.changed.on(() => {
  const known = session.description?.scene;
  if (known === undefined || session.elements.size === 0 || known === scene) return;
  scene = known;
  isLoaded = false;
  clearTimeout(timer); // what the page shows is not yet of this scene
  void store.load(known).then((kept) => {
    if (known !== scene) return;
    if (kept) show(kept);
    else plots.state = usualPlots();
    isLoaded = true;
  });
});
context.workspaceChanged.on(keepSoon);

const menu = menuOf(context, {
  save: () => {
    const text = JSON.stringify(workspace(), undefined, 2);
    download(`${scene ?? "slewring"}.workspace.json`, new Blob([text], { type: "application/json" }));
  },
  open: (text) => {
    try {
      show(parseWorkspace(text));
    } catch (error) {
      const reason = (error as Error).message;
      session.noticed.emit({ level: 2, message: `the workspace was not opened: ${reason}; nothing was changed` });
    }
  },
  reset: () => {
    if (scene === undefined) return;
    store.forget(scene);
    context.theme = "auto";
    context.units = "engineering";
    layout.sizes = {};
    tree.closed = usualClosed;
    layout.showCenter("view");
    view.state = { follow: "", graphics: "auto" };
    plots.state = usualPlots();
    operate.map = {};
  },
});

// ---- the page

document
  .getElementById("page")!
  .append(
    new TopBar(context, menu).root,
    new EditBar(context).root,
    layout.root,
    new PlaybackBar(context).root,
    layout.tabBar,
    noticesOf(context),
  );
if (matchMedia("(pointer: coarse)").matches) operate.showSticks();
session.protocol.connect();
