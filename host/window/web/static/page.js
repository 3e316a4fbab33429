// The page: it starts the device worker and the window, and has what must work without the window: STOP.
//
//   STOP button, Esc, Space --> device worker      past the window, which may have failed, be busy or not be there yet
//   window (WebAssembly)    --> device worker      requests
//   device worker           --> window             what is new
//
// The browser gives no script the keys and the pointer while this thread is stuck. Then the device worker, whose
// questions are not answered, stops and disarms the device.

import { FILTERS } from "./serial.js";
import init, { openPage } from "./slipline_page.js";
import { showOffer, watchUpdates } from "./updates.js";

const canvas = document.getElementById("window");
const line = document.getElementById("line");
const loading = document.getElementById("loading");
const progress = document.getElementById("progress");

const device = new Worker(new URL("worker.js", import.meta.url), { type: "module", name: "device" });
let page = null;
// The latest state of link and device, as its worker reports it.
let deviceState = null;
// Whether that worker has Web Serial.
let hasSerial = false;
// Whether the window's own code has failed.
let hasFailed = false;

// ---- STOP

function stop() {
  device.postMessage({ stop: true });
  stopWindow();
}

// The window wants no drive any more.
function stopWindow() {
  if (page && !hasFailed) {
    page.stop();
  }
}

// Whether a key types text: into a field of the page, which eframe's fields have, too.
function isTyping() {
  const focused = document.activeElement;
  return focused instanceof HTMLInputElement || focused instanceof HTMLTextAreaElement;
}

// Whether the window receives the keys itself.
function windowHasFocus() {
  return page && !hasFailed && (document.activeElement === canvas || isTyping());
}

window.addEventListener("keydown", (event) => {
  if (event.repeat || !(event.key === "Escape" || (event.key === " " && !isTyping()))) {
    return;
  }
  device.postMessage({ stop: true });
  // A press that the window sees, too, must not count twice there: two are an emergency stop.
  if (!windowHasFocus()) {
    stopWindow();
    if (document.activeElement === document.getElementById("stop")) {
      event.preventDefault();
    }
  }
}, { capture: true });

// When it is pressed, not when it is let go.
document.getElementById("stop").addEventListener("pointerdown", stop);
document.getElementById("stop").addEventListener("click", (event) => {
  // By the keyboard: Enter.
  if (event.detail === 0) {
    stop();
  }
});

// ---- Out of sight

function leave(reason) {
  const canDrive = deviceState !== null && deviceState.armed;
  device.postMessage({ leave: reason });
  if (page && !hasFailed) {
    page.left(canDrive ? `${reason}: the device was stopped and disarmed. Press Drive to resume` : "");
  }
}

document.addEventListener("visibilitychange", () => {
  if (document.hidden) {
    leave("The page was hidden");
  }
});
document.addEventListener("freeze", () => leave("The page was put to sleep"));
window.addEventListener("pagehide", () => leave("The page was left"));

function showFocus() {
  const isDeaf = deviceState !== null && deviceState.armed && !document.hasFocus();
  if (!hasFailed) {
    line.textContent = isDeaf ? "Keys are not heard: another window has the focus. STOP works by the pointer." : "";
  }
}
window.addEventListener("focus", showFocus);
window.addEventListener("blur", showFocus);

// ---- The device worker

device.onmessage = ({ data }) => {
  if (data.ask) {
    device.postMessage({ sign: true });
  } else if (data.failed) {
    deviceFailed();
  } else {
    hasSerial = data.hasSerial;
    deviceState = { ...JSON.parse(data.state), time_origin_ms: data.origin };
    showFocus();
    showOffer();
    if (page && !hasFailed) {
      page.deviceChanged(data.update, data.isLoud);
    } else if (!hasFailed) {
      early.push(data);
    }
  }
};
device.onerror = deviceFailed;
// Updates before the window exists.
const early = [];

function deviceFailed() {
  deviceState = null;
  if (page && !hasFailed) {
    page.deviceCrashed();
  } else if (!hasFailed) {
    fail("The simulated device could not be started.");
  }
}

// ---- The job workers

const lanes = {};
let compiled = null;

function startLane(name) {
  lanes[name]?.terminate();
  const worker = new Worker(new URL("worker.js", import.meta.url), { type: "module", name });
  worker.onmessage = ({ data }) => {
    // A message of a worker that was ended meanwhile is nobody's.
    if (lanes[name] !== worker || !page || hasFailed) {
      return;
    }
    if (typeof data === "number") {
      page.jobProgress(name, data);
    } else {
      page.jobDone(name, data.done);
    }
  };
  worker.onerror = () => {
    if (lanes[name] === worker && page && !hasFailed) {
      page.jobDone(name, undefined);
    }
  };
  worker.postMessage({ entry: "jobs", module: compiled });
  lanes[name] = worker;
}

// ---- The window

