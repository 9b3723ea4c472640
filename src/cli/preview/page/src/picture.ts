// The picture: what of the scene it shows, how large, and how it gets there.

import { get, type Query, Refused, type SceneState } from "./api.ts";
import { element, Latest, showImage } from "./page.ts";
import { Sharp } from "./sharp.ts";

/** The time in milliseconds above which a coarse picture comes first. */
const SLOW = 80;
/** The time in milliseconds after the last change of a broken text that makes the picture a stale one. */
const PAUSE = 500;
/** The factors of the zoom; 0 fits the picture into its frame. */
export const ZOOMS = [0, 1, 2, 4, 8, 16, 32];

/** Degrees to the right and up, then heights of the picture to the right and up, then dolly. */
export type Motion = [number, number, number, number, number];
export const STILL: Motion = [0, 0, 0, 0, 0];

/** What of the scene is shown. */
export interface View {
  camera: string | undefined;
  frame: number;
  layer: string;
  exposure: number | undefined;
  /** The number of samples; undefined for the scene's. */
  samples: number | undefined;
}

/** Returns the samples after each round of a picture: 1, 2, 4 and so on. */
function rounds(samples: number): number[] {
  const all = [];
  for (let round = 1; round < samples; round *= 2) all.push(round);
  return [...all, samples];
}

export class Picture {
  readonly view: View = { camera: undefined, frame: 0, layer: "color", exposure: undefined, samples: undefined };
  readonly image = element<HTMLImageElement>("picture");
  scene: SceneState | null = null;
  file = "";
  zoom = 0;
  private motion: Motion = STILL;
  private isBroken = false;
  private revision = 0;
  private abort = new AbortController();
  private isDrawing = false;
  private staleTimer: ReturnType<typeof setTimeout> | undefined;
  private duration = Infinity;
  private readonly moving = new Latest<Motion>((motion) => this.drawMoving(motion));
  private readonly frame = element("frame");
  private readonly canvas = element("canvas");
  private readonly sharp = new Sharp();

  constructor(
    private readonly onDrawn: () => void,
    private readonly onFailure: (message: string) => void,
  ) {
    new ResizeObserver(() => this.layOut()).observe(this.frame);
  }

  /** Takes over the scene of a state; draws if there is something new, and returns true then. */
  update(revision: number, isBroken: boolean, scene: SceneState | null): boolean {
    const isNew = scene?.revision !== this.scene?.revision;
    const wasBroken = this.isBroken;
    this.scene = scene;
    this.isBroken = isBroken;
    const hasGrown = revision !== this.revision;
    this.revision = revision;
    element("placeholder").hidden = scene !== null;
    this.canvas.hidden = scene === null;
    if (isNew && scene) void this.draw();
    else if (hasGrown || wasBroken !== isBroken) this.setState();
    return isNew;
  }

  /** The query of the view. */
  query(motion: Motion = this.motion): Query {
    return {
      revision: this.scene?.revision ?? 0,
      camera: this.view.camera,
      frame: this.view.frame,
      layer: this.view.layer,
      exposure: this.view.exposure,
      samples: this.view.samples,
      motion: motion.some((part) => part !== 0) ? motion.join() : undefined,
    };
  }

  /**
   * Draws the view: with one sample at first if it may take long, then whole. The last picture stays until
   * then; only where there is none, a coarse one comes first. Where light follows paths, rounds of one sample, two,
   * four and so on are shown.
   */
  async draw(): Promise<void> {
    const { scene } = this;
    if (!scene) return;
    this.abort.abort();
    this.abort = new AbortController();
    const { signal } = this.abort;
    this.isDrawing = true;
    this.sharp.stop();
    this.setState();
    const samples = this.view.samples ?? scene.samples;
    const steps: Query[] = scene.follows_paths
      ? rounds(samples).map((round) => ({ round }))
      : [
          ...(this.image.hasAttribute("src") ? [] : ["coarse"]),
          ...(samples > 1 && this.duration > SLOW ? ["single"] : []),
          "full",
        ].map((quality) => ({ quality }));
    const start = performance.now();
    try {
      for (const [index, step] of steps.entries()) {
        const blob = await (await get("/picture", { ...this.query(), ...step }, signal)).blob();
        if (signal.aborted) return;
        await showImage(this.image, blob);
        if (index === steps.length - 1) this.finish(blob, performance.now() - start);
        this.layOut();
      }
    } catch (error) {
      // A scene that has changed meanwhile is drawn again.
      if (signal.aborted || (error instanceof Refused && error.status === 410)) return;
      this.isDrawing = false;
      this.onFailure(error instanceof Error ? error.message : String(error));
    }
  }

