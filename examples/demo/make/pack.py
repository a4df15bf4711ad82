"""From raw pictures to the data set: photos, depth, masks, truth and models in BOP's layout, and the page's example.

Usage: pack.py BUILD_FOLDER DEMO_FOLDER [--pinpose PROGRAM]
"""

import argparse
import hashlib
import json
import shutil
import struct
import subprocess
import tempfile
import zipfile
import zlib
from pathlib import Path

import camera
import develop
import models as model_files
import numpy as np
from PIL import Image

# Chosen so that all of it stays within 6 MB.
DEPTH_STEP_MM = 1.0
DEPTH_LIMIT_MM = 1000.0  # behind the last object; beyond is 0, as with a sensor that sees no farther
JPEG_QUALITY = 78
EXAMPLE_FRAME = 6
EXAMPLE_POSED, EXAMPLE_WAITING = 1, 5


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("build", type=Path)
    parser.add_argument("demo", type=Path)
    parser.add_argument("--pinpose", default="pinpose", help="the command line, which packs the example")
    parser.add_argument("--partial", action="store_true", help="pack the frames there are")
    options = parser.parse_args()
    bop = options.demo / "bop"
    write_models(options.build, bop / "models")
    for scene_id, (cameras, poses) in camera.sequences().items():
        write_scene(options.build, bop / "test" / f"{scene_id:06d}", scene_id, cameras, poses, options.partial)
    write_camera(bop)
    write_example(options, bop)


def write_models(build, folder):
    folder.mkdir(parents=True, exist_ok=True)
    infos = {}
    for file in sorted(build.glob("model_*.npz")):
        obj_id = int(file.stem.split("_")[1])
        model = model_files.load(file)
        model_files.write_ply(model, folder / f"obj_{obj_id:06d}.ply")
        if model["texture"]:
            shutil.copy(build / model["texture"], folder / model["texture"])
        infos[obj_id] = model_files.info(model)
        if obj_id == EXAMPLE_WAITING:
            model_files.write_glb(model, folder / f"obj_{obj_id:06d}.glb")
    write_json(folder / "models_info.json", infos)


def write_camera(bop):
    k = camera.intrinsics()
    values = {"cx": k[0, 2], "cy": k[1, 2], "depth_scale": DEPTH_STEP_MM, "fx": k[0, 0], "fy": k[1, 1]}
    write_json(bop / "camera.json", {**values, "width": camera.WIDTH, "height": camera.HEIGHT})


def write_scene(build, folder, scene_id, cameras, poses, partial):
    for part in ("rgb", "depth", "mask", "mask_visib"):
        (folder / part).mkdir(parents=True, exist_ok=True)
    truth, seen, info = {}, {}, {}
    for frame, (camera_from_world, world_from_object) in enumerate(zip(cameras, poses)):
        raw = build / "raw" / f"{scene_id:06d}_{frame:06d}"
        photo, exact = Path(f"{raw}_photo.npz"), Path(f"{raw}_truth.npz")
        if partial and not photo.exists():
            continue
        write_photo(photo, folder / "rgb" / f"{frame:06d}.jpg", seed=1000 * scene_id + frame)
        seen[frame] = camera_entry(camera_from_world)
        truth[frame] = [truth_entry(camera_from_world, place, i) for i, place in sorted(world_from_object.items())]
        info[frame] = write_truth_images(np.load(exact), folder, frame, sorted(world_from_object))
    write_json(folder / "scene_camera.json", seen)
    write_json(folder / "scene_gt.json", truth)
    write_json(folder / "scene_gt_info.json", info)


def write_photo(raw, file, seed):
    if file.exists() and file.stat().st_mtime > raw.stat().st_mtime:
        return
    photo = develop.develop(np.load(raw)["photo"], seed)
    Image.fromarray(photo).save(file, quality=JPEG_QUALITY, progressive=True)