// What the window asks of the page.
const host = {
  postDevice(bytes) {
    const request = bytes.slice();
    device.postMessage({ request }, [request.buffer]);
  },
  postJob(name, bytes) {
    const job = bytes.slice();
    lanes[name].postMessage({ job }, [job.buffer]);
  },
  restartLane: startLane,
  choose(extensions) {
    return new Promise((resolve) => {
      const input = document.createElement("input");
      input.type = "file";
      input.accept = extensions;
      input.addEventListener("cancel", () => resolve(null));
      input.addEventListener("change", async () => {
        const file = input.files[0];
        resolve(file ? [file.name, new Uint8Array(await file.arrayBuffer())] : null);
      });
      input.click();
    });
  },
  // The browser's own list: it opens because the user has just pressed something, and the user may close it again.
  async askForPort() {
    if (!navigator.serial || !hasSerial) {
      return "This browser lets no page use a board: Chrome, Edge and Firefox from 151 do, on pages by https or of this computer.";
    }
    try {
      const port = await navigator.serial.requestPort({ filters: FILTERS });
      const { usbVendorId, usbProductId } = port.getInfo();
      device.postMessage({ granted: [usbVendorId, usbProductId] });
    } catch (error) {
      if (error.name !== "NotFoundError") {
        return `The browser lets no board be chosen: ${error.message}`;
      }
    }
    return "";
  },
  address() {
    return location.href.split("#")[0];
  },
  save(name, bytes) {
    const address = URL.createObjectURL(new Blob([bytes.slice()]));
    const link = document.createElement("a");
    link.href = address;
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(address), 60_000);
  },
};

// A sentence in place of the window.
function fail(sentence) {
  hasFailed = true;
  line.textContent = "";
  loading.hidden = false;
  loading.style.display = "grid";
  progress.textContent = sentence;
}

// The window's own code has failed: nobody sees the device any more.
function windowFailed() {
  if (!hasFailed) {
    device.postMessage({ stop: true });
    hasFailed = true;
    line.textContent = "The window has failed and the drive was stopped. STOP still works; load the page again to resume.";
  }
}
window.addEventListener("error", windowFailed);
window.addEventListener("unhandledrejection", windowFailed);

// A module with one function, which makes a vector of 128 bits and counts its bits: `i8x16.popcnt(i8x16.splat(0))`.
const SIMD = new Uint8Array([
  0, 97, 115, 109, 1, 0, 0, 0, 1, 5, 1, 96, 0, 1, 123, 3, 2, 1, 0, 10, 10, 1, 8, 0, 65, 0, 253, 15, 253, 98, 11,
]);

// What the browser lacks, if anything.
function lacking() {
  if (typeof WebAssembly !== "object") {
    return "WebAssembly";
  }
  // Letters are painted, and fields computed, by it.
  if (!WebAssembly.validate(SIMD)) {
    return "SIMD of WebAssembly";
  }
  // The window gets this context when it asks for one. It smooths its edges itself, and nothing shines through it: to have the
  // browser do the same again takes software graphics several times as long for each picture.
  if (!canvas.getContext("webgl2", { alpha: false, antialias: false, depth: false, stencil: false })) {
    return "WebGL 2";
  }
  return hasModuleWorkers() ? null : "workers of modules";
}

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

// The WebAssembly's bytes, with the share that has arrived.
async function fetched(address, length) {
  const response = await fetch(address);
  if (!response.ok) {
    throw new Error(`${address}: ${response.status}`);
  }
  const bytes = new Uint8Array(length);
  let count = 0;
  const reader = response.body.getReader();
  for (;;) {
    const { done, value } = await reader.read();
    if (done) {
      break;
    }
    bytes.set(value, count);
    count += value.length;
    progress.textContent = `Loading: ${Math.floor((100 * count) / length)} %`;
  }
  return bytes;
}

async function open() {
  const missing = lacking();
  if (missing) {
    fail(`This browser has no ${missing}, which Slipline needs: a newer browser has it.`);
    return;
  }
  const length = Number(document.documentElement.dataset.length);
  const module = await WebAssembly.compile(await fetched(new URL("slipline_page_bg.wasm", import.meta.url), length));
  device.postMessage({ entry: "device", module });
  compiled = module;
  startLane("quick");
  startLane("long");
  await init({ module_or_path: module });
  page = await openPage(canvas, host, location.hash);
  // A build for tests reports where each control is.
  if (page.nodes) {
    window.slipline.nodes = () => (hasFailed ? [] : page.nodes());
  }
  for (const data of early.splice(0)) {
    page.deviceChanged(data.update, data.isLoud);
  }
  loading.style.display = "none";
  canvas.focus();
  window.addEventListener("hashchange", () => page.openFragment(location.hash));
  // After the first picture, for which there is enough to load.
  watchUpdates({ isArmed: () => deviceState?.armed === true, setup: () => (hasFailed ? null : page.fragment()) });
}

open().catch((error) => {
  console.error(error);
  fail("Slipline could not be opened in this browser.");
});

// ---- For tests

window.slipline = {
  // What is known of link, device and window.
  state() {
    const shown = page && !hasFailed ? page.state() : null;
    return { ...deviceState, ...(shown ? JSON.parse(shown) : {}), is_open: page !== null, has_failed: hasFailed };
  },
  fragment() {
    return page && !hasFailed ? page.fragment() : null;
  },
};
