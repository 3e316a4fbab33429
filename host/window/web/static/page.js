// The page: it starts the device worker and the window, and has what must work without the window: STOP.
//
//   STOP button, Esc, Space --> device worker      past the window, which may have failed, be busy or not be there yet
//   window (WebAssembly)    --> device worker      requests
//   device worker           --> window             what is new
//
// The browser gives no script the keys and the pointer while this thread is stuck. Then the device worker, whose
// questions are not answered, stops and disarms the device.

import { isOwn, lacking, whyNotLoaded } from "./failure.js";
import { inWords, mirror, nameField, say } from "./mirror.js";
import { FILTERS } from "./serial.js";
import init, { openPage } from "./slipline_page.js";
import { showOffer, watchUpdates } from "./updates.js";

// How often what stands outside the canvas is compared with what it shows: browsers refuse more than a few addresses a second.
const LOOK_MS = 1000;

// Whether the page is a frame of another page, such as a paper's: plate and line alone, and nothing of the visit is kept.
const isFrame = new URLSearchParams(location.search).has("embed");

const canvas = document.getElementById("window");
const line = document.getElementById("line");
const loading = document.getElementById("loading");
const progress = document.getElementById("progress");
const again = document.getElementById("again");

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
  }
}, { capture: true });

// Space is STOP everywhere, and no press of a button.
for (const button of document.querySelectorAll("button")) {
  for (const kind of ["keydown", "keyup"]) {
    button.addEventListener(kind, (event) => event.key === " " && event.preventDefault());
  }
}

