// The grammar and the package, by the files that they are made of.

import assert from "node:assert/strict";
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";
import { test } from "node:test";

const require = createRequire(import.meta.url);
const oniguruma = require("vscode-oniguruma");
const { INITIAL, Registry, parseRawGrammar } = require("vscode-textmate");

const file = (path) => new URL(`../${path}`, import.meta.url);
const read = (path) => readFileSync(file(path), "utf8");

await oniguruma.loadWASM(readFileSync(require.resolve("vscode-oniguruma/release/onig.wasm")).buffer);
const registry = new Registry({
  onigLib: Promise.resolve({
    createOnigScanner: (patterns) => new oniguruma.OnigScanner(patterns),
    createOnigString: (text) => new oniguruma.OnigString(text),
  }),
  loadGrammar: async (scope) =>
    scope === "source.ron" ? parseRawGrammar(read("syntaxes/ron.tmLanguage.json"), "ron.json") : null,
});
const grammar = await registry.loadGrammar("source.ron");

/** The parts of each line with their innermost scopes, without the ending `.ron`. */
function scopes(text) {
  const found = [];
  let stack = INITIAL;
  for (const line of text.split("\n")) {
    const { tokens, ruleStack } = grammar.tokenizeLine(line, stack);
    stack = ruleStack;
    const parts = [];
    for (const { startIndex, endIndex, scopes } of tokens) {
      const [part, scope] = [line.slice(startIndex, endIndex), scopes.at(-1).replace(/\.ron$/, "")];
      if (parts.at(-1)?.[1] === scope) parts.at(-1)[0] += part;
      else parts.push([part, scope]);
    }
    for (const [part, scope] of parts) if (part.trim() !== "") found.push([part.trim(), scope]);
  }
  return found;
}

test("each part of a scene has its scope", () => {
  const field = "variable.other.property";
  const [open, close] = ["(", ")"].map((bracket) => [bracket, "punctuation.section"]);
  assert.deepEqual(scopes('(fov: -1.5e3, color: "#fff", of: Sphere(on: true), // end'), [
    open,
    ["fov", field],
    [":", "punctuation.separator.key-value"],
    ["-1.5e3", "constant.numeric"],
    [",", "punctuation.separator.comma"],
    ["color", field],
    [":", "punctuation.separator.key-value"],
    ['"#fff"', "string.quoted.double"],
    [",", "punctuation.separator.comma"],
    ["of", field],
    [":", "punctuation.separator.key-value"],
    ["Sphere", "entity.name.type"],
    open,
    ["on", field],
    [":", "punctuation.separator.key-value"],
    ["true", "constant.language"],
    close,
    [",", "punctuation.separator.comma"],
    ["// end", "comment.line.double-slash"],
  ]);
});

test("comments nest, and strings end where they end", () => {
  assert.deepEqual(scopes('/* a /* b */\n c */ r#"d " e"# "f\\"" 1'), [
    ["/* a /* b */", "comment.block"],
    ["c */", "comment.block"],
    ['r#"d " e"#', "string.quoted.double.raw"],
    ['"f', "string.quoted.double"],
    ['\\"', "constant.character.escape"],
    ['"', "string.quoted.double"],
    ["1", "constant.numeric"],
  ]);
});

test("nothing in the scenes of the repository is without a scope", () => {
  const folder = file("../../scenes/");
  const scenes = readdirSync(folder).filter((name) => name.endsWith(".ron"));
  assert.ok(scenes.length > 10);
  for (const name of scenes) {
    const text = readFileSync(new URL(name, folder), "utf8");
    const bare = scopes(text).filter(([, scope]) => scope === "source" || scope.startsWith("invalid"));
    assert.deepEqual(bare, [], name);
  }
});

test("the extension has the version and the address of the program", () => {
  const program = readFileSync(file("../../Cargo.toml"), "utf8");
  const value = (name) => program.match(new RegExp(`^${name} = "(.*)"`, "m"))[1];
  const extension = JSON.parse(read("package.json"));
  assert.equal(extension.version, value("version"));
  assert.equal(extension.repository.url, value("repository"));
  for (const path of ["README.md", "CHANGELOG.md", "src/program.ts"]) {
    const addresses = read(path).match(/https:\/\/github\.com\/\S+/g) ?? [];
    for (const address of addresses) assert.ok(address.startsWith(value("repository")), address);
  }
});
