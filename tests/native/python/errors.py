"""Pose errors by their definitions, with NumPy alone and none of PinPose's code: what `pinpose evaluate` has to find.

    python3 errors.py CASES.json

CASES is a list of {mesh, K, width, height, depth, truth, estimate, symmetries, slow}; K and poses are rows, a mesh is an ascii
PLY or [vertices.npy, faces.npy], depth a .npy in mm or null, symmetries are those of BOP's models_info.json. Prints a list of
errors. Those that need all pairs of vertices, or pictures, are left out where "slow" is false.
"""

import json
import sys

import numpy as np

TAUS = np.arange(1, 11) / 20
DELTA_MM = 15.0
# PinPose rounds projected vertices to this; the pictures are equal only if both do.
GRID_PER_PIXEL = 4096


def read_vertices_and_faces(path):
    """Of an ascii PLY whose faces are triangles, or of two arrays."""
    if isinstance(path, list):
        vertices, faces = (np.load(part) for part in path)
        return vertices, faces.astype(int)
    lines = open(path, encoding="utf-8", errors="replace").read().split("\n")
    end = lines.index("end_header")
    counts = {words[1]: int(words[2]) for words in map(str.split, lines[:end]) if words[:1] == ["element"]}
    rows = lines[end + 1 :]
    # A PLY's "float" is 32 bits wide.
    vertices = np.array([row.split()[:3] for row in rows[: counts["vertex"]]], dtype=np.float32).astype(float)
    faces = rows[counts["vertex"] : counts["vertex"] + counts["face"]]
    return vertices, np.array([row.split()[1:4] for row in faces], dtype=int)


def moved(vertices, pose):
    return vertices @ pose[:3, :3].T + pose[:3, 3]


def projected(vertices, pose, K):
    pixels = moved(vertices, pose) @ K.T
    return pixels[:, :2] / pixels[:, 2:]


def nearest_distances(places, points):
    """From each place to the nearest of the points, by all pairs, a part of them at a time."""
    middle = points.mean(axis=0)
    places, points = places - middle, points - middle
    squares = (points**2).sum(axis=1)
    found = []
    for start in range(0, len(places), 500):
        part = places[start : start + 500]
        at = (squares - 2 * part @ points.T).argmin(axis=1)
        found.append(np.linalg.norm(part - points[at], axis=1))
    return np.concatenate(found)


def diameter(vertices):
    """The largest distance of all pairs."""
    centred = vertices - vertices.mean(axis=0)
    squares = (centred**2).sum(axis=1)
    largest = 0.0
    for start in range(0, len(centred), 500):
        part = centred[start : start + 500]
        at = (squares - 2 * part @ centred.T).argmax(axis=1)
        largest = max(largest, np.linalg.norm(part - centred[at], axis=1).max())
    return largest


