// The built extension beside the program itself. STRAHL is the program.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import { join, resolve } from "node:path";
import { after, before, test } from "node:test";
import { fileURLToPath } from "node:url";
import {
  Document,
  answers,
  closeDocument,
  openDocument,
  seen,
  settings,
  vscode,
} from "./vscode.mjs";

const root = fileURLToPath(new URL("..", import.meta.url));
const builds = ["release", "debug"].map((build) => join(root, "../../target", build, "strahl"));
const program = resolve(process.env.STRAHL ?? builds.find(existsSync) ?? "strahl");
const extension = createRequire(import.meta.url)("../dist/extension.js");

const SCENE = `// A scene
(
    image: (width: 40, height: 30),
    camera: Perspective(eye: (0, 0, 5), look_at: (0, 0, 0), fov: 60),
    background: "#000000",
    geometries: [
        Sphere(center: (0, 0, 0), radius: 1, color: "#ff0000"),
    ],
)
`;
const folder = mkdtempSync(join(tmpdir(), "strahl-"));
const context = { extensionUri: vscode.Uri.file(root), subscriptions: [] };

/** Opens a scene of its own file. */
async function open(name, text = SCENE) {
  const path = join(folder, name);
  writeFileSync(path, text);
  const document = new Document(path, { json: "json", ron: "ron" }[name.split(".")[1]] ?? "plaintext");
  await openDocument(document);
  return document;
}

/** Waits until there is a value, which is returned. */
async function until(find, what) {
  for (let waited = 0; waited < 20_000; waited += 20) {
    const found = await find();
    if (found) return found;
    await new Promise((done) => setTimeout(done, 20));
  }
  throw new Error(`${what} does not come`);
}

/** Returns the last message of a type that the panel got, if it fulfills a condition. */
function last(panel, type, holds = () => true) {
  const message = panel.messages.findLast((message) => message.type === type);
  return message && holds(message) ? message : undefined;
}

function isRunning(file) {
  return execFileSync("ps", ["-e", "-o", "args"], { encoding: "utf8" }).includes(`preview --no-open ${file}`);
}

before(async () => {
  settings["strahl.path"] = join(folder, "nowhere");
  await extension.activate(context);
  assert.match(seen.errors.pop(), /The program `.*nowhere` is missing/);
  settings["strahl.path"] = program;
  await seen.commands.get("strahl.restart")();
  assert.deepEqual(seen.errors, []);
});

after(async () => {
  await extension.deactivate();
  rmSync(folder, { recursive: true });
});

test("a program that is missing leads to its installation", async () => {
  settings["strahl.path"] = "strahl-that-nobody-has";
  answers.push("Installation");
  await open("missing.ron");
  await seen.commands.get("strahl.openPreview")();
  settings["strahl.path"] = program;
  assert.match(seen.errors.pop(), /`strahl-that-nobody-has` is missing/);
  await until(() => seen.external.length > 0, "the page");
  assert.match(seen.external.pop(), /docs\/install\.md$/);
});

test("a program without a language server is named", async () => {
  settings["strahl.path"] = process.execPath;
  await seen.commands.get("strahl.restart")();
  assert.match(seen.errors.pop(), /has no language server/);
  settings["strahl.path"] = program;
  await seen.commands.get("strahl.restart")();
  assert.deepEqual(seen.errors, []);
});

for (const name of ["faulty.ron", "faulty.json"]) {
  test(`${name} gets diagnostics, which go when it is corrected`, async () => {
    const faulty = name.endsWith("json")
      ? '{"camera": {"Perspective": {"eye": [0, 0, 5], "gaze": [0, 0, -1], "fov": 60}},\n "geometries": [{"Sphere": {"center": [0, 0, 0], "radios": 1, "color": "#ff0000"}}]}\n'
      : SCENE.replace("radius", "radios");
    const document = await open(name, faulty);
    const found = () => seen.diagnostics.get(document.uri.toString()) ?? [];
    await until(() => found().some(({ message }) => /radios/.test(message)), "the diagnostic");
    await document.type("radios", "radius");
    await until(() => found().length === 0, "the end of the diagnostic");
    await closeDocument(document);
  });
}

test("the unsaved text of a table counts", async () => {
  const table = await open("balls.csv", "x,y,z,radius\n0,0,0,1\n");
  const scene = await open("table.ron", SCENE.replace(/Sphere\(.*\)/, 'Spheres(file: "balls.csv", color: "#ff0000")'));
  const found = () => seen.diagnostics.get(scene.uri.toString()) ?? [];
  await table.type("0,0,0,1", "0,0,0,-1");
  await until(() => found().length > 0, "the diagnostic");
  await table.type("0,0,0,-1", "0,0,0,1");
  await until(() => found().length === 0, "the end of the diagnostic");
  await closeDocument(table);
  await closeDocument(scene);
});