def write_truth_images(exact, folder, frame, obj_ids):
    """Depth and masks; returns the frame's entries of scene_gt_info.json."""
    write_depth(exact["depth_mm"], folder / "depth" / f"{frame:06d}.png")
    infos = []
    for index, obj_id in enumerate(obj_ids):
        whole = np.unpackbits(exact[f"mask_{obj_id}"], axis=1)[:, : camera.WIDTH].astype(bool)
        visible = exact["ids"] == obj_id
        write_mask(whole, folder / "mask" / f"{frame:06d}_{index:06d}.png")
        write_mask(visible, folder / "mask_visib" / f"{frame:06d}_{index:06d}.png")
        infos.append(mask_info(whole, visible))
    return infos


def camera_entry(camera_from_world):
    rotation, translation = camera_from_world
    return {
        "cam_K": camera.intrinsics().ravel().tolist(),
        "depth_scale": DEPTH_STEP_MM,
        "cam_R_w2c": rotation.ravel().tolist(),
        "cam_t_w2c": translation.tolist(),
    }


def truth_entry(camera_from_world, world_from_object, obj_id):
    rotation, translation = camera_from_object(camera_from_world, world_from_object)
    return {"cam_R_m2c": rotation.ravel().tolist(), "cam_t_m2c": translation.tolist(), "obj_id": obj_id}


def camera_from_object(camera_from_world, world_from_object):
    rotation, translation = camera_from_world
    object_rotation, object_translation = world_from_object
    return rotation @ object_rotation, rotation @ object_translation + translation


def write_depth(depth_mm, file):
    steps = np.rint(depth_mm / DEPTH_STEP_MM)
    steps[depth_mm > DEPTH_LIMIT_MM] = 0
    write_png16(steps.astype(">u2"), file)


def write_png16(image, file):
    """Every row by PNG's filter 1, the difference to the left: of slanted planes a tenth smaller than what Pillow chooses."""
    height, width = image.shape
    samples = image.view(np.uint8).reshape(height, 2 * width)
    rows = samples.copy()
    rows[:, 2:] -= samples[:, :-2]
    packed = zlib.compress(np.insert(rows, 0, 1, axis=1).tobytes(), 9)

    def chunk(name, content):
        return struct.pack(">I", len(content)) + name + content + struct.pack(">I", zlib.crc32(name + content))

    header = struct.pack(">IIBBBBB", width, height, 16, 0, 0, 0, 0)
    file.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", packed) + chunk(b"IEND", b""))


def write_mask(mask, file):
    # One bit a pixel.
    Image.fromarray(mask).save(file, optimize=True)


def mask_info(whole, visible):
    return {
        "bbox_obj": bounding_box(whole),
        "bbox_visib": bounding_box(visible),
        "px_count_all": int(whole.sum()),
        "px_count_valid": int(visible.sum()),
        "px_count_visib": int(visible.sum()),
        "visib_fract": float(visible.sum() / whole.sum()) if whole.any() else 0.0,
    }


def bounding_box(mask):
    if not mask.any():
        return [-1, -1, -1, -1]
    rows, columns = np.flatnonzero(mask.any(axis=1)), np.flatnonzero(mask.any(axis=0))
    return [int(columns[0]), int(rows[0]), int(columns[-1] - columns[0] + 1), int(rows[-1] - rows[0] + 1)]


def write_json(file, entries):
    """A line per entry. Python writes the digits that bring a number back bit for bit."""
    lines = [f'  "{key}": {json.dumps(value)}' for key, value in entries.items()]
    file.write_text("{\n" + ",\n".join(lines) + "\n}\n")


# ---- the page's example -----------------------------------------------------------------------------------------------


def write_example(options, bop):
    """One photo, one object posed by its truth and one untouched, packed and laid out by PinPose's own command line."""
    names = {int(f.stem.split("_")[1]): model_files.load(f)["name"] for f in options.build.glob("model_*.npz")}
    with tempfile.TemporaryDirectory() as scratch:
        scratch = Path(scratch)
        parts = [scratch / "table.jpg"]
        shutil.copy(bop / "test" / "000001" / "rgb" / f"{EXAMPLE_FRAME:06d}.jpg", parts[0])
        for obj_id in (EXAMPLE_POSED, EXAMPLE_WAITING):
            parts.append(scratch / (names[obj_id].replace(" ", "_") + ".ply"))
            shutil.copy(bop / "models" / f"obj_{obj_id:06d}.ply", parts[-1])
            texture = bop / "models" / f"obj_{obj_id:06d}.png"
            if texture.exists():
                parts.append(scratch / texture.name)
                shutil.copy(texture, parts[-1])
        raw = scratch / "raw.zip"
        subprocess.run([options.pinpose, "convert", *map(str, parts), str(raw)], check=True)
        rewrite_example(raw, options.demo / "example.zip", bop, names)


