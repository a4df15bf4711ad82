"""Draws the printed things: the tin's label (a texture of the data set), and a page of text for the clutter.

Usage: label.py OUT_FOLDER. Pillow's built-in font only.
"""

import random
import sys
from pathlib import Path

from PIL import Image, ImageDraw, ImageFilter, ImageFont

# Width: once around the tin. The lower three quarters wrap the side, the upper quarter holds the lid's top.
SIZE = (1024, 704)
WRAP_TOP = SIZE[1] // 4
CREAM, GREEN, DARK, GOLD, RED = (236, 228, 205), (38, 84, 66), (28, 36, 34), (186, 154, 96), (176, 58, 44)


def font(size):
    return ImageFont.load_default(size)


def centred(draw, centre, text, size, fill):
    draw.text(centre, text, font=font(size), fill=fill, anchor="mm")


def leaf(draw, x, y, length, angle_sign, fill):
    points = []
    for i in range(21):
        t = i / 20
        points.append((x + angle_sign * length * t, y - length * 0.55 * t + length * 0.9 * t * (t - 1)))
    for i in range(20, -1, -1):
        t = i / 20
        points.append((x + angle_sign * length * t, y - length * 0.55 * t - length * 0.15 * t * (t - 1)))
    draw.polygon(points, fill=fill)


def panel_front(draw, centre_x, top, bottom):
    """The big side: a name, a sprig, a medallion."""
    draw.rectangle((centre_x - 132, top + 120, centre_x + 132, bottom - 22), fill=CREAM)
    draw.rectangle((centre_x - 124, top + 128, centre_x + 124, bottom - 30), outline=GOLD, width=3)
    centred(draw, (centre_x, top + 158), "HIGH MEADOW", 29, DARK)
    centred(draw, (centre_x, top + 214), "TEA", 76, GREEN)
    for sign in (-1, 1):
        for k in range(4):
            leaf(draw, centre_x + sign * 4, top + 330 - 16 * k, 52 - 8 * k, sign, GREEN if k % 2 else (74, 128, 84))
    draw.line((centre_x, top + 262, centre_x, top + 345), fill=DARK, width=3)
    draw.ellipse((centre_x - 34, top + 352, centre_x + 34, top + 420), fill=RED)
    centred(draw, (centre_x, top + 386), "7", 54, CREAM)
    centred(draw, (centre_x, bottom - 80), "LOOSE LEAF", 26, DARK)
    centred(draw, (centre_x, bottom - 52), "125 g", 24, DARK)


def panel_side(draw, centre_x, top, bottom, lines):
    draw.rectangle((centre_x - 88, top + 136, centre_x + 88, bottom - 40), fill=(226, 214, 184))
    centred(draw, (centre_x, top + 166), lines[0], 23, RED)
    for k, line in enumerate(lines[1:]):
        centred(draw, (centre_x, top + 206 + 30 * k), line, 20, DARK)
    for k in range(26):
        x = centre_x - 60 + 4.6 * k
        draw.rectangle((x, bottom - 110, x + 1 + (k * 7 % 3), bottom - 60), fill=DARK)


def tin_label():
    image = Image.new("RGB", SIZE, GREEN)
    draw = ImageDraw.Draw(image)
    width, height = SIZE
    generator = random.Random(7)
    for _ in range(240):
        x, y = generator.uniform(0, width), generator.uniform(WRAP_TOP, height)
        leaf(
            draw,
            x,
            y,
            generator.uniform(10, 24),
            generator.choice((-1, 1)),
            (30, 70, 55) if generator.random() < 0.6 else (52, 102, 80),
        )
    # The lid's side: gold, with a line of ticks.
    lid = WRAP_TOP + int((height - WRAP_TOP) * 26 / 128)
    draw.rectangle((0, WRAP_TOP, width, lid), fill=GOLD)
    draw.rectangle((0, lid - 26, width, lid - 18), fill=GREEN)
    draw.rectangle((0, height - 16, width, height), fill=GOLD)
    panel_front(draw, width // 2, WRAP_TOP, height)
    draw.rectangle((0, lid + 26, 130, height - 40), fill=CREAM)
    draw.rectangle((width - 130, lid + 26, width, height - 40), fill=CREAM)
    half_back(image, lid)
    panel_side(
        draw,
        width // 4,
        WRAP_TOP,
        height,
        ["HOW TO BREW", "one spoon a cup", "water at 95 °C", "wait 3 minutes", "add nothing"],
    )
    panel_side(
        draw,
        width * 3 // 4,
        WRAP_TOP,
        height,
        ["CONTENTS", "black tea 70 %", "mint 20 %", "cornflower 8 %", "patience 2 %"],
    )
    lid_top(draw)
    return image


def half_back(image, lid):
    """The back is where the wrap closes: drawn apart and cut in two."""
    back = Image.new("RGB", (260, SIZE[1] - 40 - lid - 26), CREAM)
    draw = ImageDraw.Draw(back)
    draw.rectangle((8, 8, 252, back.height - 8), outline=GOLD, width=3)
    peaks = [(20, 190), (70, 90), (100, 140), (150, 50), (210, 150), (240, 190)]
    draw.polygon(peaks, fill=(90, 120, 128))
    draw.polygon([(135, 76), (150, 50), (167, 78), (152, 86)], fill=CREAM)
    draw.ellipse((28, 30, 72, 74), fill=GOLD)
    draw.rectangle((20, 190, 240, 214), fill=GREEN)
    centred(draw, (130, 240), "from 1,900 m", 26, DARK)
    centred(draw, (130, 272), "KEEP DRY", 22, RED)
    image.paste(back.crop((130, 0, 260, back.height)), (0, lid + 26))
    image.paste(back.crop((0, 0, 130, back.height)), (SIZE[0] - 130, lid + 26))


def lid_top(draw):
    left, right, top, bottom = 0.02 * SIZE[0], 0.32 * SIZE[0], 0.02 * SIZE[1], 0.23 * SIZE[1]
    draw.rectangle((0, 0, SIZE[0], WRAP_TOP - 1), fill=GOLD)
    centre = ((left + right) / 2, (top + bottom) / 2)
    draw.ellipse((centre[0] - 84, centre[1] - 52, centre[0] + 84, centre[1] + 52), fill=GREEN)
    centred(draw, (centre[0], centre[1] - 12), "TEA", 46, CREAM)
    centred(draw, (centre[0], centre[1] + 26), "No. 7", 24, GOLD)


def text_page():
    """A printed page, for a sheet of paper on the table."""
    image = Image.new("RGB", (700, 990), (244, 241, 232))
    draw = ImageDraw.Draw(image)
    generator = random.Random(11)
    draw.text((70, 60), "Notes on the garden", font=font(44), fill=(40, 40, 44))
    words = "the seed in rows a hand apart water early then shade and wait until first leaves open prune two tie stem to cane".split()
    y = 150
    while y < 900:
        line = ""
        while len(line) < 58:
            line += generator.choice(words) + " "
        if generator.random() < 0.12:
            line = line[:25]
        draw.text((70, y), line, font=font(20), fill=(62, 62, 68))
        y += 30
    return image.filter(ImageFilter.GaussianBlur(0.5))


def main():
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    tin_label().quantize(128, dither=Image.Dither.NONE).save(folder / "obj_000001.png", optimize=True)
    text_page().save(folder / "page.png")


if __name__ == "__main__":
    main()
