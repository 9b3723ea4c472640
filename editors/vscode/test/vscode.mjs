// A stand-in for the module `vscode`: it has what the extension and its language client use, and
// records what they register and show. What is not here does nothing.

import { readFileSync } from "node:fs";
import Module from "node:module";
import { pathToFileURL } from "node:url";

class Disposable {
  constructor(callback = () => {}) {
    this.dispose = callback;
  }
  static from = (...all) => new Disposable(() => all.forEach((one) => one.dispose()));
}

class EventEmitter {
  listeners = new Set();
  event = (listener, self) => {
    const bound = self ? listener.bind(self) : listener;
    this.listeners.add(bound);
    return new Disposable(() => this.listeners.delete(bound));
  };
  fire(event) {
    return Promise.all([...this.listeners].map((listener) => listener(event)));
  }
  dispose() {
    this.listeners.clear();
  }
}

class Position {
  constructor(line, character) {
    Object.assign(this, { line, character });
  }
}

class Range {
  constructor(...parts) {
    const [start, end] =
      parts.length === 2 ? parts : [new Position(parts[0], parts[1]), new Position(parts[2], parts[3])];
    Object.assign(this, { start, end });
  }
}

class Uri {
  constructor(url) {
    this.url = new URL(url);
    this.scheme = this.url.protocol.slice(0, -1);
    this.path = decodeURIComponent(this.url.pathname);
    this.fsPath = this.path;
    this.authority = this.url.host;
    this.query = this.url.search.slice(1);
    this.fragment = "";
  }
  static file = (path) => new Uri(pathToFileURL(path));
  static parse = (text) => new Uri(text);
  static joinPath = (uri, ...parts) => new Uri(`${uri}/${parts.join("/")}`);
  toString() {
    return this.url.href;
  }
}

class WorkspaceEdit {
  edits = [];
  replace(uri, range, text) {
    this.edits.push({ uri, range, text });
  }
}

class CancellationTokenSource {
  cancelled = new EventEmitter();
  token = { isCancellationRequested: false, onCancellationRequested: this.cancelled.event };
  cancel() {
    this.token.isCancellationRequested = true;
    this.cancelled.fire();
  }
  dispose() {}
}

/** A text in the editor. */
export class Document {
  version = 1;
  isUntitled = false;
  isClosed = false;
  constructor(path, languageId) {
    this.uri = Uri.file(path);
    this.fileName = path;
    this.languageId = languageId;
    this.text = readFileSync(path, "utf8");
  }
  getText() {
    return this.text;
  }
  get lineCount() {
    return this.text.split("\n").length;
  }
  offsetAt({ line, character }) {
    const before = this.text.split("\n").slice(0, line);
    return before.join("\n").length + Math.min(before.length, 1) + character;
  }
  positionAt(offset) {
    const lines = this.text.slice(0, offset).split("\n");
    return new Position(lines.length - 1, lines.at(-1).length);
  }
  /** Replaces a part of the text as somebody who types. */
  async type(old, text) {
    const start = this.text.indexOf(old);
    if (start < 0) throw new Error(`\`${old}\` is not in the text`);
    await this.replace(new Range(this.positionAt(start), this.positionAt(start + old.length)), text);
  }
  async replace(range, text) {
    const [start, end] = [this.offsetAt(range.start), this.offsetAt(range.end)];
    this.text = this.text.slice(0, start) + text + this.text.slice(end);
    this.version += 1;
    const change = { range, rangeOffset: start, rangeLength: end - start, text };
    await events.change.fire({ document: this, contentChanges: [change] });
  }
}

const events = {
  change: new EventEmitter(),
  open: new EventEmitter(),
  close: new EventEmitter(),
  visible: new EventEmitter(),
};

/** What the extension has shown and registered. */
export const seen = {
  commands: new Map(),
  diagnostics: new Map(),
  errors: [],
  external: [],
  panels: [],
  providers: new Map(),
  selections: [],
};
export const settings = { "strahl.path": "strahl" };
/** The answer to the next question. */
export const answers = [];
const documents = [];