def render(vertices, faces, pose, K, width, height):
    """Depth in float32, 0 where nothing is: pixel centres within triangles, top-left rule, the nearest wins."""
    camera = moved(vertices, pose)
    pixels = camera @ K.T
    pixels = pixels[:, :2] / pixels[:, 2:]
    grid = np.floor(pixels * GRID_PER_PIXEL + 0.5).astype(np.int64)
    depth = np.full(width * height, np.inf, dtype=np.float32)
    corners, inverse = grid[faces], 1.0 / camera[faces][:, :, 2]
    low = np.maximum(-(-corners.min(axis=1) // GRID_PER_PIXEL), 0)
    high = np.minimum(corners.max(axis=1) // GRID_PER_PIXEL, [width - 1, height - 1])
    edge = lambda a, b: b - a
    ab, ac = edge(corners[:, 0], corners[:, 1]), edge(corners[:, 0], corners[:, 2])
    area = ab[:, 0] * ac[:, 1] - ab[:, 1] * ac[:, 0]
    swap = area < 0
    corners[swap] = corners[swap][:, [0, 2, 1]]
    inverse[swap] = inverse[swap][:, [0, 2, 1]]
    extent = (high - low + 1).max(axis=1)
    drawn = (area != 0) & (high >= low).all(axis=1)
    size = 1
    while drawn.any():
        now = drawn & (extent <= size)
        drawn &= ~now
        fill(depth, corners[now], inverse[now], np.abs(area[now]), low[now], high[now], size, width)
        size *= 2
    depth[np.isinf(depth)] = 0
    return depth.reshape(height, width)


def fill(depth, corners, inverse, area, low, high, size, width):
    """All triangles whose box is at most size by size pixels."""
    if len(corners) == 0:
        return
    dy, dx = np.mgrid[:size, :size].reshape(2, -1)
    x, y = low[:, :1] + dx, low[:, 1:] + dy
    inside = (x <= high[:, :1]) & (y <= high[:, 1:])
    value = np.zeros(x.shape)
    for corner in range(3):
        start, end = corners[:, (corner + 1) % 3], corners[:, (corner + 2) % 3]
        step = end - start
        side = step[:, :1] * (y * GRID_PER_PIXEL - start[:, 1:]) - step[:, 1:] * (x * GRID_PER_PIXEL - start[:, :1])
        top_left = ((step[:, 1] == 0) & (step[:, 0] > 0)) | (step[:, 1] < 0)
        inside &= side >= np.where(top_left, 0, 1)[:, None]
        value += side / area[:, None] * inverse[:, corner, None]
    at = (y * width + x)[inside]
    np.minimum.at(depth, at, (1.0 / value[inside]).astype(np.float32))


def expanded(symmetries):
    """All transforms of BOP's symmetries: each discrete one after each of 315 turns about each axis."""
    discrete = [np.eye(4)] + [np.reshape(rows, (4, 4)) for rows in symmetries["discrete"]]
    turns = []
    for symmetry in symmetries["continuous"]:
        (x, y, z), offset = symmetry["axis"], np.array(symmetry["offset"])
        cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
        steps = int(np.ceil(np.pi / 0.01))
        for angle in 2 * np.pi * np.arange(steps) / steps:
            turn = np.eye(4)
            turn[:3, :3] += np.sin(angle) * cross + (1 - np.cos(angle)) * cross @ cross
            turn[:3, 3] = offset - turn[:3, :3] @ offset
            turns.append(turn)
    return [turn @ first for first in discrete for turn in turns or [np.eye(4)]]


def vsd(depth_truth, depth_estimate, depth_test, K, diameter):
    """What was not measured (0) hides nothing."""
    height, width = depth_truth.shape
    x, y = np.meshgrid(np.arange(width), np.arange(height))
    length = np.sqrt(((x - K[0, 2]) / K[0, 0]) ** 2 + ((y - K[1, 2]) / K[1, 1]) ** 2 + 1)
    truth, estimate, test = depth_truth * length, depth_estimate * length, depth_test * length
    seen_truth = (truth > 0) & ((test == 0) | (truth - test <= DELTA_MM))
    seen_estimate = (estimate > 0) & ((test == 0) | (estimate - test <= DELTA_MM) | seen_truth)
    both, either = seen_truth & seen_estimate, seen_truth | seen_estimate
    part = np.abs(truth[both] - estimate[both]) / diameter
    return [(np.sum(part >= tau) + either.sum() - both.sum()) / either.sum() for tau in TAUS]


def errors(case, meshes):
    key = str(case["mesh"])
    if key not in meshes:
        meshes[key] = read_vertices_and_faces(case["mesh"])
    vertices, faces = meshes[key]
    truth, estimate, K = (np.array(case[key]) for key in ("truth", "estimate", "K"))
    symmetries = expanded(case["symmetries"])
    differences = moved(vertices, truth) - moved(vertices, estimate)
    pixel_differences = projected(vertices, truth, K) - projected(vertices, estimate, K)
    cosine = (np.trace(truth[:3, :3].T @ estimate[:3, :3]) - 1) / 2
    middle = (vertices.min(axis=0) + vertices.max(axis=0)) / 2
    found = {
        "rotation_deg": np.degrees(np.arccos(cosine)),
        "translation_mm": np.linalg.norm(truth[:3, 3] - estimate[:3, 3]),
        "depth_mm": (moved(middle, estimate) - moved(middle, truth))[2],
        "add_mm": np.linalg.norm(differences, axis=1).mean(),
        "mssd_mm": min(
            np.linalg.norm(moved(vertices, truth @ symmetry) - moved(vertices, estimate), axis=1).max()
            for symmetry in symmetries
        ),
        "mspd_px": 640 / case["width"] * min(
            np.linalg.norm(projected(vertices, truth @ symmetry, K) - projected(vertices, estimate, K), axis=1).max()
            for symmetry in symmetries
        ),
        "proj_px": np.linalg.norm(pixel_differences, axis=1).mean(),
    }
    if case["slow"]:
        found["adi_mm"] = nearest_distances(moved(vertices, truth), moved(vertices, estimate)).mean()
        found["ad_mm"] = found["adi_mm"] if len(symmetries) > 1 else found["add_mm"]
        found["diameter_mm"] = diameter(vertices)
        depths = [render(vertices, faces, pose, K, case["width"], case["height"]) for pose in (truth, estimate)]
        size = (case["height"], case["width"])
        test = np.zeros(size) if case["depth"] is None else np.load(case["depth"]).reshape(size)
        found["vsd_by_tau"] = vsd(*depths, test, K, found["diameter_mm"])
        found["vsd"] = np.mean(found["vsd_by_tau"])
        masks = [depth > 0 for depth in depths]
        found["cus"] = 1 - (masks[0] & masks[1]).sum() / (masks[0] | masks[1]).sum()
    return found


if __name__ == "__main__":
    meshes = {}
    cases = json.load(open(sys.argv[1], encoding="utf-8"))
    print(json.dumps([errors(case, meshes) for case in cases], default=float))
