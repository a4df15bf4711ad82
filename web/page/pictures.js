// Pictures of kinds that the browser reads and the program does not.

const TYPES = { 'JPEG XL': 'image/jxl', 'JPEG 2000': 'image/jp2' };

// The picture as the bytes of a PNG: upright, in sRGB, of an animation the first frame. Null where the browser does not read
// it either.
export async function pngOf(kind, bytes, mostPixels) {
  const type = TYPES[kind] ?? `image/${kind.toLowerCase()}`;
  let bitmap;
  try {
    bitmap = await createImageBitmap(new Blob([bytes], { type }));
  } catch {
    return null;
  }
  const { width, height } = bitmap;
  if (width * height > mostPixels) {
    bitmap.close();
    throw new Error(`the photo has ${width}×${height} pixels, more than ${mostPixels / 1e6} million`);
  }
  const png = await drawn(width, height, (context) => context.drawImage(bitmap, 0, 0));
  bitmap.close();
  return png;
}

// A drawing as the bytes of a PNG, so many pixels for each of its units.
export async function pngOfSvg(text, scale) {
  const url = URL.createObjectURL(new Blob([text], { type: 'image/svg+xml' }));
  try {
    const image = new Image();
    image.src = url;
    await image.decode();
    const [width, height] = [image.width, image.height].map((side) => Math.ceil(side * scale));
    return await drawn(width, height, (context) => context.drawImage(image, 0, 0, width, height));
  } finally {
    URL.revokeObjectURL(url);
  }
}

// Opens a page that is in memory alone in a tab of its own; false where the browser does not let it.
export function showPage(html) {
  const url = URL.createObjectURL(new Blob([html], { type: 'text/html' }));
  // It stays: a reload of that tab asks for it again.
  return Boolean(window.open(url, '_blank'));
}

async function drawn(width, height, draw) {
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width, height });
  draw(canvas.getContext('2d'));
  const png = await new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
  if (!png) throw new Error('the browser has not enough memory for this picture');
  return new Uint8Array(await png.arrayBuffer());
}
