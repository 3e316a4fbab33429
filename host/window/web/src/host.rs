//! What the page's script does for the window: messages to the workers, files, the address.

use js_sys::Promise;
use wasm_bindgen::prelude::wasm_bindgen;

#[wasm_bindgen]
extern "C" {
    /// An object of the page's script.
    pub type Host;

    /// Sends a message to the device worker.
    #[wasm_bindgen(method, js_name = postDevice)]
    pub(crate) fn post_device(this: &Host, bytes: &[u8]);

    /// Sends a job to a worker of this name.
    #[wasm_bindgen(method, js_name = postJob)]
    pub(crate) fn post_job(this: &Host, lane: &str, bytes: &[u8]);

    /// Ends the worker of this name even if it is busy, and starts another one.
    #[wasm_bindgen(method, js_name = restartLane)]
    pub(crate) fn restart_lane(this: &Host, lane: &str);

    /// Has the user choose a file with one of these extensions, each with its dot and separated by commas; an empty
    /// list means any file. Resolves with an array of name and bytes, or with null.
    #[wasm_bindgen(method)]
    pub(crate) fn choose(this: &Host, extensions: &str) -> Promise;

    /// Has the user choose a board, which the device worker then lists. Resolves with a sentence if that cannot be, or
    /// with an empty one.
    #[wasm_bindgen(method, js_name = askForPort)]
    pub(crate) fn ask_for_port(this: &Host) -> Promise;

    /// The address of the page without its fragment.
    #[wasm_bindgen(method)]
    pub(crate) fn address(this: &Host) -> String;

    /// Whether the page is a frame of another page: `?embed`.
    #[wasm_bindgen(method, js_name = isFrame)]
    pub(crate) fn is_frame(this: &Host) -> bool;

    /// Whether the user has asked the system for less motion.
    #[wasm_bindgen(method, js_name = isStill)]
    pub(crate) fn is_still(this: &Host) -> bool;

    /// Copies a text. Resolves with whether that was possible.
    #[wasm_bindgen(method)]
    pub(crate) fn copy(this: &Host, text: &str) -> Promise;

    /// Has the browser save a file.
    #[wasm_bindgen(method)]
    pub(crate) fn save(this: &Host, name: &str, bytes: &[u8]);
}