  private finish(blob: Blob, duration: number): void {
    this.duration = duration;
    const { scene } = this;
    const name = this.file.replace(/\.[^.]*$/, "");
    const link = element<HTMLAnchorElement>("download");
    if (link.href.startsWith("blob:")) URL.revokeObjectURL(link.href);
    link.href = URL.createObjectURL(blob);
    const { camera: shown, layer, samples } = this.view;
    const parts = [name, shown, layer === "color" ? undefined : layer, samples && `${samples}-samples`];
    link.download = `${parts.filter(Boolean).join("-")}.png`;
    link.removeAttribute("aria-disabled");
    const camera = this.view.camera ? `, camera ${this.view.camera}` : "";
    this.image.alt = `${this.file}, ${scene?.width} by ${scene?.height} pixels${camera}`;
    this.isDrawing = false;
    this.setState();
    this.onDrawn();
  }

  /** Shows the view after a movement of the camera, which is not in the text yet. */
  move(motion: Motion): void {
    this.motion = motion;
    element("outline").hidden = true;
    this.isDrawing = true;
    this.sharp.stop();
    this.setState();
    this.moving.push(motion);
  }

  private async drawMoving(motion: Motion): Promise<void> {
    // The movement is in the text by now, and drawn from there.
    if (this.motion === STILL) return;
    this.abort.abort();
    const quality = this.duration > 4 * SLOW ? "coarse" : "single";
    const blob = await (await get("/picture", { ...this.query(motion), quality })).blob();
    if (this.motion === STILL) return;
    await showImage(this.image, blob);
    this.layOut();
  }

  /** Forgets the movement, which is in the text now. */
  settle(): void {
    this.motion = STILL;
  }

  private setState(): void {
    const { dataset } = document.body;
    dataset["revision"] = String(this.revision);
    dataset["state"] = this.isBroken ? "broken" : this.isDrawing ? "drawing" : "drawn";
    // Each key of a word makes the text broken or whole; that the picture is an old one matters after it.
    clearTimeout(this.staleTimer);
    if (!this.isBroken) delete dataset["stale"];
    else this.staleTimer = setTimeout(() => (dataset["stale"] = ""), PAUSE);
  }

  /** Sizes the picture: whole factors of pixels, or as large as fits. */
  layOut(): void {
    const { scene } = this;
    if (!scene) return;
    const isBeside = this.canvas.dataset["mode"] === "side";
    const room = { width: this.frame.clientWidth / (isBeside ? 2 : 1), height: this.frame.clientHeight };
    const fit = Math.min(room.width / scene.width, room.height / scene.height);
    // A pixel of the picture has a whole number of pixels of the screen, unless it has to fit.
    const scale = this.zoom === 0 ? fit : this.zoom / devicePixelRatio;
    const length = (side: number): string =>
      `${this.zoom === 0 ? Math.max(1, Math.floor(side * scale)) : side * scale}px`;
    const { style, dataset } = this.canvas;
    style.setProperty("--width", length(scene.width));
    style.setProperty("--height", length(scene.height));
    dataset["scale"] = this.zoom === 0 ? "smooth" : "exact";
    const factor = Math.ceil(fit * devicePixelRatio);
    const isCompared = (dataset["mode"] ?? "off") !== "off";
    const isLarger = this.zoom === 0 && factor > 1 && !isCompared && !this.isDrawing;
    this.sharp.want(isLarger ? { ...this.query(), factor } : null);
  }

  /** Zooms, and keeps a point of the window where it is. */
  zoomTo(zoom: number, at?: { x: number; y: number }): void {
    const before = this.image.getBoundingClientRect();
    const middle = this.frame.getBoundingClientRect();
    const x = at?.x ?? middle.left + middle.width / 2;
    const y = at?.y ?? middle.top + middle.height / 2;
    const [right, down] = [(x - before.left) / before.width, (y - before.top) / before.height];
    this.zoom = zoom;
    element<HTMLSelectElement>("zoom").value = String(zoom);
    this.layOut();
    const after = this.image.getBoundingClientRect();
    this.frame.scrollLeft += after.left + right * after.width - x;
    this.frame.scrollTop += after.top + down * after.height - y;
  }

  /** Zooms by some steps. */
  zoomBy(steps: number, at?: { x: number; y: number }): void {
    const index = ZOOMS.indexOf(this.zoom) + steps;
    this.zoomTo(ZOOMS[Math.min(Math.max(index, 0), ZOOMS.length - 1)] ?? 0, at);
  }

  /** The pixel under a point of the window: column and row from the top left. */
  pixelAt(x: number, y: number): { x: number; y: number } | null {
    const { scene } = this;
    const box = this.image.getBoundingClientRect();
    if (!scene || box.width === 0) return null;
    const isBeside = this.canvas.dataset["mode"] === "side" && x >= box.right;
    const left = isBeside ? box.right : box.left;
    const column = Math.floor(((x - left) / box.width) * scene.width);
    const row = Math.floor(((y - box.top) / box.height) * scene.height);
    const isInside = column >= 0 && row >= 0 && column < scene.width && row < scene.height;
    return isInside ? { x: column, y: row } : null;
  }
}
