// The window as elements below its canvas, where a browser shows them to screen readers and to nobody else: eframe draws
// pixels. An element is pressed as its control is.

const canvas = document.getElementById("window");
const spoken = document.getElementById("spoken");

// Roles of egui's nodes as those of ARIA. A node of another role is text.
const ROLES = {
  Button: "button", ComboBox: "button", ColorWell: "button", Tab: "button", MenuItem: "button", Link: "link",
  CheckBox: "checkbox", RadioButton: "radio", Switch: "switch",
  TextInput: "textbox", MultilineTextInput: "textbox", Slider: "slider", SpinButton: "spinbutton",
  ProgressIndicator: "progressbar", Image: "img",
};
const TOGGLED = ["checkbox", "radio", "switch"];
const NUMBERED = ["slider", "spinbutton", "progressbar"];

// By the ids of their nodes.
let elements = new Map();
// What was to be said at the latest look.
let latest = "";

// Shows these nodes; `press` gets the id of the one that is pressed.
export function mirror(nodes, press) {
  const kept = new Map();
  let focused = null;
  for (const node of nodes) {
    const element = elements.get(node.id) ?? made(node.id, press);
    if (show(element, node)) {
      kept.set(node.id, element);
      focused = node.is_focused ? element.id : focused;
    }
  }
  const shown = [...kept.values()];
  if (shown.length !== canvas.children.length || shown.some((element, at) => canvas.children[at] !== element)) {
    canvas.replaceChildren(...shown);
  }
  elements = kept;
  // The keys go to the canvas, or to eframe's field for text.
  for (const receiver of [canvas, field()]) {
    if (focused) {
      receiver?.setAttribute("aria-activedescendant", focused);
    } else {
      receiver?.removeAttribute("aria-activedescendant");
    }
  }
}

function made(id, press) {
  const element = document.createElement("div");
  element.id = `node-${id}`;
  element.addEventListener("click", () => press(id));
  return element;
}

// Gives an element what its node has; returns whether there is anything to read.
function show(element, { role: kind, label, value, number, is_disabled, is_toggled }) {
  const role = ROLES[kind] ?? null;
  const text = role ? label || value : [label, value].filter(Boolean).join(": ");
  if (!text) {
    return false;
  }
  const isNumbered = NUMBERED.includes(role);
  set(element, "role", role);
  set(element, "aria-label", role && text);
  set(element, "aria-disabled", is_disabled ? "true" : null);
  set(element, "aria-checked", TOGGLED.includes(role) ? String(is_toggled === true) : null);
  set(element, "aria-pressed", role === "button" && is_toggled !== undefined ? String(is_toggled) : null);
  set(element, "aria-valuenow", isNumbered ? String(number ?? 0) : null);
  set(element, "aria-valuetext", isNumbered ? value : null);
  const content = role === "textbox" ? value ?? "" : role ? "" : text;
  if (element.textContent !== content) {
    element.textContent = content;
  }
  return true;
}

function set(element, name, value) {
  if (value === null || value === undefined) {
    element.removeAttribute(name);
  } else if (element.getAttribute(name) !== value) {
    element.setAttribute(name, value);
  }
}

// eframe's field, to which the keys go.
function field() {
  return document.querySelector("input[type=text]");
}

// Names that field, which eframe leaves without one.
export function nameField() {
  field()?.setAttribute("aria-label", "Keys for the window");
}

const STATES = {
  Idle: "Disarmed", Armed: "Armed, at rest", Waiting: "Waiting for the trigger", Driving: "Driving",
  Stopping: "Stopping", Fault: "Fault",
};

// The state of the device, for the page's title, too.
export function inWords(link, deviceState) {
  return link === "connected" ? STATES[deviceState] ?? deviceState : `The device is ${link}`;
}

// Has a screen reader say what changed, once it has settled: a line that is dragged is said where it stays.
export function say({ device_state, link, felt_edge_m, turning_point_m, notice }) {
  const state = inWords(link, device_state);
  const [name, place_m] = felt_edge_m === null ? ["The turning point", turning_point_m] : ["The felt edge", felt_edge_m];
  const edge = place_m === undefined ? "" : `${name} is at ${(1e3 * place_m).toFixed(1)} mm.`;
  const text = [`${state}.`, edge, notice ?? ""].join(" ").trim();
  if (text === latest && spoken.textContent !== text) {
    spoken.textContent = text;
  }
  latest = text;
}