export async function openDocument(document) {
  documents.push(document);
  vscode.window.activeTextEditor = { document, viewColumn: 1 };
  vscode.window.visibleTextEditors = [vscode.window.activeTextEditor];
  const input = new vscode.TabInputText(document.uri);
  vscode.window.tabGroups.all = [{ tabs: [{ input }] }];
  await events.open.fire(document);
  await events.visible.fire(vscode.window.visibleTextEditors);
}

export async function closeDocument(document) {
  documents.splice(documents.indexOf(document), 1);
  await events.close.fire(document);
}

function createPanel(viewType, title, column, options) {
  const [disposed, received] = [new EventEmitter(), new EventEmitter()];
  const panel = {
    viewType,
    title,
    options,
    isOpen: true,
    messages: [],
    send: (message) => received.fire(message),
    onDidDispose: disposed.event,
    reveal: () => {},
    dispose: () => {
      if (!panel.isOpen) return;
      panel.isOpen = false;
      void disposed.fire();
    },
    webview: {
      html: "",
      cspSource: "vscode-resource:",
      asWebviewUri: (uri) => uri,
      onDidReceiveMessage: received.event,
      postMessage: async (message) => panel.messages.push(message),
    },
  };
  seen.panels.push(panel);
  return panel;
}

function matches(selector, { languageId, uri }) {
  const isMatch = ({ language, scheme, pattern }) =>
    scheme === uri.scheme && (language ? language === languageId : uri.path.endsWith(pattern.slice(4)));
  return [selector].flat().some(isMatch) ? 10 : 0;
}

/** Completes a namespace: other functions that register return something to dispose of. */
function complete(known) {
  return new Proxy(known, {
    get(target, name) {
      if (name in target || typeof name === "symbol") return target[name];
      if (/^register|^on[A-Z]|^create/.test(name)) {
        return (...given) => {
          if (name.startsWith("register")) seen.providers.set(name.slice(8), given);
          return new Disposable();
        };
      }
      return undefined;
    },
  });
}

/** Classes that the language client extends or creates; what they hold does not matter here. */
const CLASSES =
  "CallHierarchyIncomingCall CallHierarchyItem CallHierarchyOutgoingCall CodeLens Color ColorInformation " +
  "ColorPresentation DiagnosticRelatedInformation DocumentHighlight DocumentLink FoldingRange InlayHint " +
  "InlayHintLabelPart InlineCompletionItem InlineCompletionList InlineValueEvaluatableExpression " +
  "InlineValueText InlineValueVariableLookup LinkedEditingRanges Location ParameterInformation " +
  "RelativePattern SelectionRange SemanticTokens SemanticTokensEdit SemanticTokensEdits SignatureHelp " +
  "SignatureInformation SnippetString SnippetTextEdit SymbolInformation TabInputCustom TabInputNotebook " +
  "TabInputTextDiff TypeHierarchyItem CodeActionTriggerKind CompletionItemKind CompletionItemTag " +
  "DiagnosticTag DocumentHighlightKind FileType FoldingRangeKind InlineCompletionTriggerKind " +
  "SignatureHelpTriggerKind SymbolKind SymbolTag TextDocumentSaveReason";
const classes = CLASSES.split(" ").map((name) => [name, class {}]);

const channel = complete({ append() {}, appendLine() {}, clear() {}, show() {}, dispose() {} });
for (const level of ["trace", "debug", "info", "warn", "error"]) channel[level] = () => {};

