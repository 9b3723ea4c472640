// The picture with as many pixels as the panel has, over the smaller one of the scene.

import { get, type Query } from "./api.ts";
import { element, showImage } from "./page.ts";

/** The time in milliseconds without a change before it is drawn. */
const PAUSE = 150;

export class Sharp {
  private readonly image = element<HTMLImageElement>("sharp");
  /** The query of the picture that is shown or on its way; empty for none. */
  private wanted = "";
  private abort = new AbortController();
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** Shows the picture of a query as soon as it is ready, and hides any other; null for none. */
  want(query: Query | null): void {
    const wanted = query ? JSON.stringify(query) : "";
    if (wanted === this.wanted) return;
    this.image.hidden = true;
    this.stop();
    this.wanted = wanted;
    if (query) this.timer = setTimeout(() => void this.draw(query), PAUSE);
  }

  /** Gives up a picture that is not there yet. */
  stop(): void {
    clearTimeout(this.timer);
    this.abort.abort();
    if (this.image.hidden) this.wanted = "";
  }

  private async draw(query: Query): Promise<void> {
    this.abort = new AbortController();
    const { signal } = this.abort;
    // The picture of the scene is there already: without a sharper one, it stays.
    const response = await get("/magnified", query, signal).catch(() => null);
    const blob = response?.status === 200 ? await response.blob().catch(() => null) : null;
    if (!blob || signal.aborted) return;
    await showImage(this.image, blob);
    if (!signal.aborted) this.image.hidden = false;
  }
}
