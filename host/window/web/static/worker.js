// A worker of the page. Its first message names its entry; later ones are the entry's own.

import { SerialGlue } from "./serial.js";
import init, { DeviceWorker, JobWorker } from "./slipline_page.js";

// Messages that arrive before the WebAssembly runs wait for it, in their order.
let ready;

self.onmessage = ({ data }) => {
  if (data.entry) {
    ready = start(data).catch((error) => {
      self.postMessage({ failed: String(error) });
      throw error;
    });
    return;
  }
  // Before there is a device there is nothing to stop.
  ready?.then((entry) => entry(data));
};

async function start({ entry, module }) {
  await init({ module_or_path: module });
  return { device, jobs }[entry]();
}

// Work that takes longer than a picture.
function jobs() {
  const worker = new JobWorker();
  return ({ job }) => {
    try {
      const done = worker.run(job);
      self.postMessage(done ? { done } : { failed: "no job" }, done ? [done.buffer] : []);
    } catch (error) {
      self.postMessage({ failed: String(error) });
    }
  };
}

// The link, the simulated device and the boards by USB.
function device() {
  const origin = performance.timeOrigin;
  const hasSerial = navigator.serial !== undefined;
  const publish = (update, isLoud, state) =>
    self.postMessage({ update, isLoud, state, origin, hasSerial }, [update.buffer]);
  const ask = () => self.postMessage({ ask: true });
  const nonce = crypto.getRandomValues(new Uint32Array(1))[0];
  const glue = new SerialGlue(navigator.serial, (event, ...values) => {
    if (!hasFailed) {
      worker[event](...values);
      step();
    }
  });
  const worker = new DeviceWorker(publish, ask, glue, nonce);
  let timer;
  let hasFailed = false;
  const step = () => {
    clearTimeout(timer);
    try {
      const after = worker.step();
      if (Number.isFinite(after)) {
        timer = setTimeout(step, Math.max(0, Math.ceil(after)));
      }
    } catch (error) {
      hasFailed = true;
      self.postMessage({ failed: String(error) });
    }
  };
  glue.look();
  return (data) => {
    if (hasFailed) {
      return;
    }
    if (data.granted !== undefined) {
      glue.granted(data.granted);
    } else if (data.request) {
      worker.take(data.request);
    } else if (data.stop) {
      worker.stop();
    } else if (data.leave) {
      worker.leave(data.leave);
    } else if (data.sign) {
      worker.sign();
    }
    step();
  };
}
