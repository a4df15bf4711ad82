"""Makes the two fonts here from egui's own: the scripts that the program's words and people's names are written in, and no
hinting programs, which egui's own hinter stands in for. Together they weigh four tenths of the originals on the wire.

    pip install fonttools
    python make.py FOLDER   # of the crate epaint_default_fonts: the one with Ubuntu-Light.ttf and Hack-Regular.ttf

The Ubuntu font licence asks that a changed font says so in its name, which is why it is renamed.
"""

import pathlib
import sys

from fontTools import subset
from fontTools.ttLib import TTFont

# Latin with its extensions, Greek, Cyrillic, punctuation, currency, arrows, mathematics, lines and shapes.
RANGES = [
    (0x20, 0x24F), (0x2B0, 0x36F), (0x370, 0x3FF), (0x400, 0x52F), (0x1E00, 0x1EFF), (0x2000, 0x20CF),
    (0x2100, 0x23FF), (0x2500, 0x27BF), (0xFB00, 0xFB06), (0xFFFD, 0xFFFD),
]
# Numbers and code, and the signs that the font for words has none of; other scripts come from that one, which is asked next.
COLUMNS = [
    (0x20, 0x17F), (0x2000, 0x206F), (0x20AC, 0x20AC), (0x2190, 0x2199), (0x21D0, 0x21D4), (0x2200, 0x2212), (0x2248, 0x2265),
    (0x25A0, 0x25CF), (0x2605, 0x2606), (0x2713, 0x2718), (0xFFFD, 0xFFFD),
]
FONTS = {
    "Ubuntu-Light.ttf": ("Ubuntu derivative PinPose", RANGES),
    "Hack-Regular.ttf": ("Hack derivative PinPose", COLUMNS),
}


def cut(path: pathlib.Path, name: str, ranges: list[tuple[int, int]], out: pathlib.Path) -> None:
    font = TTFont(path)
    options = subset.Options()
    options.hinting = False
    options.notdef_outline = True
    options.layout_features = ["kern", "mark", "mkmk", "liga", "calt", "ccmp", "locl"]
    options.name_IDs = ["*"]
    options.drop_tables += ["TTFA"]
    subsetter = subset.Subsetter(options)
    subsetter.populate(unicodes=[code for first, last in ranges for code in range(first, last + 1)])
    subsetter.subset(font)
    for record in font["name"].names:
        if record.nameID in (1, 3, 4, 6, 16):
            record.string = name.replace(" ", "-") if record.nameID == 6 else name
    font.save(out)


def main() -> None:
    here = pathlib.Path(__file__).parent
    for file, (name, ranges) in FONTS.items():
        cut(pathlib.Path(sys.argv[1]) / file, name, ranges, here / "fonts" / file)


if __name__ == "__main__":
    main()
