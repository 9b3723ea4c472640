// The line under the picture: what a pixel shows, and why.

import { get, getJson, type Pixel } from "./api.ts";
import { element, Latest } from "./page.ts";
import type { Picture } from "./picture.ts";

function number(value: number): string {
  return String(Number(value.toPrecision(6)));
}

function vector(values: [number, number, number]): string {
  return `(${values.map(number).join(", ")})`;
}

/**
 * Four lines, of which the last may be long, so that the picture above stays where it is. Rows are counted as in the equations of
 * cameras, and by `strahl pixel`.
 */
function describe(pixel: Pixel, height: number): string {
  const hex = pixel.byte.map((byte) => byte.toString(16).padStart(2, "0")).join("");
  const place = `pixel ${pixel.x}, ${height - 1 - pixel.y} (y from the bottom)`;
  const color = `${place} · #${hex} (${pixel.byte.join(", ")})`;
  const seen = pixel.geometry;
  if (!seen) return `${color}\nbackground`;
  const row = seen.row === null ? "" : ` row ${seen.row}`;
  const name = seen.name === null ? "" : ` “${seen.name}”`;
  return [
    color,
    `${seen.kind} ${seen.path}${row}${name} · depth ${number(seen.depth)}`,
    `position ${vector(seen.position)} · normal ${vector(seen.normal)}`,
    ...(seen.columns.length > 0 ? [columns(seen)] : []),
  ].join("\n");
}

function columns(seen: NonNullable<Pixel["geometry"]>): string {
  const cells = seen.columns.map(([name, text]) => `${name} ${seen.is_from_file ? text : number(Number(text))}`);
  if (seen.more_columns > 0) cells.push(`and ${seen.more_columns} more`);
  return cells.join(", ");
}

interface At {
  x: number;
  y: number;
}

export class Readout {
  /** The pixel under the mouse. */
  private hovered: At | null = null;
  /** The pixel of the cross hair: that of the last click, or of the keys. */
  private pinned: At | null = null;
  private readonly reading = new Latest<At>((at) => this.read(at));
  private readonly out = element<HTMLOutputElement>("readout");
  private readonly cross = element("cross");

  constructor(private readonly picture: Picture) {
    element("why").addEventListener("click", () => void this.why());
    element("why-copy").addEventListener("click", () => {
      void navigator.clipboard.writeText(element("why-text").textContent ?? "");
    });
  }

  /** Reads the pixel under the mouse; without one, that of the cross hair again, or else the last one. */
  point(at: At | null): void {
    if (at || this.pinned) this.hovered = at;
    this.out.setAttribute("aria-live", "off");
    this.refresh();
  }

  /** Takes notice of the mouse while it drags: the next picture is read there. */
  follow(at: At | null): void {
    if (at) this.hovered = at;
  }

  /** Puts the cross hair on a pixel. */
  pin(at: At): void {
    const { scene } = this.picture;
    if (!scene) return;
    this.pinned = at;
    this.hovered = null;
    this.cross.hidden = false;
    this.cross.style.left = `calc(var(--width) * ${(at.x + 0.5) / scene.width})`;
    this.cross.style.top = `calc(var(--height) * ${(at.y + 0.5) / scene.height})`;
    this.refresh();
  }

  /** Moves the cross hair, from the middle at first. */
  step(right: number, down: number): void {
    const { scene } = this.picture;
    if (!scene) return;
    const clamp = (value: number, side: number): number => Math.min(Math.max(value, 0), side - 1);
    const from = this.pinned ?? { x: scene.width >> 1, y: scene.height >> 1 };
    this.out.setAttribute("aria-live", "polite");
    this.pin({ x: clamp(from.x + right, scene.width), y: clamp(from.y + down, scene.height) });
  }

  /** Reads again, after a new picture. */
  refresh(): void {
    const { scene } = this.picture;
    const { pinned } = this;
    const isOutside = (at: At | null): boolean => at !== null && scene !== null && (at.x >= scene.width || at.y >= scene.height);
    if (isOutside(pinned)) this.pinned = null;
    if (isOutside(this.hovered)) this.hovered = null;
    this.cross.hidden = this.pinned === null;
    const at = this.hovered ?? this.pinned;
    element<HTMLButtonElement>("why").disabled = at === null;
    if (at) this.reading.push(at);
  }

  get pixel(): At | null {
    return this.pinned;
  }

  private async read(at: At): Promise<void> {
    const pixel = await this.ask(at, at === this.pinned);
    this.out.textContent = describe(pixel, this.picture.scene?.height ?? 0);
  }

  /** What a pixel shows; with all columns of the row of a table, which are read from its file. */
  ask(at: At, whole = false): Promise<Pixel> {
    return getJson<Pixel>("/pixel", { ...this.picture.query(), ...at, whole: String(whole) });
  }

  /** Explains the pixel that is read. */
  async why(): Promise<void> {
    const at = this.hovered ?? this.pinned;
    if (!at) return;
    const text = await get("/why", { ...this.picture.query(), ...at })
      .then((response) => response.text())
      .catch((error: Error) => error.message);
    element("why-text").textContent = text;
    element<HTMLDialogElement>("why-dialog").showModal();
  }
}
