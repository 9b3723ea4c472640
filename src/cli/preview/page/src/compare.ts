// The picture beside another one.

import { get, upload } from "./api.ts";
import { element, showImage } from "./page.ts";
import type { Picture } from "./picture.ts";

type Mode = "off" | "side" | "wipe" | "difference";

export class Compare {
  private id: string | null = null;
  private readonly mode = element<HTMLSelectElement>("compare-mode");
  private readonly wipe = element<HTMLInputElement>("wipe");
  /** The border of the wipe, for the mouse; the slider is for keys. */
  private readonly line = element("wipe-line");
  private readonly reference = element<HTMLImageElement>("reference");
  private readonly difference = element<HTMLImageElement>("difference");
  private readonly out = element<HTMLOutputElement>("comparison");

  constructor(private readonly picture: Picture) {
    const input = element<HTMLInputElement>("compare-file");
    input.addEventListener("change", () => {
      const file = input.files?.[0];
      if (file) void this.load(file);
      input.value = "";
    });
    this.mode.addEventListener("change", () => void this.update());
    this.wipe.addEventListener("input", () => this.setBorder());
    this.line.addEventListener("pointerdown", (event) => {
      event.stopPropagation();
      this.line.setPointerCapture(event.pointerId);
    });
    this.line.addEventListener("pointermove", (event) => {
      if (!this.line.hasPointerCapture(event.pointerId)) return;
      const { left, width } = this.reference.getBoundingClientRect();
      this.wipe.valueAsNumber = ((event.clientX - left) / width) * 100;
      this.setBorder();
    });
    document.addEventListener("dragover", (event) => {
      if (event.dataTransfer?.types.includes("Files")) event.preventDefault();
    });
    document.addEventListener("drop", (event) => {
      const file = event.dataTransfer?.files[0];
      if (!file) return;
      event.preventDefault();
      void this.load(file);
    });
  }

  private async load(file: File): Promise<void> {
    try {
      const { id } = await upload<{ id: string }>("/reference", file);
      this.id = id;
      await showImage(this.reference, await (await get(`/reference/${id}`)).blob());
      this.reference.alt = file.name;
      element("compare-mode-label").hidden = false;
      if (this.mode.value === "off") this.mode.value = "wipe";
      await this.update();
    } catch (error) {
      this.out.textContent = error instanceof Error ? error.message : String(error);
    }
  }

  private setBorder(): void {
    const isWipe = this.id !== null && this.mode.value === "wipe";
    this.reference.style.clipPath = isWipe ? `inset(0 0 0 ${this.wipe.value}%)` : "none";
    this.line.hidden = !isWipe;
    this.line.style.left = `calc(var(--width) * ${this.wipe.valueAsNumber / 100})`;
  }

  /** Shows the comparison in the chosen way; again after each new picture. */
  async update(): Promise<void> {
    const mode = (this.id === null ? "off" : this.mode.value) as Mode;
    element("canvas").dataset["mode"] = mode;
    element("wipe-label").hidden = mode !== "wipe";
    this.reference.hidden = mode !== "side" && mode !== "wipe";
    this.difference.hidden = mode !== "difference";
    this.setBorder();
    this.picture.layOut();
    this.out.textContent = "";
    if (this.id === null || mode === "off") return;
    try {
      const response = await get("/difference", { ...this.picture.query(), reference: this.id });
      const numbers = JSON.parse(response.headers.get("x-strahl-difference") ?? "{}") as {
        pixels: number;
        different: number;
        max_delta: number;
      };
      await showImage(this.difference, await response.blob());
      this.difference.alt = "The differences; brighter means more";
      this.out.textContent =
        numbers.different === 0
          ? "The pictures are equal."
          : `${numbers.different} of ${numbers.pixels} pixels differ, the largest difference is ${numbers.max_delta}.`;
    } catch (error) {
      this.difference.hidden = true;
      this.out.textContent = error instanceof Error ? error.message : String(error);
    }
  }
}
