// The file on the disk: saving the draft, and what to do when somebody else has changed the file.

import { getJson, post, Refused, type State } from "./api.ts";
import type { Editor } from "./editor.ts";
import { element } from "./page.ts";

interface Line {
  of: "both" | "mine" | "disk";
  text: string;
}

/** The lines of one of two texts; those that the other does not have are marked. */
function side(lines: Line[], of: "mine" | "disk"): (string | HTMLElement)[] {
  return lines
    .filter((line) => line.of === "both" || line.of === of)
    .map((line) => {
      if (line.of === "both") return line.text;
      const mark = document.createElement("mark");
      mark.textContent = line.text;
      return mark;
    });
}

export class FileOnDisk {
  private isSaved = true;

  constructor(
    private readonly editor: () => Editor | null,
    private readonly onFailure: (message: string) => void,
  ) {
    element("save").addEventListener("click", () => void this.save());
    element("take-disk").addEventListener("click", () => void this.reload());
    element("keep-mine").addEventListener("click", () => void this.save(true));
    element("show-both").addEventListener("click", () => void this.showBoth());
    document.addEventListener("keydown", (event) => {
      if ((event.ctrlKey || event.metaKey) && event.key === "s" && !event.defaultPrevented) {
        event.preventDefault();
        void this.save();
      }
    });
    addEventListener("beforeunload", (event) => {
      if (!this.isSaved || this.editor()?.sync.current === null) event.preventDefault();
    });
  }

  update(state: State): void {
    this.isSaved = state.is_saved;
    element("saved").textContent = state.is_saved ? "" : "unsaved";
    document.title = `${state.is_saved ? "" : "• "}${state.file} – strahl`;
    const banner = element("conflict");
    if (banner.hidden === state.conflict) {
      banner.hidden = !state.conflict;
      element("conflict-text").textContent = state.conflict ? `${state.file} has changed on the disk.` : "";
    }
  }

  async save(overwrite = false): Promise<void> {
    const version = await this.editor()?.sync.settled();
    await post("/save", { version, overwrite }).catch((error: Error) => {
      // A conflict is shown by the state.
      if (!(error instanceof Refused && error.status === 409)) this.onFailure(error.message);
    });
  }

  private async reload(): Promise<void> {
    await post("/reload", {}).catch((error: Error) => this.onFailure(error.message));
  }

  private async showBoth(): Promise<void> {
    try {
      await this.editor()?.sync.settled();
      const { lines } = await getJson<{ lines: Line[] }>("/disk");
      element("both-mine").replaceChildren(...side(lines, "mine"));
      element("both-disk").replaceChildren(...side(lines, "disk"));
      element<HTMLDialogElement>("both-dialog").showModal();
    } catch (error) {
      this.onFailure(error instanceof Error ? error.message : String(error));
    }
  }
}
