// The list of the cameras, lights and geometries of the scene.

import { type Edit, getJson, type Place, post, Refused, type Span } from "./api.ts";
import type { Editor } from "./editor.ts";
import { element, Latest } from "./page.ts";

type List = "cameras" | "lights" | "geometries";

interface Part extends Span {
  kind: "camera" | "light" | "geometry";
  name: string;
  variant: string;
  level: number;
  is_hidden: boolean;
}

interface Answer {
  parts: Part[];
  /** The number of parts that are left out. */
  more: number;
  can_hide: boolean;
  samples: Record<List, string[]>;
}

const LISTS: [List, Part["kind"], string][] = [
  ["cameras", "camera", "Cameras"],
  ["lights", "light", "Lights"],
  ["geometries", "geometry", "Geometries"],
];

export class Parts {
  private readonly panel = element<HTMLDetailsElement>("parts");
  private readonly updating = new Latest<null>(() => this.show());
  /** The list that is shown, as text: it is not built again, or a button would lose the focus. */
  private shown = "";

  constructor(
    private readonly editor: () => Editor | null,
    private readonly onCamera: (name: string) => void,
    private readonly onFailure: (message: string) => void,
  ) {
    this.panel.addEventListener("toggle", () => this.update());
  }

  /** Shows the parts of the text that was checked last. */
  update(): void {
    if (this.panel.open) this.updating.push(null);
  }

  private async show(): Promise<void> {
    const version = this.editor()?.sync.current;
    if (!version) return;
    const answer = await getJson<Answer>("/parts", { version });
    const list = JSON.stringify(answer);
    if (list === this.shown) return;
    this.shown = list;
    element("part-lists").replaceChildren(
      ...LISTS.map(([list, kind, title]) =>
        this.section(title, list, answer.parts.filter((part) => part.kind === kind), answer),
      ),
    );
    if (answer.more > 0) element("part-lists").append(`${answer.more} more`);
  }

  private section(title: string, list: List, parts: Part[], answer: Answer): HTMLElement {
    const section = document.createElement("section");
    section.setAttribute("aria-label", title);
    const head = document.createElement("div");
    head.append(Object.assign(document.createElement("h3"), { textContent: title }));
    const add = document.createElement("select");
    add.setAttribute("aria-label", `Add to ${title.toLowerCase()}`);
    add.replaceChildren(...["Add…", ...answer.samples[list]].map((name, index) => new Option(name, index > 0 ? name : "")));
    add.addEventListener("change", () => {
      if (add.selectedIndex > 0) void this.edit({ list, add: add.value });
      add.selectedIndex = 0;
    });
    const items = document.createElement("ul");
    items.replaceChildren(...parts.map((part) => this.item(part, answer.can_hide)));
    head.append(add);
    section.append(head, items);
    return section;
  }

  private item(part: Part, canHide: boolean): HTMLElement {
    const item = document.createElement("li");
    item.style.paddingLeft = `${part.level}em`;
    item.classList.toggle("hidden-part", part.is_hidden);
    const find = document.createElement("button");
    find.type = "button";
    find.className = "part";
    find.textContent = `${part.name} ${part.variant}`;
    find.addEventListener("click", () => {
      this.editor()?.jump(part, true);
      if (part.kind === "camera") this.onCamera(part.name);
    });
    item.append(find);
    if (part.kind !== "camera") {
      const hide = document.createElement("button");
      hide.type = "button";
      hide.textContent = part.is_hidden ? "Show" : "Hide";
      hide.setAttribute("aria-label", `${hide.textContent} ${find.textContent}`);
      hide.disabled = !canHide;
      if (!canHide) hide.title = "A hidden part is in a comment, and JSON has no comments; RON has.";
      hide.addEventListener("click", () => void this.edit({ hide_or_show: part.from }));
      item.append(hide);
    }
    return item;
  }

  private async edit(what: { list: List; add: string } | { hide_or_show: Place }): Promise<void> {
    const editor = this.editor();
    const version = await editor?.sync.settled();
    try {
      const { edits } = await post<{ edits: Edit[] }>("/parts", { version, ...what });
      if (editor?.sync.current === version) editor?.apply(edits, "input.part");
    } catch (error) {
      if (error instanceof Refused && error.status === 409) return;
      this.onFailure(error instanceof Error ? error.message : String(error));
    }
  }
}
