// SPDX-License-Identifier: Apache-2.0
// Renderer, light, ground and the loop that draws: only when something has changed. World has z up, in metres.
import * as THREE from "three";

export type Graphics = "auto" | "high" | "low";

const kSlowFrameMs = 35; // mean of a few frames; above it the quality is lowered
const kMeasuredFrames = 6;
const kPartOfTime = 0.5; // of the browser's main thread for drawing: the rest is for inputs and values
const kCoarsePixels = 0.6; // pixels of the picture over those of the screen, when low graphics are still slow
const themes = {
  light: { back: 0xe8ebee, shadow: 0.26, minor: 0xd5dade, major: 0xbcc3c9, hemisphere: 2.6, sun: 2.6, below: 0x9aa0a4 },
  dark: { back: 0x1a1f24, shadow: 0.5, minor: 0x262d34, major: 0x36404a, hemisphere: 1.9, sun: 2.3, below: 0x3a3f44 },
};

export class Stage {
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(38, 1, 0.05, 2000);
  readonly canvas: HTMLCanvasElement;

  #renderer: THREE.WebGLRenderer;
  #sun = new THREE.DirectionalLight(0xffffff, 2);
  #hemisphere = new THREE.HemisphereLight(0xffffff, 0x808080, 1);
  // the ground has the colour of the background: only its grid and the shadows on it are seen
  #ground = new THREE.Mesh(new THREE.CircleGeometry(1, 96), new THREE.ShadowMaterial());
  #grid = new THREE.Group();
  #size = 0; // of the machine, for which the ground was made
  #isDark = false;
  #isWaiting = false;
  #isStale = false; // something changed since the last frame
  #graphics: Graphics = "auto";
  #level = 0; // 0 high, 1 low, 2 low with coarse pixels
  #durations: number[] = [];

  constructor(canvas: HTMLCanvasElement) {
    this.canvas = canvas;
    this.#renderer = new THREE.WebGLRenderer({ canvas, antialias: true, powerPreference: "high-performance" });
    this.#renderer.shadowMap.type = THREE.PCFShadowMap;
    this.camera.up.set(0, 0, 1);
    this.#sun.castShadow = true;
    this.#sun.shadow.bias = -0.0004;
    this.#sun.shadow.normalBias = 0.03;
    this.#ground.receiveShadow = true;
    this.scene.add(this.#hemisphere, this.#sun, this.#sun.target, this.#ground, this.#grid);
    new ResizeObserver(() => this.#resize()).observe(canvas.parentElement!);
    this.setGraphics("auto");
    this.setTheme(false);
    this.setExtent(new THREE.Vector3(), 5, 0);
  }

  setTheme(isDark: boolean): void {
    this.#isDark = isDark;
    const theme = themes[isDark ? "dark" : "light"];
    this.scene.background = new THREE.Color(theme.back);
    this.scene.fog = new THREE.Fog(theme.back, 4 * this.#size, 11 * this.#size); // the grid has no end
    this.#ground.material.opacity = theme.shadow;
    this.#hemisphere.intensity = theme.hemisphere;
    this.#hemisphere.groundColor.set(theme.below);
    this.#sun.intensity = theme.sun;
    this.#makeGrid();
    this.draw();
  }

  // auto: high until the frames are slow.
  setGraphics(graphics: Graphics): void {
    this.#graphics = graphics;
    this.#setLevel(graphics === "low" ? 1 : 0);
  }

  // Light, ground and fog for a machine of this middle and radius [m] on a ground at this height.
  setExtent(middle: THREE.Vector3, radius: number, height: number): void {
    this.#size = radius;
    this.#sun.position.copy(middle).add(new THREE.Vector3(-0.55, -0.75, 1.5).multiplyScalar(2 * radius));
    this.#sun.target.position.copy(middle);
    const shadow = this.#sun.shadow.camera;
    shadow.left = shadow.bottom = -1.35 * radius;
    shadow.right = shadow.top = 1.35 * radius;
    shadow.near = 0.1 * radius;
    shadow.far = 8 * radius;
    shadow.updateProjectionMatrix();
    this.#ground.scale.setScalar(12 * radius);
    this.#ground.position.set(middle.x, middle.y, height - 0.002 * radius);
    this.#grid.position.set(Math.round(middle.x), Math.round(middle.y), height);
    this.camera.near = radius / 100;
    this.camera.far = radius * 100;
    this.camera.updateProjectionMatrix();
    this.setTheme(this.#isDark);
  }

  draw(): void {
    this.#isStale = true;
    if (this.#isWaiting) return;
    this.#isWaiting = true;
    requestAnimationFrame(() => {
      const start = performance.now();
      this.#renderer.render(this.scene, this.camera);
      this.#renderer.getContext().finish(); // a renderer in software returns before it has drawn
      const duration = performance.now() - start;
      this.#isStale = false;
      setTimeout(
        () => {
          this.#isWaiting = false;
          if (this.#isStale) this.draw();
        },
        (duration * (1 - kPartOfTime)) / kPartOfTime,
      );
      if (this.#graphics === "auto") this.#measure(duration);
    });
  }

  // The view as it is now; drawn again, since a browser may have discarded the last picture.
  async picture(): Promise<Blob | null> {
    this.#renderer.render(this.scene, this.camera);
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }

  #measure(duration: number): void {
    this.#durations.push(duration);
    if (this.#durations.length < kMeasuredFrames) return;
    // without the first, in which programs are compiled
    const mean = this.#durations.slice(1).reduce((sum, one) => sum + one, 0) / (kMeasuredFrames - 1);
    this.#durations = [];
    if (mean > kSlowFrameMs && this.#level < 2) this.#setLevel(this.#level + 1);
  }

  #setLevel(level: number): void {
    this.#level = level;
    this.#durations = [];
    const pixels = Math.min(2, window.devicePixelRatio);
    this.#renderer.setPixelRatio(level === 0 ? pixels : level === 1 ? 1 : kCoarsePixels);
    this.#renderer.shadowMap.enabled = level === 0;
    this.#sun.shadow.mapSize.setScalar(2048);
    this.scene.traverse((object) => {
      if (object instanceof THREE.Mesh) for (const one of [object.material].flat()) one.needsUpdate = true;
    });
    this.#resize();
  }

  #makeGrid(): void {
    const theme = themes[this.#isDark ? "dark" : "light"];
    for (const child of this.#grid.children) (child as THREE.GridHelper).dispose();
    this.#grid.clear();
    const unit = 10 ** Math.floor(Math.log10(Math.max(this.#size, 1e-3) * 0.6)); // of the small squares
    for (const [step, color] of [
      [unit, theme.minor],
      [5 * unit, theme.major],
    ] as const) {
      const grid = new THREE.GridHelper(60 * unit, Math.round((60 * unit) / step), color, color);
      grid.rotation.x = Math.PI / 2;
      this.#grid.add(grid);
    }
  }

  #resize(): void {
    const { clientWidth: width, clientHeight: height } = this.canvas.parentElement!;
    if (width === 0 || height === 0) return;
    this.#renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.draw();
  }
}
