// A browser's `navigator.serial` with one board, before the scripts of the page and of its workers: the board is the
// emulated one, behind the bridge of `board.py`, which says whether it is plugged in and whether the user has allowed it.

(() => {
  const BRIDGE = "ws://127.0.0.1:BRIDGE_PORT";

  class FakePort extends EventTarget {
    #socket = null;
    #incoming = null;
    #readable = null;
    connected = true;
    writable = null;

    getInfo() {
      return { usbVendorId: 0x0483, usbProductId: 0x374b };
    }

    async open({ baudRate }) {
      if (this.#socket) {
        throw new DOMException("The port is already open.", "InvalidStateError");
      }
      const socket = new WebSocket(`${BRIDGE}/line`);
      socket.binaryType = "arraybuffer";
      this.#socket = socket;
      // The bridge answers once the port is this one's; it hangs up if another one has it.
      const isOpen = await new Promise((resolve) => {
        socket.onmessage = () => resolve(baudRate === 921600);
        socket.onclose = () => resolve(false);
      });
      if (!isOpen) {
        this.#socket = null;
        throw new DOMException("Failed to open serial port.", "NetworkError");
      }
      socket.onmessage = ({ data }) => (typeof data === "string" ? this.#fail(data) : this.#receive(new Uint8Array(data)));
      socket.onclose = () => this.#fail("NetworkError");
      this.writable = new WritableStream({ write: (bytes) => socket.send(bytes) });
    }

    #receive(bytes) {
      // What comes while nobody reads waits for the next reader, as in the system's buffer.
      this.readable;
      this.#incoming.enqueue(bytes);
    }

    // An error of a receiver ends the reader; one of the network the port.
    #fail(name) {
      const isFatal = name === "NetworkError";
      this.readable;
      this.#incoming?.error(new DOMException(`A fake ${name}.`, name));
      this.#incoming = null;
      this.#readable = null;
      if (isFatal) {
        this.#socket = null;
      }
    }

    get readable() {
      if (this.#socket && !this.#readable) {
        this.#readable = new ReadableStream({
          start: (controller) => (this.#incoming = controller),
          cancel: () => (this.#readable = null),
        });
      }
      return this.#readable;
    }

    async close() {
      if (!this.#socket) {
        throw new DOMException("The port is not open.", "InvalidStateError");
      }
      const socket = this.#socket;
      this.#socket = null;
      this.#readable = null;
      await new Promise((resolve) => {
        socket.onclose = resolve;
        socket.close();
      });
    }
  }

  // A board that is equal to the other one in all that a browser tells, and whose port never opens.
  class SilentPort extends EventTarget {
    connected = true;

    getInfo() {
      return { usbVendorId: 0x0483, usbProductId: 0x374b };
    }

    open() {
      return new Promise(() => {});
    }
  }

  class FakeSerial extends EventTarget {
    #port = new FakePort();
    #twin = new SilentPort();
    #seen = { is_plugged: false, is_allowed: false };
    #events = new WebSocket(`${BRIDGE}/events`);
    #first;

    constructor() {
      super();
      this.#first = new Promise((resolve) => {
        this.#events.onmessage = ({ data }) => {
          const before = this.#seen;
          this.#seen = JSON.parse(data);
          resolve();
          if (this.#seen.is_allowed && this.#seen.is_plugged !== before.is_plugged) {
            this.#port.connected = this.#seen.is_plugged;
            this.dispatchEvent(new Event(this.#seen.is_plugged ? "connect" : "disconnect"));
          }
        };
      });
    }

    async getPorts() {
      await this.#first;
      const ports = this.#seen.has_twin ? [this.#port, this.#twin] : [this.#port];
      return this.#seen.is_allowed && this.#seen.is_plugged ? ports : [];
    }

    // The user chooses the board, or its twin. Only the page's thread may ask, right after a gesture.
    async requestPort({ filters }) {
      await this.#first;
      const { usbVendorId, usbProductId } = this.#port.getInfo();
      const fits = filters.some((one) => one.usbVendorId === usbVendorId && one.usbProductId === usbProductId);
      if (!navigator.userActivation?.isActive) {
        throw new DOMException("Must be handling a user gesture to show a permission request.", "SecurityError");
      }
      if (!fits || !this.#seen.is_plugged) {
        throw new DOMException("No port selected by the user.", "NotFoundError");
      }
      const allowed = new Promise((resolve) => {
        this.#events.addEventListener("message", () => this.#seen.is_allowed && resolve());
      });
      this.#events.send("allow");
      await allowed;
      return this.#seen.has_twin ? this.#twin : this.#port;
    }
  }

  // The watch over a page that is late has tests of its own. Here it is answered at once, or a computer with much to do
  // would end the drives that are looked at.
  if (self.WorkerGlobalScope) {
    const post = self.postMessage.bind(self);
    self.postMessage = (data, ...others) =>
      data.ask ? queueMicrotask(() => self.onmessage({ data: { sign: true } })) : post(data, ...others);
  }

  Object.defineProperty(navigator, "serial", { value: new FakeSerial(), configurable: true });
})();
