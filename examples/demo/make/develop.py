"""From the renderer's linear light to what a camera would have saved."""

import numpy as np

EXPOSURE = 1.3
SHOT_NOISE, READ_NOISE = 0.00018, 0.0012  # variance per unit of light; standard deviation in the dark
VIGNETTE = 0.16


def develop(raw, seed):
    """`raw`: linear red, green, blue, then normal and albedo. Returns 8-bit sRGB."""
    light = denoise(raw.astype(np.float32))
    height, width = light.shape[:2]
    y, x = np.mgrid[0:height, 0:width]
    radius_squared = ((x - width / 2) ** 2 + (y - height / 2) ** 2) / ((width / 2) ** 2 + (height / 2) ** 2)
    light = light * EXPOSURE * (1.0 - VIGNETTE * radius_squared)[..., None]
    light = add_sensor_noise(light, np.random.default_rng(seed))
    return np.rint(np.clip(tone(light), 0.0, 1.0) * 255.0).astype(np.uint8)


def tone(light):
    """A shoulder as film has it, the sRGB curve, and a little contrast."""
    x = 1.0 - np.exp(-1.2 * np.maximum(light, 0.0))
    encoded = np.where(x <= 0.0031308, 12.92 * x, 1.055 * np.maximum(x, 1e-9) ** (1.0 / 2.4) - 0.055)
    return encoded + 0.28 * encoded * (1.0 - encoded) * (encoded - 0.42)


def add_sensor_noise(light, generator):
    noise = generator.standard_normal(light.shape).astype(np.float32)
    # Interpolated from a colour filter array, a sensor's noise is not independent from pixel to pixel.
    noise = 0.5 * noise + 0.25 * (np.roll(noise, 1, 0) + np.roll(noise, 1, 1))
    return light + noise * 1.6 * np.sqrt(SHOT_NOISE * np.maximum(light, 0.0) + READ_NOISE**2)


def denoise(raw):
    """Edge-avoiding à-trous wavelet filter (Dammertz et al. 2010) on the light that falls, guided by normal and albedo.

    The renderer takes few rays; what this leaves goes down in the sensor's noise.
    """
    photo, normal, albedo = raw[..., :3], raw[..., 3:6], raw[..., 6:9]
    floor = np.float32(0.06)
    light = without_fireflies(photo / (albedo + floor))
    # Where the lens blurs an edge, the guides are noisy too. They are scaled so that a distance of one is far.
    guides = np.concatenate([smoothed(normal, 1) / 0.22, smoothed(albedo, 1) / 0.11], axis=2).astype(np.float32)
    for step in (1, 2, 4):
        light = filtered(light, guides, step)
    return light * (albedo + floor)


def filtered(light, guides, step):
    """One pass of 5 x 5 taps, `step` pixels apart."""
    brightness = smoothed(np.log(light.mean(axis=2) + 0.02), step) / np.sqrt(0.035 / step)
    guides = np.concatenate([guides, brightness[..., None]], axis=2).astype(np.float32)
    total, weights = np.zeros_like(light), np.zeros(light.shape[:2], np.float32)
    padded_light, padded_guides = padded(light, 2 * step), padded(guides, 2 * step)
    height, width = light.shape[:2]
    for dy in range(5):
        for dx in range(5):
            kernel = np.float32((1, 4, 6, 4, 1)[dy] * (1, 4, 6, 4, 1)[dx] / 256.0)
            window = np.s_[dy * step : dy * step + height, dx * step : dx * step + width]
            difference = padded_guides[window] - guides
            weight = kernel * np.exp(-np.einsum("ijk,ijk->ij", difference, difference))
            total += weight[..., None] * padded_light[window]
            weights += weight
    return total / weights[..., None]


def padded(image, margin):
    return np.pad(image, ((margin, margin), (margin, margin), (0, 0)), mode="edge")


def without_fireflies(light):
    """No pixel may be brighter than its third-brightest neighbour by more than half."""
    brightness = light.mean(axis=2)
    neighbours = np.stack([shifted(brightness, dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if dy or dx])
    limit = 1.5 * np.sort(neighbours, axis=0)[-3] + 0.02
    return light * np.minimum(1.0, limit / np.maximum(brightness, 1e-6))[..., None]


def smoothed(image, step):
    rows = (shifted(image, -step, 0) + 2.0 * image + shifted(image, step, 0)) / 4.0
    return (shifted(rows, 0, -step) + 2.0 * rows + shifted(rows, 0, step)) / 4.0


def shifted(image, dy, dx):
    """The image as seen from a neighbour; the border repeats."""
    height, width = image.shape[:2]
    rows = np.clip(np.arange(height) + dy, 0, height - 1)
    columns = np.clip(np.arange(width) + dx, 0, width - 1)
    return image[rows][:, columns]
