//! Pictures and pages that the browser makes sense of for this program.

use js_sys::Uint8Array;
use wasm_bindgen::prelude::*;

use super::describe;

#[wasm_bindgen(module = "/web/page/pictures.js")]
extern "C" {
    #[wasm_bindgen(js_name = pngOf, catch)]
    async fn page_png_of(kind: &str, bytes: &Uint8Array, most_pixels: f64) -> Result<JsValue, JsValue>;
    #[wasm_bindgen(js_name = pngOfSvg, catch)]
    async fn page_png_of_svg(text: &str, scale: f64) -> Result<JsValue, JsValue>;
    #[wasm_bindgen(js_name = showPage, catch)]
    fn page_show_page(html: &str) -> Result<JsValue, JsValue>;
}

/// A picture of a kind, say "AVIF", as the bytes of a PNG; `None` where the browser does not read it.
pub async fn png_of_foreign(kind: &str, bytes: &[u8], most_pixels: u64) -> Result<Option<Vec<u8>>, String> {
    let png = page_png_of(kind, &Uint8Array::from(bytes), most_pixels as f64).await;
    let png = png.map_err(|error| describe(&error))?;
    Ok(png.dyn_ref::<Uint8Array>().map(Uint8Array::to_vec))
}

/// A drawing as the bytes of a PNG file, so many pixels for each of its units.
pub async fn png_of_svg(text: String, scale: f64) -> Result<Vec<u8>, String> {
    let png = page_png_of_svg(&text, scale).await.map_err(|error| describe(&error))?;
    png.dyn_ref::<Uint8Array>().map(Uint8Array::to_vec).ok_or_else(|| "no picture came".to_owned())
}

/// Opens a page that is in memory alone in a tab of its own. Must be called soon after a click or a key.
pub fn show_page(html: &str) -> Result<(), String> {
    let opened = page_show_page(html).map_err(|error| describe(&error))?;
    match opened.is_truthy() {
        true => Ok(()),
        false => Err("the browser did not let a new tab open; download the page instead".to_owned()),
    }
}
