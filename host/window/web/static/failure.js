// What has failed: the window's own code, or something else on the page, which is none of its business.

// Where the files of this page are; their names may have hashes.
const BASE = new URL(".", import.meta.url).href;
// A file of the page in the text of a stack. An extension, a script of another site and a text that was evaluated are none.
const OWN = new RegExp(`${BASE.replace(/[.*+?^${}()|[\]\\]/g, "\\$&")}[\\w.-]+\\.(js|wasm)\\b`);
// A place of any script.
const PLACED = /\b[a-z][\w+.-]*:\/\//;

// Whether the window's own code has failed: an error whose stack passes through a file of this page, or WebAssembly that
// stopped where no stack has addresses. A notice of the browser without an error, as of ResizeObserver, is none.
export function isOwn(error, file = "") {
  if (!(error instanceof Error)) {
    return false;
  }
  const places = `${file}\n${error.stack ?? ""}`;
  return OWN.test(places) || (error instanceof WebAssembly.RuntimeError && !PLACED.test(places));
}

// Why WebAssembly could not be loaded.
export function whyNotLoaded(error) {
  if (error instanceof WebAssembly.CompileError && /content.security|unsafe-eval|csp/i.test(error.message)) {
    return "This server's Content-Security-Policy forbids WebAssembly: its script-src needs 'wasm-unsafe-eval'.";
  }
  if (error instanceof TypeError) {
    return "A part of the page could not be loaded: check the connection, and load the page again.";
  }
  return "Slipline could not be opened in this browser.";
}

// What the browser lacks, as a sentence; null if nothing. The window gets this context when it asks for one. It smooths its
// edges itself, and nothing shines through it: to have the browser do the same again takes software graphics several times as
// long for each picture.
export function lacking(canvas) {
  const lacks = (what) => `This browser has no ${what}, which Slipline needs: a newer browser has it.`;
  if (typeof WebAssembly !== "object") {
    return lacks("WebAssembly");
  }
  // Letters are painted, and fields computed, by it.
  if (!WebAssembly.validate(SIMD)) {
    return lacks("SIMD of WebAssembly");
  }
  if (typeof WebGL2RenderingContext !== "function") {
    return lacks("WebGL 2");
  }
  if (!canvas.getContext("webgl2", { alpha: false, antialias: false, depth: false, stencil: false })) {
    return "This browser gives the page no WebGL 2: switch graphics acceleration on in its settings, and load the page again.";
  }
  return hasModuleWorkers() ? null : lacks("workers of modules");
}

// A module with one function, which makes a vector of 128 bits and counts its bits: `i8x16.popcnt(i8x16.splat(0))`.
const SIMD = new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
]);

// A browser that has them asks for the type.
function hasModuleWorkers() {
  let isAsked = false;
  const options = {
    get type() {
      isAsked = true;
      return "module";
    },
  };
  new Worker("data:text/javascript,", options).terminate();
  return isAsked;
}
