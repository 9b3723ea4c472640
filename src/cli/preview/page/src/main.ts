// The page of `strahl preview`: joins the parts.

import { type Edit, get, listen, post, Refused, type SceneState, type State } from "./api.ts";
import { Compare } from "./compare.ts";
import { FileOnDisk } from "./conflict.ts";
import { Editor } from "./editor.ts";
import { Gestures } from "./gestures.ts";
import { element, Latest, showImage } from "./page.ts";
import { Parts } from "./parts.ts";
import { Picture, ZOOMS } from "./picture.ts";
import { showProblems } from "./problems.ts";
import { Readout } from "./readout.ts";
import { Timeline } from "./timeline.ts";

/** The time in milliseconds that a message is shown. */
const SHOWN = 8000;
/** The numbers of samples to choose from; each is a square. */
const MORE_SAMPLES = [4, 9, 16, 64];

let editor: Editor | null = null;
let last: State | null = null;

let messageTimer: ReturnType<typeof setTimeout> | undefined;
function tell(message: string): void {
  const line = element("connection");
  line.textContent = message;
  line.hidden = false;
  clearTimeout(messageTimer);
  messageTimer = setTimeout(() => (line.hidden = true), SHOWN);
}

const picture = new Picture(onDrawn, tell);
const readout = new Readout(picture);
const timeline = new Timeline(picture);
const compare = new Compare(picture);
const file = new FileOnDisk(() => editor, tell);
const gestures = new Gestures(picture, readout, () => editor, outlineOf, tell);

const parts = new Parts(() => editor, showCamera, tell);

/** The geometry that was found in the picture; null for the one at the cursor. */
let found: string | null = null;
function outlineOf(geometry: string): void {
  found = geometry;
  onPlace();
}

const outline = new Latest<null>(async () => {
  const image = element<HTMLImageElement>("outline");
  if (!editor || editor.sync.current !== last?.checked || last?.is_broken) return;
  const place = found === null ? editor.cursor : { geometry: found };
  const response = await get("/outline", { ...picture.query(), ...place }).catch(() => null);
  if (response?.status === 200) {
    await showImage(image, await response.blob());
  }
  image.dataset["geometry"] = response?.headers.get("x-strahl-geometry") ?? "";
  image.hidden = response?.status !== 200;
});

function onCursor(): void {
  found = null;
  onPlace();
}

let cursorTimer: ReturnType<typeof setTimeout> | undefined;
function onPlace(): void {
  clearTimeout(cursorTimer);
  cursorTimer = setTimeout(() => outline.push(null), 50);
}

function onDrawn(): void {
  onPlace();
  readout.refresh();
  void compare.update();
}

function onSettled(): void {
  if (last) editor?.show(last);
  parts.update();
}

/** Shows a camera of the scene, by its name in the list of parts. */
function showCamera(name: string): void {
  picture.view.camera = last?.scene?.cameras.includes(name) ? name : undefined;
  element<HTMLSelectElement>("camera").value = picture.view.camera ?? "";
  void picture.draw();
}

function applyFix(edits: Edit[]): void {
  if (editor?.sync.current === last?.checked) editor?.apply(edits, "input.fix");
}

/** The name of the camera at a path of the scene; empty for the one without a name. */
function cameraAt(path: string): string {
  return last?.scene?.cameras.find((name) => path === `cameras[${JSON.stringify(name)}]`) ?? "";
}

function onState(state: State): void {
  const isFirst = editor === null;
  editor ??= new Editor(element("source"), state.syntax, onCursor, onSettled, () => void file.save());
  last = state;
  picture.file = state.file;
  element("file").textContent = state.file;
  editor.sync.onVersion(state.version);
  editor.show(state);
  showProblems(state, {
    jump: (span) => (editor?.jump(span, false), editor?.view.focus()),
    fix: applyFix,
    frame: (path) => void gestures.frameAll(cameraAt(path)),
  });
  file.update(state);
  if (state.scene) updateChoices(state.scene, isFirst);
  timeline.update(state.scene);
  parts.update();
  if (picture.update(state.revision, state.is_broken, state.scene)) return;
  // The picture stays, but its text is another one.
  onPlace();
  readout.refresh();
}

