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

function describe(pixel: Pixel): string {
  const hex = pixel.byte.map((byte) => byte.toString(16).padStart(2, "0")).join("");
  const parts = [`pixel ${pixel.x}, ${pixel.y}`, `#${hex} (${pixel.byte.join(", ")})`];
  const seen = pixel.geometry;
  if (!seen) return [...parts, "background"].join(" · ");
  const row = seen.row === null ? "" : ` row ${seen.row}`;
  const name = seen.name === null ? "" : ` “${seen.name}”`;
  return [
    ...parts,
    `${seen.kind} [${seen.index}]${row}${name}`,
    `depth ${number(seen.depth)}`,
    `position ${vector(seen.position)}`,
    `normal ${vector(seen.normal)}`,
  ].join(" · ");
}

export class Readout {
  private at: { x: number; y: number } | null = null;
  private readonly reading = new Latest<{ x: number; y: number }>((at) => this.read(at));
  private readonly out = element<HTMLOutputElement>("readout");
  private readonly cross = element("cross");

  constructor(private readonly picture: Picture) {
    element("why").addEventListener("click", () => void this.why());
    element("why-copy").addEventListener("click", () => {
      void navigator.clipboard.writeText(element("why-text").textContent ?? "");
    });
  }

  /** Reads a pixel. */
  point(at: { x: number; y: number }): void {
    this.at = at;
    element<HTMLButtonElement>("why").disabled = false;
    this.reading.push(at);
  }

  /** Moves the cross hair, from the middle at first. */
  step(right: number, down: number): void {
    const { scene } = this.picture;
    if (!scene) return;
    const clamp = (value: number, side: number): number => Math.min(Math.max(value, 0), side - 1);
    const from = this.at ?? { x: scene.width >> 1, y: scene.height >> 1 };
    const at = { x: clamp(from.x + right, scene.width), y: clamp(from.y + down, scene.height) };
    this.cross.hidden = false;
    this.cross.style.left = `calc(var(--width) * ${(at.x + 0.5) / scene.width})`;
    this.cross.style.top = `calc(var(--height) * ${(at.y + 0.5) / scene.height})`;
    this.out.setAttribute("aria-live", "polite");
    this.point(at);
  }

  hideCross(): void {
    this.cross.hidden = true;
    this.out.setAttribute("aria-live", "off");
  }

  get pixel(): { x: number; y: number } | null {
    return this.at;
  }

  private async read(at: { x: number; y: number }): Promise<void> {
    this.out.textContent = describe(await this.ask(at));
  }

  /** What a pixel shows. */
  ask(at: { x: number; y: number }): Promise<Pixel> {
    return getJson<Pixel>("/pixel", { ...this.picture.query(), ...at });
  }

  /** Explains the pixel that was read last. */
  async why(): Promise<void> {
    if (!this.at) return;
    const text = await get("/why", { ...this.picture.query(), ...this.at })
      .then((response) => response.text())
      .catch((error: Error) => error.message);
    element("why-text").textContent = text;
    element<HTMLDialogElement>("why-dialog").showModal();
  }
}