def rewrite_example(raw, out, bop, names):
    """Puts the camera and the poses into the document of a workspace, and packs it again, small and with a fixed date."""
    with zipfile.ZipFile(raw) as archive:
        contents = {name: archive.read(name) for name in archive.namelist()}
    document = json.loads(contents["scene.json"])
    lay_out(document, bop, names)
    contents["scene.json"] = (json.dumps(document, indent=1) + "\n").encode()
    check_hashes(document, contents)
    with zipfile.ZipFile(out, "w") as archive:
        for name, content in contents.items():
            entry = zipfile.ZipInfo(name, (2026, 1, 1, 0, 0, 0))
            entry.compress_type = zipfile.ZIP_STORED if name.endswith(".jpg") else zipfile.ZIP_DEFLATED
            archive.writestr(entry, content, compresslevel=9)


def lay_out(document, bop, names):
    document["name"] = "Example"
    photo = document["photos"][0]
    k = camera.intrinsics()
    photo["K"] = k.tolist()
    photo["camera_origin"] = {"kind": "file", "name": "scene_camera.json"}
    truth = json.loads((bop / "test" / "000001" / "scene_gt.json").read_text())[str(EXAMPLE_FRAME)]
    infos = json.loads((bop / "models" / "models_info.json").read_text())
    for entry in document["objects"]:
        name = entry["name"] = entry["name"].replace("_", " ")
        obj_id = next(number for number, known in names.items() if known == name)
        pose = next(pose for pose in photo["poses"] if pose["object"] == entry["id"])
        pose["name"] = name
        if obj_id == EXAMPLE_POSED:
            found = next(found for found in truth if found["obj_id"] == obj_id)
            rotation, translation = np.array(found["cam_R_m2c"]).reshape(3, 3), np.array(found["cam_t_m2c"])
            pose["state"], pose["source"] = "posed", "manual"
        else:
            positions = model_files.load_ply_positions(bop / "models" / f"obj_{obj_id:06d}.ply")
            rotation, translation = untouched(infos[str(obj_id)], positions, k)
            pose["state"], pose["source"] = "untouched", "manual"
        pose["R"], pose["t"] = rotation.tolist(), translation.tolist()
        pose["camera_from_object"] = [[*row, value] for row, value in zip(rotation.tolist(), translation.tolist())] + [
            [0.0, 0.0, 0.0, 1.0]
        ]
        pose["changed_at_ms"] = 0.0
    waiting = next(entry["id"] for entry in document["objects"] if entry["name"] == names[EXAMPLE_WAITING])
    document["view"] = {"photo": photo["id"], "selected": waiting, "overlay_opacity": 1.0, "outline": True}


def untouched(info, positions, k):
    """As PinPose places a new object: on the optical axis, unrotated, its bounding sphere a third of the photo's height."""
    low = np.array([info["min_x"], info["min_y"], info["min_z"]])
    centre = low + np.array([info["size_x"], info["size_y"], info["size_z"]]) / 2.0
    radius = np.linalg.norm(positions - centre, axis=1).max()
    # A sphere of radius r at distance d is seen as a circle of f r / sqrt(d^2 - r^2) pixels.
    tangent = camera.HEIGHT / 6.0 / k[1, 1]
    distance = radius * np.sqrt(1.0 + 1.0 / tangent**2)
    return np.eye(3), np.array([0.0, 0.0, distance]) - centre


def check_hashes(document, contents):
    found = {hashlib.sha256(content).hexdigest() for content in contents.values()}
    named = [photo["sha256"] for photo in document["photos"]] + [entry["mesh_sha256"] for entry in document["objects"]]
    missing = [sha256 for sha256 in named if sha256 not in found]
    if missing:
        raise SystemExit(f"the workspace lacks files with these hashes: {missing}")


if __name__ == "__main__":
    main()
