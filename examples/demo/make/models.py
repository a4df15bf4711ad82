"""Model files: PLY as BOP has it (millimetres), GLB as glTF has it (metres, y up), and what models_info.json says."""

import json
import struct

import numpy as np


def load(file):
    stored = np.load(file)
    return {
        "name": str(stored["name"]),
        "texture": str(stored["texture"]),
        "positions": stored["positions"].astype("<f4"),
        "normals": stored["normals"].astype("<f4"),
        "colors": stored["colors"].astype("u1"),
        "uvs": stored["uvs"].astype("<f4") if "uvs" in stored else None,
        "triangles": stored["triangles"].astype("<i4"),
        "symmetries_discrete": stored["symmetries_discrete"].tolist(),
        "continuous": bool(stored["continuous"]),
    }


def write_ply(model, file):
    columns = [("x", "f4"), ("y", "f4"), ("z", "f4"), ("nx", "f4"), ("ny", "f4"), ("nz", "f4")]
    columns += [("red", "u1"), ("green", "u1"), ("blue", "u1")]
    if model["uvs"] is not None:
        columns += [("texture_u", "f4"), ("texture_v", "f4")]
    rows = np.zeros(len(model["positions"]), [(name, "<" + kind) for name, kind in columns])
    for i, axis in enumerate("xyz"):
        rows[axis], rows["n" + axis] = model["positions"][:, i], model["normals"][:, i]
    for i, channel in enumerate(("red", "green", "blue")):
        rows[channel] = model["colors"][:, i]
    if model["uvs"] is not None:
        rows["texture_u"], rows["texture_v"] = model["uvs"][:, 0], model["uvs"][:, 1]
    faces = np.zeros(len(model["triangles"]), [("count", "u1"), ("corners", "<i4", 3)])
    faces["count"], faces["corners"] = 3, model["triangles"]
    header = ["ply", "format binary_little_endian 1.0", f"comment {model['name']}, millimetres, CC0 1.0"]
    if model["texture"]:
        header.append(f"comment TextureFile {model['texture']}")
    header.append(f"element vertex {len(rows)}")
    header += [f"property {'uchar' if kind == 'u1' else 'float'} {name}" for name, kind in columns]
    header += [f"element face {len(faces)}", "property list uchar int vertex_indices", "end_header"]
    file.write_bytes(("\n".join(header) + "\n").encode() + rows.tobytes() + faces.tobytes())


def load_ply_positions(file):
    """The vertices of a PLY file that `write_ply` wrote."""
    content = file.read_bytes()
    header, body = content.split(b"end_header\n", 1)
    lines = header.decode().split("\n")
    count = next(int(line.split()[2]) for line in lines if line.startswith("element vertex"))
    sizes = [
        1 if line.split()[1] == "uchar" else 4
        for line in lines
        if line.startswith(("property float", "property uchar"))
    ]
    rows = np.frombuffer(body[: count * sum(sizes)], np.uint8).reshape(count, sum(sizes))
    return np.ascontiguousarray(rows[:, :12]).view("<f4").astype(np.float64)


def write_glb(model, file):
    """glTF's axes: x stays, up is y, so y of the file is our z and z of the file is our -y."""
    turn = np.array([[1, 0, 0], [0, 0, 1], [0, -1, 0]], np.float64)
    positions = (model["positions"].astype(np.float64) @ turn.T / 1000.0).astype("<f4")
    normals = (model["normals"].astype(np.float64) @ turn.T).astype("<f4")
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    # glTF's vertex colours are linear.
    srgb = model["colors"] / 255.0
    linear = np.where(srgb <= 0.04045, srgb / 12.92, ((srgb + 0.055) / 1.055) ** 2.4)
    colors = np.rint(np.concatenate([linear, np.ones((len(linear), 1))], axis=1) * 65535.0).astype("<u2")
    indices = model["triangles"].astype("<u2").reshape(-1)
    chunks = [positions.tobytes(), normals.astype("<f4").tobytes(), colors.tobytes(), indices.tobytes()]
    views, offset = [], 0
    for chunk, target in zip(chunks, (34962, 34962, 34962, 34963)):
        views.append({"buffer": 0, "byteOffset": offset, "byteLength": len(chunk), "target": target})
        offset += len(chunk)
    bounds = {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
    count = len(positions)
    document = {
        "asset": {"version": "2.0", "generator": "PinPose demo scene", "copyright": "CC0 1.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0, "name": model["name"]}],
        "materials": [{"pbrMetallicRoughness": {"metallicFactor": 0.0, "roughnessFactor": 0.5}}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1, "COLOR_0": 2}, "indices": 3, "material": 0}]}
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3", **bounds},
            {"bufferView": 1, "componentType": 5126, "count": count, "type": "VEC3"},
            {"bufferView": 2, "componentType": 5123, "normalized": True, "count": count, "type": "VEC4"},
            {"bufferView": 3, "componentType": 5123, "count": len(indices), "type": "SCALAR"},
        ],
        "bufferViews": views,
        "buffers": [{"byteLength": offset}],
    }
    text = json.dumps(document, separators=(",", ":")).encode()
    text += b" " * (-len(text) % 4)
    binary = b"".join(chunks)
    binary += b"\0" * (-len(binary) % 4)
    total = 12 + 8 + len(text) + 8 + len(binary)
    head = struct.pack("<4sII", b"glTF", 2, total)
    file.write_bytes(
        head + struct.pack("<I4s", len(text), b"JSON") + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary
    )


def info(model):
    positions = model["positions"].astype(np.float64)
    low, high = positions.min(axis=0), positions.max(axis=0)
    entry = {"diameter": diameter(positions)}
    for i, axis in enumerate("xyz"):
        entry[f"min_{axis}"], entry[f"size_{axis}"] = float(low[i]), float(high[i] - low[i])
    if model["symmetries_discrete"]:
        entry["symmetries_discrete"] = model["symmetries_discrete"]
    if model["continuous"]:
        entry["symmetries_continuous"] = [{"axis": [0.0, 0.0, 1.0], "offset": [0.0, 0.0, 0.0]}]
    return entry


def diameter(positions):
    """The largest distance between two vertices, by trying all pairs."""
    largest = 0.0
    for start in range(0, len(positions), 256):
        differences = positions[start : start + 256, None, :] - positions[None, :, :]
        largest = max(largest, float((differences**2).sum(axis=2).max()))
    return largest**0.5
