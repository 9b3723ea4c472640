// The frames of an animation.

import type { SceneState } from "./api.ts";
import { element } from "./page.ts";
import type { Picture } from "./picture.ts";

export class Timeline {
  private readonly slider = element<HTMLInputElement>("time");
  private readonly button = element<HTMLButtonElement>("play");
  private started: { at: number; frame: number } | null = null;

  constructor(private readonly picture: Picture) {
    this.slider.addEventListener("input", () => {
      this.stop();
      void this.show(Number(this.slider.value));
    });
    this.button.addEventListener("click", () => {
      if (this.started) this.stop();
      else this.play();
    });
  }

  update(scene: SceneState | null): void {
    const frames = scene?.frames ?? 1;
    element("timeline").hidden = frames < 2;
    this.slider.max = String(frames - 1);
    if (this.picture.view.frame >= frames) this.picture.view.frame = 0;
    this.label();
    if (frames < 2) this.stop();
  }

  private label(): void {
    const { frame } = this.picture.view;
    this.slider.value = String(frame);
    element("frame-number").textContent = `${frame} / ${this.slider.max}`;
  }

  private async show(frame: number): Promise<void> {
    this.picture.view.frame = frame;
    this.label();
    await this.picture.draw();
  }

  private play(): void {
    this.started = { at: performance.now(), frame: this.picture.view.frame };
    this.button.textContent = "Pause";
    this.button.setAttribute("aria-pressed", "true");
    void this.run();
  }

  private stop(): void {
    this.started = null;
    this.button.textContent = "Play";
    this.button.setAttribute("aria-pressed", "false");
  }

  /** Shows the frame that is due, again and again; those that come too fast are left out. */
  private async run(): Promise<void> {
    while (this.started && this.picture.scene) {
      const { frames, fps } = this.picture.scene;
      const seconds = (performance.now() - this.started.at) / 1000;
      const due = (this.started.frame + Math.floor(seconds * fps)) % frames;
      if (due !== this.picture.view.frame) await this.show(due);
      await new Promise((done) => requestAnimationFrame(done));
    }
  }
}
