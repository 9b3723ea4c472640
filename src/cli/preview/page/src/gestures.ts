// The hand on the picture: mouse, touch and keys, for each of the three tools.

import { type Edit, type Pixel, Refused, post } from "./api.ts";
import type { Editor } from "./editor.ts";
import { element, Latest } from "./page.ts";
import type { Motion, Picture } from "./picture.ts";
import type { Readout } from "./readout.ts";
import { MOVE } from "./sync.ts";

/** Degrees of a turn over the whole height of the picture. */
const TURN = 180;
/** Degrees of a turn by a key. */
const STEP = 5;
/** Milliseconds after the last key that end a movement. */
const PAUSE = 300;
/** Pixels that a click may move. */
const STEADY = 4;

type Tool = "inspect" | "camera" | "move";
type Point = { x: number; y: number };

export class Gestures {
  private readonly frame = element("frame");
  private readonly pointers = new Map<number, Point>();
  private start: Point | null = null;
  private hasMoved = false;
  private motion: Motion = [0, 0, 0, 0, 0];
  private timer: ReturnType<typeof setTimeout> | undefined;
  private selected: string | null = null;
  /** The shift of the dragged geometry that is not in the text yet, in pixels. */
  private shift: Point = { x: 0, y: 0 };
  private readonly shifting = new Latest<string>((geometry) => this.writeShift(geometry));

  constructor(
    private readonly picture: Picture,
    private readonly readout: Readout,
    private readonly editor: () => Editor | null,
    private readonly onFound: (geometry: string) => void,
    private readonly onFailure: (message: string) => void,
  ) {
    const { frame } = this;
    frame.addEventListener("pointerdown", (event) => this.onDown(event));
    frame.addEventListener("pointermove", (event) => this.onMove(event));
    for (const end of ["pointerup", "pointercancel"] as const) {
      frame.addEventListener(end, (event) => this.onUp(event));
    }
    frame.addEventListener("pointerleave", () => this.readout.point(null));
    frame.addEventListener("wheel", (event) => this.onWheel(event), { passive: false });
    frame.addEventListener("keydown", (event) => this.onKey(event));
    element("frame-all").addEventListener("click", () => void this.frameAll());
    frame.addEventListener("contextmenu", (event) => {
      if (this.tool !== "inspect") event.preventDefault();
    });
  }

  get tool(): Tool {
    return (document.querySelector<HTMLInputElement>("input[name=tool]:checked")?.value ?? "inspect") as Tool;
  }