function choices(select: HTMLSelectElement, names: [string, string][], value: string): void {
  const known = [...select.options].map((option) => `${option.value} ${option.text}`).join("\n");
  if (known !== names.map((pair) => pair.join(" ")).join("\n")) {
    select.replaceChildren(
      ...names.map(([name, label]) => {
        const option = document.createElement("option");
        option.value = name;
        option.textContent = label;
        return option;
      }),
    );
  }
  select.value = value;
}

function updateChoices(scene: SceneState, isFirst: boolean): void {
  const { view } = picture;
  if (view.camera !== undefined && !scene.cameras.includes(view.camera)) view.camera = undefined;
  if (!scene.layers.includes(view.layer)) view.layer = "color";
  const cameras: [string, string][] = scene.cameras.map((name) => [name, name]);
  if (scene.has_camera) cameras.unshift(["", "camera"]);
  element("camera-label").hidden = cameras.length < 2;
  choices(element<HTMLSelectElement>("camera"), cameras, view.camera ?? (scene.has_camera ? "" : (scene.cameras[0] ?? "")));
  choices(element<HTMLSelectElement>("layer"), scene.layers.map((name) => [name, name]), view.layer);
  element("exposure-label").hidden = !scene.is_lit;
  const samples = MORE_SAMPLES.filter((count) => count > scene.samples).map(String);
  if (view.samples !== undefined && !samples.includes(String(view.samples))) view.samples = undefined;
  element("samples-label").hidden = samples.length === 0;
  const ownSamples: [string, string] = ["", `${scene.samples} (scene)`];
  choices(
    element<HTMLSelectElement>("samples"),
    [ownSamples, ...samples.map((count): [string, string] => [count, count])],
    String(view.samples ?? ""),
  );
  const exposure = element<HTMLInputElement>("exposure");
  if (isFirst || view.exposure === undefined) exposure.value = String(scene.exposure);
}

function followControls(): void {
  const { view } = picture;
  element("camera").addEventListener("change", (event) => {
    view.camera = (event.target as HTMLSelectElement).value || undefined;
    void picture.draw();
  });
  element("layer").addEventListener("change", (event) => {
    view.layer = (event.target as HTMLSelectElement).value;
    void picture.draw();
  });
  element("samples").addEventListener("change", (event) => {
    view.samples = Number((event.target as HTMLSelectElement).value) || undefined;
    void picture.draw();
  });
  element("exposure").addEventListener("input", (event) => {
    const { value } = event.target as HTMLInputElement;
    view.exposure = value === "" ? undefined : Number(value);
    void picture.draw();
  });
  const zooms = ZOOMS.map((zoom): [string, string] => [String(zoom), zoom === 0 ? "fit" : `${zoom}×`]);
  choices(element<HTMLSelectElement>("zoom"), zooms, "0");
  element("zoom").addEventListener("change", (event) => {
    picture.zoomTo(Number((event.target as HTMLSelectElement).value));
  });
  const keys = element<HTMLDialogElement>("keys-dialog");
  element("show-keys").addEventListener("click", () => keys.showModal());
  element("frame").addEventListener("keydown", (event) => {
    if (event.key === "?") keys.showModal();
  });
  element("undo").addEventListener("click", () => editor?.undo());
  element("redo").addEventListener("click", () => editor?.redo());
  element("format").addEventListener("click", () => void format());
}

async function format(): Promise<void> {
  const version = await editor?.sync.settled();
  try {
    const { edits } = await post<{ edits: Edit[] }>("/format", { version });
    if (editor?.sync.current === version) editor?.apply(edits, "input.format");
  } catch (error) {
    if (!(error instanceof Refused && error.status === 409)) tell(error instanceof Error ? error.message : String(error));
  }
}

followControls();
listen(onState, (problem) => {
  const line = element("connection");
  clearTimeout(messageTimer);
  line.textContent = problem ?? "";
  line.hidden = problem === null;
});
