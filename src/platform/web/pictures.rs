//! Pictures that the browser reads and this program does not.

use js_sys::Uint8Array;
use wasm_bindgen::prelude::*;

use super::describe;

#[wasm_bindgen(module = "/web/page/pictures.js")]
extern "C" {
    #[wasm_bindgen(js_name = pngOf, catch)]
    async fn page_png_of(kind: &str, bytes: &Uint8Array, most_pixels: f64) -> Result<JsValue, JsValue>;
}

/// A picture of a kind, say "AVIF", as the bytes of a PNG; `None` where the browser does not read it.
pub async fn png_of_foreign(kind: &str, bytes: &[u8], most_pixels: u64) -> Result<Option<Vec<u8>>, String> {
    let png = page_png_of(kind, &Uint8Array::from(bytes), most_pixels as f64).await;
    let png = png.map_err(|error| describe(&error))?;
    Ok(png.dyn_ref::<Uint8Array>().map(Uint8Array::to_vec))
}