  private onDown(event: PointerEvent): void {
    if (event.button === 1 || !this.picture.scene) return;
    this.frame.setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, y: event.clientY });
    this.start = { x: event.clientX, y: event.clientY };
    this.hasMoved = false;
    if (this.tool === "move") {
      // The geometry is known after a moment; what the hand moves until then counts.
      this.selected = null;
      this.shift = { x: 0, y: 0 };
      const at = this.picture.pixelAt(event.clientX, event.clientY);
      void this.select(at, false).then(() => this.shiftSelected());
    }
  }

  private onMove(event: PointerEvent): void {
    const before = this.pointers.get(event.pointerId);
    if (!before) {
      const at = this.picture.pixelAt(event.clientX, event.clientY);
      this.readout.point(at);
      return;
    }
    const others = [...this.pointers].filter(([id]) => id !== event.pointerId).map(([, point]) => point);
    const now = { x: event.clientX, y: event.clientY };
    this.pointers.set(event.pointerId, now);
    if (this.start && Math.hypot(now.x - this.start.x, now.y - this.start.y) > STEADY) this.hasMoved = true;
    if (!this.hasMoved) return;
    this.readout.follow(this.picture.pixelAt(now.x, now.y));
    const by = { x: now.x - before.x, y: now.y - before.y };
    const other = others[0];
    if (this.tool === "inspect") {
      this.frame.scrollLeft -= by.x;
      this.frame.scrollTop -= by.y;
    } else if (this.tool === "move") {
      this.drag(by);
    } else if (other) {
      const distance = (point: Point): number => Math.max(Math.hypot(point.x - other.x, point.y - other.y), 1);
      this.steer("pan", { x: by.x / 2, y: by.y / 2 });
      this.dolly(Math.log(distance(now) / distance(before)));
    } else {
      const isPan = event.shiftKey || (event.buttons & 2) !== 0;
      this.steer(isPan ? "pan" : "orbit", by);
    }
  }

  private onUp(event: PointerEvent): void {
    if (!this.pointers.delete(event.pointerId) || this.pointers.size > 0) return;
    const at = this.picture.pixelAt(event.clientX, event.clientY);
    if (!this.hasMoved && this.tool !== "camera" && event.type === "pointerup") void this.select(at, true);
    else if (this.tool === "camera") this.write();
    this.start = null;
  }

  private onWheel(event: WheelEvent): void {
    if (this.tool === "move" || !this.picture.scene) return;
    event.preventDefault();
    if (this.tool === "inspect") {
      this.picture.zoomBy(event.deltaY < 0 ? 1 : -1, { x: event.clientX, y: event.clientY });
      return;
    }
    this.dolly(-Math.sign(event.deltaY) * Math.min(Math.abs(event.deltaY), 100) * 0.002);
    this.writeSoon();
  }

  private onKey(event: KeyboardEvent): void {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const arrows: Record<string, Point> = {
      ArrowLeft: { x: -1, y: 0 },
      ArrowRight: { x: 1, y: 0 },
      ArrowUp: { x: 0, y: -1 },
      ArrowDown: { x: 0, y: 1 },
    };
    const arrow = arrows[event.key];
    const zoom = { "+": 1, "=": 1, "-": -1 }[event.key];
    const tool = { i: "inspect", c: "camera", m: "move" }[event.key];
    if (arrow) this.onArrow(arrow, event.shiftKey);
    else if (zoom && this.tool === "camera") {
      this.dolly(zoom * 0.1);
      this.writeSoon();
    } else if (zoom) this.picture.zoomBy(zoom);
    else if (event.key === "0") this.picture.zoomTo(0);
    else if (tool) document.querySelector<HTMLInputElement>(`input[name=tool][value=${tool}]`)!.checked = true;
    else if (event.key === "f") void this.frameAll();
    else if (event.key === "w") void this.readout.why();
    else if (event.key === "Enter") void this.select(this.readout.pixel, true);
    else return;
    event.preventDefault();
  }

  private onArrow(arrow: Point, isShifted: boolean): void {
    const step = isShifted ? 10 : 1;
    if (this.tool === "inspect") this.readout.step(arrow.x * step, arrow.y * step);
    else if (this.tool === "move") this.drag({ x: arrow.x * step, y: arrow.y * step }, 1);
    else {
      const height = this.picture.image.clientHeight;
      const size = isShifted ? height / 20 : (height * STEP) / TURN;
      this.steer(isShifted ? "pan" : "orbit", { x: arrow.x * size, y: arrow.y * size });
      this.writeSoon();
    }
  }

  /** Turns or shifts the camera as if the hand had moved what is seen by pixels of the window. */
  private steer(kind: "orbit" | "pan", by: Point): void {
    const height = Math.max(this.picture.image.clientHeight, 1);
    const [first, factor] = kind === "orbit" ? [0, TURN / height] : [2, 1 / height];
    const motion: Motion = [...this.motion];
    motion[first] = (motion[first] ?? 0) + by.x * factor;
    motion[first + 1] = (motion[first + 1] ?? 0) - by.y * factor;
    this.motion = motion;
    this.picture.move(motion);
  }

  private dolly(by: number): void {
    const motion: Motion = [...this.motion];
    motion[4] += by;
    this.motion = motion;
    this.picture.move(motion);
  }

  private writeSoon(): void {
    clearTimeout(this.timer);
    this.timer = setTimeout(() => this.write(), PAUSE);
  }

  /** Writes the movement of the camera into the text. */
  private write(): void {
    clearTimeout(this.timer);
    const { motion } = this;
    if (motion.every((part) => part === 0)) return;
    this.motion = [0, 0, 0, 0, 0];
    void this.ask({ motion }, `${MOVE}.camera`).then((isWritten) => {
      this.picture.settle();
      if (!isWritten) void this.picture.draw();
    });
  }

  /** Moves the camera that is shown, or another one, until everything is in the picture. */
  async frameAll(camera?: string): Promise<void> {
    await this.ask({ frame_all: true }, "input.frame", camera);
  }

  /** Asks for edits and applies them. */
  private async ask(what: object, userEvent: string, named?: string): Promise<boolean> {
    const editor = this.editor();
    if (!editor) return false;
    const { frame } = this.picture.view;
    const camera = named ?? this.picture.view.camera;
    for (let attempt = 0; ; attempt += 1) {
      const version = await editor.sync.settled();
      try {
        const { edits } = await post<{ edits: Edit[] }>("/move", { version, view: { camera, frame }, ...what });
        if (editor.sync.current !== version) continue;
        editor.apply(edits, userEvent);
        return edits.length > 0;
      } catch (error) {
        const isEarly = error instanceof Refused && error.status === 409;
        if (!isEarly || attempt > 50) {
          this.onFailure(error instanceof Error ? error.message : String(error));
          return false;
        }
        await new Promise((done) => setTimeout(done, 20));
      }
    }
  }

  /** Drags the selected geometry by pixels of the window, or of the picture. */
  private drag(by: Point, scale?: number): void {
    const { scene, image } = this.picture;
    if (!scene) return;
    const factor = scale ?? scene.width / Math.max(image.clientWidth, 1);
    this.shift = { x: this.shift.x + by.x * factor, y: this.shift.y + by.y * factor };
    this.shiftSelected();
  }

  private shiftSelected(): void {
    const { x, y } = this.shift;
    if (this.selected !== null && (x !== 0 || y !== 0)) this.shifting.push(this.selected);
  }

  private async writeShift(geometry: string): Promise<void> {
    const { x, y } = this.shift;
    this.shift = { x: 0, y: 0 };
    await this.ask({ geometry, by: [x, y] }, `${MOVE}.geometry`);
  }

  /** Selects the geometry at a pixel, and finds it in the text. */
  async select(at: Point | null, isJump: boolean): Promise<void> {
    if (!at) return;
    if (isJump) this.readout.pin(at);
    const pixel: Pixel | null = await this.readout.ask(at).catch(() => null);
    this.selected = pixel?.geometry?.path ?? null;
    const span = pixel?.geometry;
    if (!isJump || !span) return;
    if (span.from && span.to) this.editor()?.jump({ from: span.from, to: span.to }, true);
    // All rows of a table have the same place in the text.
    this.onFound(span.row === null ? span.path : `${span.path} row ${span.row}`);
  }
}