// A way out of the canvas, which has the key Tab for its own controls, and back to it.
window.addEventListener("keydown", (event) => {
  if (event.key === "F6") {
    event.preventDefault();
    event.stopImmediatePropagation();
    (windowHasFocus() || hasFailed ? document.getElementById("stop") : canvas).focus();
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
    // Behind a window that has failed nobody sees the device: the watch may stop and disarm it.
    if (!hasFailed) {
      device.postMessage({ sign: true });
    }
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
    if (hasFailed) {
      return;
    }
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
    if (!isSecureContext) {
      return "A browser lets no page without https use a board: open this page by https, or from this computer.";
    }
    if (!navigator.serial || !hasSerial) {
      return "This browser lets no page use a board: Chrome, Edge and Firefox from 151 do.";
    }
    try {
      const port = await navigator.serial.requestPort({ filters: FILTERS });
      // The worker has the browser's ports in the same order, but not these objects: boards may be equal in all else.
      const ports = await navigator.serial.getPorts();
      device.postMessage({ granted: Math.max(0, ports.indexOf(port)) });
    } catch (error) {
      if (error.name !== "NotFoundError") {
        console.error(error);
        return error.name === "SecurityError"
          ? "This page may use no board: its server's Permissions-Policy or the browser's settings forbid it."
          : "The browser showed no list of boards: load the page again.";
      }
    }
    return "";
  },
  address() {
    return location.href.split("#")[0];
  },
  isFrame: () => isFrame,
  isStill() {
    return matchMedia("(prefers-reduced-motion: reduce)").matches;
  },
  // Whether the text was copied. Without https a page has no clipboard, but the event of a copy.
  async copy(text) {
    try {
      await navigator.clipboard.writeText(text);
      return true;
    } catch {
      return copyByEvent(text);
    }
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

function copyByEvent(text) {
  let isCopied = false;
  const write = (event) => {
    event.clipboardData.setData("text/plain", text);
    event.preventDefault();
    event.stopImmediatePropagation();
    isCopied = true;
  };
  document.addEventListener("copy", write, { capture: true });
  const isDone = document.execCommand("copy");
  document.removeEventListener("copy", write, { capture: true });
  return isDone && isCopied;
}

// ---- Failures

// A sentence in place of the window, whose picture is out of date. From now on nothing but STOP is sent, and no watch is answered.
function fail(sentence) {
  hasFailed = true;
  document.title = "Slipline has failed";
  line.textContent = "";
  loading.hidden = false;
  loading.style.display = "grid";
  progress.textContent = sentence;
  again.hidden = page === null;
  canvas.blur();
}

// Nobody sees the device any more.
function windowFailed(reason) {
  if (!hasFailed) {
    device.postMessage({ leave: reason });
    // After a failure of the window's own code there may be no setup; then the address has the latest one.
    try {
      showSetup();
    } catch {}
    fail(`${reason}: the device was stopped and disarmed. STOP still works.`);
    again.focus();
  }
}
window.addEventListener("error", ({ error, filename }) => isOwn(error, filename) && windowFailed("The window has failed"));
window.addEventListener("unhandledrejection", ({ reason }) => isOwn(reason) && windowFailed("The window has failed"));
// The graphics processor was reset, or the browser's process for it died. The window would draw nothing any more.
canvas.addEventListener("webglcontextlost", () => windowFailed("The graphics were lost"));
again.addEventListener("click", () => location.reload());

// ---- What stands outside the canvas

function look() {
  showSetup();
  // It lies on the window's own STOP.
  document.getElementById("stop").style.zoom = page.zoom();
  const nodes = page.newNodes();
  if (nodes) {
    mirror(nodes, (id) => hasFailed || page.press(id));
  }
  const state = window.slipline.state();
  say(state);
  // What a tab, a list of windows and a task bar show of a page that is behind others.
  document.title = `${inWords(state.link, state.device_state)} - Slipline`;
}

// Keeps the setup on the screen in the address, so that loading the page again and a copy of the address show it.
function showSetup() {
  const fragment = page?.fragment();
  if (fragment && `#${fragment}` !== location.hash) {
    // The state says that this page wrote it: another one's link has none.
    history.replaceState({ isOwn: true }, "", `#${fragment}`);
  }
}

// The WebAssembly, compiled while it arrives, with the share that has arrived.
async function compiledFrom(address, length) {
  const response = await fetch(address);
  if (!response.ok) {
    throw new Error(`${address}: ${response.status}`);
  }
  let count = 0;
  const counted = new TransformStream({
    transform(bytes, controller) {
      count += bytes.length;
      progress.textContent = `Loading: ${Math.floor((100 * count) / length)} %`;
      controller.enqueue(bytes);
    },
  });
  // A server may know no type for it.
  const headers = { "Content-Type": "application/wasm" };
  return WebAssembly.compileStreaming(new Response(response.body.pipeThrough(counted), { headers }));
}

// A frame takes no focus from the page around it, as eframe's field for text would when it is made. Returns what ends that.
function withoutFocus(isWanted) {
  const { focus } = HTMLElement.prototype;
  if (isWanted) {
    HTMLElement.prototype.focus = () => {};
  }
  return () => {
    HTMLElement.prototype.focus = focus;
  };
}

// Marks when the first picture was drawn, for the browser's own view of how a page loads, and for tests.
function markFirstPicture() {
  if (window.slipline.state().frames > 0) {
    performance.mark("slipline: first picture");
  } else if (!hasFailed) {
    requestAnimationFrame(markFirstPicture);
  }
}

async function open() {
  const missing = lacking(canvas);
  if (missing) {
    fail(missing);
    return;
  }
  const length = Number(document.documentElement.dataset.length);
  const module = await compiledFrom(new URL("slipline_page_bg.wasm", import.meta.url), length);
  device.postMessage({ entry: "device", module });
  compiled = module;
  startLane("quick");
  startLane("long");
  await init({ module_or_path: module });
  const focused = withoutFocus(isFrame);
  page = await openPage(canvas, host, location.hash, history.state?.isOwn === true);
  focused();
  // A build for tests reports where each control is.
  if (page.nodes) {
    window.slipline.nodes = () => (hasFailed ? [] : page.nodes());
  }
  for (const data of early.splice(0)) {
    page.deviceChanged(data.update, data.isLoud);
  }
  loading.style.display = "none";
  markFirstPicture();
  if (!isFrame) {
    canvas.focus();
  }
  window.addEventListener("hashchange", () => hasFailed || page.openFragment(location.hash));
  nameField();
  setInterval(() => hasFailed || look(), LOOK_MS);
  // After the first picture, for which there is enough to load.
  if (!isFrame) {
    watchUpdates({
      isArmed: () => deviceState?.armed === true,
      setup: () => (hasFailed ? null : page.fragment()),
    });
  }
}

open().catch((error) => {
  console.error(error);
  fail(whyNotLoaded(error));
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
