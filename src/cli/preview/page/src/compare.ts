// The picture beside another one.

import { get, upload } from "./api.ts";
import { element, showImage } from "./page.ts";
import type { Picture } from "./picture.ts";

type Mode = "off" | "side" | "wipe" | "difference";

export class Compare {
  private id: string | null = null;
  private readonly mode = element<HTMLSelectElement>("compare-mode");
  private readonly wipe = element<HTMLInputElement>("wipe");
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
    this.reference.style.clipPath = this.mode.value === "wipe" ? `inset(0 0 0 ${this.wipe.value}%)` : "none";
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
