// New versions of the page: found by its service worker, offered by a button, used when the button is pressed and never while
// the device is armed. Without service workers (http on another host, some private windows) the page is as it is loaded.

const offer = document.getElementById("offer");
// Of which build this page is.
const version = document.documentElement.dataset.version;
// How often a page that stays open asks, in milliseconds.
const EVERY_MS = 3_600_000;

// What the page answers: whether the device is armed, and the setup for an address or null.
let isArmed = () => false;
let setup = () => null;
// The worker of another build than this page's, if there is one.
let newer = null;

// Shows the offer, or hides it while the device is armed; to be called when that changes.
export function showOffer() {
  offer.hidden = newer === null || isArmed();
}

// Begins to look for new versions.
export function watchUpdates(asked) {
  ({ isArmed, setup } = asked);
  if (version && navigator.serviceWorker) {
    begin().catch((error) => console.info("New versions are not found, and there is no page without a network:", error));
  }
}

async function begin() {
  const workers = navigator.serviceWorker;
  // Which of the pages of several builds is this one?
  workers.onmessage = ({ data, ports }) => {
    if (data === "version") {
      ports[0].postMessage(version);
    }
  };
  // What is asked for new versions must be the server's, not the browser's copy.
  const registration = await workers.register("sw.js", { updateViaCache: "none" });
  const look = () => found(registration).catch(console.info);
  const watch = (worker) => worker?.addEventListener("statechange", look);
  registration.addEventListener("updatefound", () => watch(registration.installing));
  // Another page may have begun to use the new version.
  workers.addEventListener("controllerchange", look);
  watch(registration.installing);
  await look();
  const ask = () => registration.update().catch(() => {});
  setInterval(ask, EVERY_MS);
  document.addEventListener("visibilitychange", () => document.hidden || ask());
}

async function found(registration) {
  const worker = registration.waiting ?? registration.active;
  if (!worker) {
    return;
  }
  if ((await versionOf(worker)) !== version) {
    newer = worker;
  } else {
    newer = null;
    // This page is of the newest build: that changes no page which is open, and offline it is this one that opens.
    worker.postMessage(worker.state === "installed" ? "use" : "opened");
  }
  showOffer();
}

function versionOf(worker) {
  return new Promise((resolve) => {
    const { port1, port2 } = new MessageChannel();
    port1.onmessage = ({ data }) => resolve(data);
    worker.postMessage("version", [port2]);
  });
}

function load() {
  if (newer === null || isArmed()) {
    return;
  }
  const worker = newer;
  const isUsed = () => ["activated", "redundant"].includes(worker.state);
  const reload = () => {
    // It may have been armed meanwhile; then the offer comes back when it is not.
    if (!isUsed() || isArmed()) {
      return;
    }
    const fragment = setup();
    if (fragment) {
      // The setup is restored.
      history.replaceState(null, "", `#${fragment}`);
    }
    location.reload();
  };
  worker.addEventListener("statechange", reload);
  if (!isUsed()) {
    worker.postMessage("use");
  }
  reload();
}

offer.addEventListener("click", load);
