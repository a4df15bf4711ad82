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
  const canvas = document.createElement('canvas');
  Object.assign(canvas, { width, height });
  canvas.getContext('2d').drawImage(bitmap, 0, 0);
  bitmap.close();
  const png = await new Promise((resolve) => canvas.toBlob(resolve, 'image/png'));
  if (!png) throw new Error('the browser has not enough memory for this picture');
  return new Uint8Array(await png.arrayBuffer());
}
