// The elements of index.html.

export function element<T extends HTMLElement = HTMLElement>(id: string): T {
  const found = document.getElementById(id);
  if (!found) throw new Error(`index.html has no #${id}`);
  return found as T;
}

/** Shows an image in place of the one before, whose memory is freed. Resolves once it is visible. */
export async function showImage(image: HTMLImageElement, blob: Blob): Promise<void> {
  const url = URL.createObjectURL(blob);
  const next = new Image();
  next.src = url;
  await next.decode();
  const old = image.src;
  image.src = url;
  await image.decode();
  if (old.startsWith("blob:")) URL.revokeObjectURL(old);
}

/** Runs the newest of several requests, one at a time; those in between are left out. */
export class Latest<T> {
  private next: T | undefined;
  private isBusy = false;

  constructor(private readonly run: (value: T) => Promise<void>) {}

  push(value: T): void {
    this.next = value;
    if (!this.isBusy) void this.drain();
  }

  get busy(): boolean {
    return this.isBusy;
  }

  private async drain(): Promise<void> {
    this.isBusy = true;
    while (this.next !== undefined) {
      const value = this.next;
      this.next = undefined;
      await this.run(value).catch(() => undefined);
    }
    this.isBusy = false;
  }
}