test("the server offers what the manual lists", async () => {
  const document = await open("offers.ron");
  for (const name of [
    "CodeActionsProvider",
    "ColorProvider",
    "CompletionItemProvider",
    "DefinitionProvider",
    "DocumentFormattingEditProvider",
    "DocumentLinkProvider",
    "DocumentSymbolProvider",
    "FoldingRangeProvider",
    "HoverProvider",
    "RenameProvider",
  ]) {
    await until(() => seen.providers.has(name), name);
  }
  const { token } = new vscode.CancellationTokenSource();
  const at = document.getText().indexOf("geometries");
  await document.replace(new vscode.Range(document.positionAt(at), document.positionAt(at)), "back");
  const place = document.positionAt(at + 4);
  const [, completion] = seen.providers.get("CompletionItemProvider");
  const found = await completion.provideCompletionItems(document, place, token, { triggerKind: 0 });
  const { items } = found;
  assert.ok(items.some(({ label }) => (label.label ?? label) === "lights"), JSON.stringify(items));
  const [, hover] = seen.providers.get("HoverProvider");
  const { contents } = await hover.provideHover(document, document.positionAt(document.getText().indexOf("fov")), token);
  assert.match(contents[0].value, /above 0, below 180/);
  await closeDocument(document);
});

test("the picture beside the text follows the text", async () => {
  const document = await open("scene.ron");
  await seen.commands.get("strahl.openPreview")();
  const panel = seen.panels.at(-1);
  assert.match(panel.webview.html, /default-src 'none'/);
  assert.doesNotMatch(panel.webview.html, /token|unsafe/);
  // The first one is coarse.
  await until(() => panel.messages.filter(({ type }) => type === "picture").length > 1, "the picture");
  const first = last(panel, "picture");
  assert.deepEqual([...first.png.slice(1, 4)], [...Buffer.from("PNG")]);
  assert.deepEqual([first.width, first.height], [40, 30]);
  assert.match(last(panel, "address").address, /^http:\/\/127\.0\.0\.1:\d+$/);

  await document.type("radius: 1", "radius: 1.5");
  await until(() => last(panel, "picture", (next) => !Buffer.from(next.png).equals(first.png)), "a new picture");
  await document.type("radius: 1.5", "radius: ,");
  await until(() => last(panel, "state", ({ isBroken, errors }) => isBroken && errors > 0), "the errors");
  await document.type("radius: ,", "radius: 1");
  await until(() => last(panel, "state", ({ isBroken }) => !isBroken), "the repaired scene");
  await until(() => last(panel, "picture", (next) => Buffer.from(next.png).equals(first.png)), "the first picture");
  assert.equal(readFileSync(document.fileName, "utf8"), SCENE, "only the editor saves");

  await panel.send({ type: "pick", x: 20, y: 15 });
  const { selection } = await until(() => seen.selections.pop(), "the selection");
  const [start, end] = [selection.start, selection.end].map((place) => document.offsetAt(place));
  assert.match(document.getText().slice(start, end), /^Sphere\(.*\)$/);

  panel.messages.length = 0;
  await panel.send({ type: "ready" });
  assert.deepEqual(panel.messages.map(({ type }) => type).sort(), ["address", "picture", "state"]);
  await closeDocument(document);
  assert.equal(panel.isOpen, false);
  await until(() => !isRunning(document.fileName), "the end of the program");
});

test("what the page in the browser edits comes into the text", async () => {
  const document = await open("both.ron", SCENE.replaceAll("\n", "\r\n"));
  await seen.commands.get("strahl.openPage")();
  const page = new URL(seen.external.pop());
  const panel = seen.panels.at(-1);
  await until(() => last(panel, "picture"), "the picture");
  const headers = {
    Authorization: `Bearer ${page.searchParams.get("token")}`,
    "Content-Type": "application/json",
  };
  const draft = async () => (await fetch(new URL("/text", page), { headers })).json();
  await document.type("// A scene", "// A \u{1f642} scene");
  const { version } = await until(async () => {
    const now = await draft();
    return now.text.includes("\u{1f642} scene") && now;
  }, "the draft");
  // Columns are in UTF-16: the smiley has two. The rocket begins with the same one.
  const edit = { from: { line: 1, column: 6 }, to: { line: 1, column: 8 }, text: "\u{1f680}" };
  const body = JSON.stringify({ version, edits: [edit] });
  assert.ok((await fetch(new URL("/edits", page), { method: "POST", headers, body })).ok);
  await until(() => document.getText().startsWith("// A \u{1f680} scene\r\n(\r\n"), "the edit");
  await document.type("// A", "// The");
  await until(async () => (await draft()).text.startsWith("// The \u{1f680} scene\n(\n"), "the next draft");

  panel.dispose();
  await until(() => !isRunning(document.fileName), "the end of the program");
  await closeDocument(document);
});

test("a preview needs a file, and says why it does not start", async () => {
  const document = await open("gone.ron");
  rmSync(document.fileName);
  await seen.commands.get("strahl.openPreview")();
  assert.match(seen.errors.pop(), /does not start: .*gone\.ron/s);
  document.uri = vscode.Uri.parse("untitled:Untitled-1");
  await seen.commands.get("strahl.openPreview")();
  assert.match(seen.errors.pop(), /Save the scene first/);
});