export const vscode = complete({
  ...Object.fromEntries(classes),
  version: "1.91.0",
  Disposable,
  EventEmitter,
  Position,
  Range,
  Uri,
  WorkspaceEdit,
  CancellationTokenSource,
  CancellationError: class extends Error {},
  Diagnostic: class {
    constructor(range, message, severity) {
      Object.assign(this, { range, message, severity });
    }
  },
  CodeAction: class {
    constructor(title, kind) {
      Object.assign(this, { title, kind });
    }
  },
  CodeActionKind: class CodeActionKind {
    static Empty = new CodeActionKind("");
    static QuickFix = new CodeActionKind("quickfix");
    constructor(value) {
      this.value = value;
    }
    append(part) {
      return new vscode.CodeActionKind(this.value ? `${this.value}.${part}` : part);
    }
  },
  MarkdownString: class {
    constructor(value = "") {
      this.value = value;
    }
    appendMarkdown(text) {
      this.value += text;
    }
    appendText = this.appendMarkdown;
  },
  Hover: class {
    constructor(contents, range) {
      Object.assign(this, { contents: [contents].flat(), range });
    }
  },
  TextEdit: class {
    constructor(range, newText) {
      Object.assign(this, { range, newText });
    }
  },
  DocumentSymbol: class {
    constructor(name, detail, kind, range, selectionRange) {
      Object.assign(this, { name, detail, kind, range, selectionRange, children: [] });
    }
  },
  CompletionItem: class {
    constructor(label) {
      this.label = label;
    }
  },
  CompletionList: class {
    constructor(items) {
      this.items = items;
    }
  },
  TabInputText: class {
    constructor(uri) {
      this.uri = uri;
    }
  },
  ViewColumn: { One: 1, Beside: -2 },
  LogLevel: { Off: 0, Trace: 1, Info: 3 },
  ProgressLocation: { Window: 10 },
  NotebookCellKind: { Markup: 1, Code: 2 },
  DiagnosticSeverity: { Error: 0, Warning: 1, Information: 2, Hint: 3 },
  CompletionTriggerKind: { Invoke: 0, TriggerCharacter: 1, TriggerForIncompleteCompletions: 2 },
  env: {
    language: "en",
    appName: "test",
    openExternal: async (uri) => seen.external.push(uri.toString()),
  },
  commands: complete({
    registerCommand: (name, callback) => {
      seen.commands.set(name, callback);
      return new Disposable(() => seen.commands.delete(name));
    },
    executeCommand: async (name, ...given) => seen.commands.get(name)?.(...given),
  }),
  languages: complete({
    match: matches,
    createDiagnosticCollection: () => ({
      set: (uri, found) => seen.diagnostics.set(uri.toString(), found),
      delete: (uri) => seen.diagnostics.delete(uri.toString()),
      has: (uri) => seen.diagnostics.has(uri.toString()),
      clear: () => seen.diagnostics.clear(),
      dispose: () => {},
    }),
  }),
  window: complete({
    activeTextEditor: undefined,
    visibleTextEditors: [],
    onDidChangeVisibleTextEditors: events.visible.event,
    tabGroups: complete({ all: [] }),
    createOutputChannel: () => channel,
    createWebviewPanel: createPanel,
    showErrorMessage: async (message) => {
      seen.errors.push(message);
      return answers.shift();
    },
    showTextDocument: async (document, { selection }) => seen.selections.push({ document, selection }),
    withProgress: (_options, task) => task({ report() {} }, new CancellationTokenSource().token),
  }),
  workspace: complete({
    textDocuments: documents,
    notebookDocuments: [],
    workspaceFolders: undefined,
    getWorkspaceFolder: () => undefined,
    getConfiguration: (section) => ({
      get: (name, otherwise) => settings[`${section}.${name}`] ?? otherwise,
    }),
    onDidChangeTextDocument: events.change.event,
    onDidOpenTextDocument: events.open.event,
    onDidCloseTextDocument: events.close.event,
    applyEdit: async ({ edits }) => {
      for (const { uri, range, text } of edits) {
        await documents.find((document) => `${document.uri}` === `${uri}`).replace(range, text);
      }
      return true;
    },
  }),
});

const load = Module._load;
Module._load = (name, ...rest) => (name === "vscode" ? vscode : load(name, ...rest));
