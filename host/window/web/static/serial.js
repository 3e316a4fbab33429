// Boards by Web Serial. The page's thread asks the user; the device worker has the ports, and reports to the link what
// becomes of them.

// Slipline's own USB, and the ST-LINK of ST's boards, behind which their UART is.
export const FILTERS = [
  { usbVendorId: 0x1209, usbProductId: 0x0001 },
  ...[0x374b, 0x374e, 0x374f, 0x3753].map((usbProductId) => ({ usbVendorId: 0x0483, usbProductId })),
];

// A receive buffer for some tenths of a second, in which a worker may be late.
const OPTIONS = { baudRate: 921600, bufferSize: 32768 };

// How long a browser may take to open a port.
const OPENING_MS = 10_000;

function silence() {
  const error = new DOMException("The browser does not answer: unplug the board and plug it in again.", "TimeoutError");
  return new Promise((_, fail) => setTimeout(fail, OPENING_MS, error));
}

// These end a reader and not the port: another reader goes on, and what was damaged is sent again.
const PASSING = ["BreakError", "BufferOverrunError", "FramingError", "ParityError"];

export class SerialGlue {
  #serial;
  #tell;
  // The browser's ports by the ids that the link knows.
  #ports = new Map();
  #ids = 0;
  #lines = new Map();

  // `tell` gets the name of a method of the device worker and its arguments; it is not called before a call of this
  // object has returned.
  constructor(serial, tell) {
    this.#serial = serial;
    this.#tell = tell;
    for (const event of ["connect", "disconnect"]) {
      serial?.addEventListener(event, () => this.look());
    }
  }

  // Tells which boards there are.
  async look() {
    // A server may forbid its pages to use ports: then there are none.
    const ports = this.#serial ? await this.#serial.getPorts().catch(() => []) : [];
    const boards = [];
    for (const port of ports) {
      const { usbVendorId, usbProductId } = port.getInfo();
      if (usbVendorId === undefined || port.connected === false) {
        continue;
      }
      let id = [...this.#ports].find(([, known]) => known === port)?.[0];
      if (id === undefined) {
        id = ++this.#ids;
        this.#ports.set(id, port);
      }
      boards.push(id, usbVendorId, usbProductId);
    }
    this.#tell("boardsListed", new Uint32Array(boards));
    return ports;
  }

  // The user has chosen the port at this place of the browser's list: a new one, or one that was chosen before.
  async granted(place) {
    const port = (await this.look())[place];
    const id = [...this.#ports].find(([, known]) => known === port)?.[0];
    if (id !== undefined) {
      this.#tell("boardChosen", id);
    }
  }

  open(line, id) {
    const entry = { port: this.#ports.get(id), isClosed: false };
    const before = [...this.#lines.values()].filter(({ port }) => port === entry.port).map(({ ended }) => ended);
    this.#lines.set(line, entry);
    entry.ended = Promise.all(before)
      .then(() => this.#use(line, entry))
      .finally(() => this.#lines.delete(line));
  }

  write(line, bytes) {
    const written = this.#lines.get(line)?.writer?.write(bytes.slice());
    written?.then(() => this.#tell("boardWritten", line), (error) => this.#end(line, error));
  }

  close(line) {
    const entry = this.#lines.get(line);
    if (entry) {
      entry.isClosed = true;
      entry.reader?.cancel().catch(() => {});
    }
  }

  #end(line, error) {
    this.#tell("boardEnded", line, error.name, error.message);
  }

  // From the opening of a port to its closing.
  async #use(line, entry) {
    const { port } = entry;
    if (entry.isClosed) {
      return;
    }
    const opening = port.open(OPTIONS);
    try {
      await Promise.race([opening, silence()]);
    } catch (error) {
      this.#end(line, error);
      // It may yet open: then nobody wants it any more.
      opening.then(() => port.close()).catch(() => {});
      return;
    }
    try {
      entry.writer = port.writable.getWriter();
      this.#tell("boardOpened", line);
      await this.#read(line, entry);
    } catch (error) {
      this.#end(line, error);
    }
    await entry.writer?.abort().catch(() => {});
    entry.writer?.releaseLock();
    await port.close().catch(() => {});
  }

  // Reads until the line is closed or the port has failed.
  async #read(line, entry) {
    let failure = new DOMException("The port was closed.", "NetworkError");
    while (entry.port.readable && !entry.isClosed) {
      const reader = entry.port.readable.getReader();
      entry.reader = reader;
      try {
        for (;;) {
          const { done, value } = await reader.read();
          if (done) {
            break;
          }
          this.#tell("boardReceived", line, value);
        }
      } catch (error) {
        failure = error;
        if (!PASSING.includes(error.name)) {
          break;
        }
      } finally {
        reader.releaseLock();
      }
    }
    if (!entry.isClosed) {
      throw failure;
    }
  }
}
