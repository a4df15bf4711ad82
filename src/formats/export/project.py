"""Projects the meshes of a PinPose export into its photos, with NumPy alone.

    python3 project.py poses.json             poses in the convention that was chosen
    python3 project.py pinpose.json [FOLDER]  PinPose's own document; FOLDER has the original meshes (PLY)
    python3 project.py bop/test/000001        a BOP scene

Everything is brought to X_camera = R X_object + t in OpenCV's camera frame (x right, y down, z forward) and millimetres.
Pixel (0, 0) is the centre of the top-left pixel.
"""

import json
import sys
from pathlib import Path

import numpy as np

TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "<i2", "int16": "<i2", "ushort": "<u2",
    "uint16": "<u2", "int": "<i4", "int32": "<i4", "uint": "<u4", "uint32": "<u4", "float": "<f4", "float32": "<f4",
    "double": "<f8", "float64": "<f8",
}


def project(vertices, camera_from_object, K, distortion=None):
    """Pixels (n, 2) of vertices (n, 3) in mm; distortion is k1 k2 p1 p2 k3, as in OpenCV."""
    x, y, z = camera_from_object[:3, :3] @ vertices.T + camera_from_object[:3, 3:]
    x, y = x / z, y / z
    if distortion is not None:
        k1, k2, p1, p2, k3 = distortion
        r2 = x * x + y * y
        radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3))
        x, y = (
            x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
            y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y,
        )
    return np.stack([K[0, 0] * x + K[0, 1] * y + K[0, 2], K[1, 1] * y + K[1, 2]], axis=1)


def read_vertices(path):
    """Vertices (n, 3) of a PLY file, ascii or binary little-endian, in the file's order."""
    data = Path(path).read_bytes()
    end = data.index(b"\n", data.index(b"end_header")) + 1
    header = [line.split() for line in data[:end].decode("ascii", "replace").splitlines()]
    count, fields, in_vertex = 0, [], False
    for words in header:
        if words[:1] == ["element"]:
            in_vertex = words[1] == "vertex"
            count = int(words[2]) if in_vertex else count
        elif words[:1] == ["property"] and in_vertex:
            fields.append((words[2], TYPES[words[1]]))
    if ["format", "ascii", "1.0"] in header:
        rows = data[end:].decode("ascii").split("\n")[:count]
        columns = dict(zip((name for name, _ in fields), np.array([row.split() for row in rows], dtype=float).T))
        # Rounded to the type that the header gives, as every reader does.
        table = {axis: columns[axis].astype(dict(fields)[axis]) for axis in "xyz"}
    else:
        table = np.frombuffer(data, np.dtype(fields), count, end)
    return np.stack([table[axis] for axis in "xyz"], axis=1).astype(float)


def in_our_convention(matrix, conventions):
    """camera_from_object in OpenCV's axes and millimetres."""
    pose = np.array(matrix, dtype=float)
    if conventions["length_unit"] == "m":
        pose[:3, 3] *= 1000
    if conventions["direction"].startswith("object_from_camera"):
        pose = np.linalg.inv(pose)
    if conventions["camera_axes"].startswith("OpenGL"):
        pose = np.diag([1.0, -1.0, -1.0, 1.0]) @ pose
    return pose


def poses(path, meshes=None):
    """Yields photo, object, vertices in mm, camera_from_object, K, distortion for each pose of an export."""
    path = Path(path)
    if path.is_dir():
        yield from bop_poses(path)
        return
    document = json.loads(path.read_text(encoding="utf-8"))
    folder = Path(meshes) if meshes else path.parent
    objects = {entry["id"]: entry for entry in document.get("objects", [])}
    for photo in document["photos"]:
        for pose in photo["poses"]:
            if document["format"] == "pinpose":
                vertices = read_vertices(folder / pose["mesh_file"])
                object_from_file = np.array(objects[pose["object"]]["mesh_from_file"])
                vertices = vertices @ object_from_file[:3, :3].T + object_from_file[:3, 3]
                name, matrix = pose["name"], np.array(pose["camera_from_object"])
            else:
                if pose["mesh"] is None:
                    raise SystemExit("This export has no meshes: export them too.")
                vertices = read_vertices(folder / pose["mesh"])
                name, matrix = pose["object"], in_our_convention(pose["matrix"], document["conventions"])
            yield photo["file"], name, vertices, matrix, np.array(photo["K"]), photo["distortion"]


def bop_poses(scene):
    """The same for a BOP scene folder; its models are two folders up."""
    cameras = json.loads((scene / "scene_camera.json").read_text())
    for image, truths in json.loads((scene / "scene_gt.json").read_text()).items():
        K = np.array(cameras[image]["cam_K"], dtype=float).reshape(3, 3)
        for truth in truths:
            pose = np.eye(4)
            pose[:3, :3] = np.reshape(truth["cam_R_m2c"], (3, 3))
            pose[:3, 3] = truth["cam_t_m2c"]
            mesh = scene.parent.parent / "models" / f"obj_{truth['obj_id']:06d}.ply"
            yield image, mesh.stem, read_vertices(mesh), pose, K, None


if __name__ == "__main__":
    if len(sys.argv) < 2:
        raise SystemExit(__doc__)
    for photo, name, vertices, pose, K, distortion in poses(*sys.argv[1:3]):
        pixels = project(vertices, pose, K, distortion)
        low, high = pixels.min(axis=0), pixels.max(axis=0)
        print(f"{photo}: {name}: x {low[0]:.1f} to {high[0]:.1f}, y {low[1]:.1f} to {high[1]:.1f}")
