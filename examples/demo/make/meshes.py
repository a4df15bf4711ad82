"""The five objects whose poses are known. Millimetres, origin near the centre, z up as they stand on the table."""

import functools
import math
from dataclasses import dataclass, field

import bmesh
import bpy
import numpy as np
from mathutils import Matrix

import shapes

# The tin's texture: the wrap below, a picture of the lid's top above it (see label.py).
TIN_WIDTH, TIN_DEPTH, TIN_RADIUS, TIN_HEIGHT = 84.0, 58.0, 9.0, 128.0
TIN_WRAP_FRACTION = 0.75


@dataclass
class Model:
    """What goes into a PLY file, and back from there into the renderer."""

    obj_id: int
    name: str
    regions: list  # (material, sRGB colour) per region number
    positions: np.ndarray = None  # n x 3, float32, mm
    normals: np.ndarray = None
    colors: np.ndarray = None  # n x 3, uint8, sRGB
    uvs: np.ndarray = None  # n x 2 or None
    triangles: np.ndarray = None
    triangle_regions: np.ndarray = None
    texture: str = None
    symmetries_discrete: list = field(default_factory=list)
    symmetries_continuous: list = field(default_factory=list)


def all_models(texture_pixels):
    return [tea_tin(texture_pixels), pepper_mill(), hex_nut(), mug(), toy_car()]


# ---- 1: printed tin, textured -----------------------------------------------------------------------------------------


def tea_tin(texture_pixels):
    model = Model(1, "tea tin", [("tin", (230, 225, 210)), ("tin_metal", (205, 170, 95))], texture="obj_000001.png")
    outline, _, _ = shapes.rounded_rectangle(TIN_WIDTH, TIN_DEPTH, TIN_RADIUS, 2.9)
    half = TIN_HEIGHT / 2.0
    lid_z = half - 26.0
    body = [-half + 1.2 + (lid_z - 0.6 + half - 1.2) * i / 33 for i in range(34)]
    # (z, how far the wall lies outside the body's wall)
    levels = [(-half, -4.0), (-half, -1.2)] + [(z, 0.0) for z in body]
    levels += [(lid_z, 0.2), (lid_z + 0.3, 1.1), (lid_z + 1.6, 1.3), (lid_z + 9.0, 1.3), (half - 9.0, 1.3)]
    levels += [(half - 4.0, 1.1), (half - 1.6, 0.2), (half - 0.4, -1.4), (half, -3.2), (half - 0.2, -5.0)]
    levels += [(half - 1.6, -5.8), (half - 1.6, -12.0), (half - 1.2, -14.0), (half - 1.2, -20.0), (half - 1.2, -26.0)]
    bm = bmesh.new()
    rings = []
    for z, offset in levels:
        rings.append([(*inset(x, y, offset), z) for x, y in outline])
    regions = [1 if i <= 1 else 0 for i in range(len(levels))]
    shapes.loft(bm, rings, regions)
    close_ends(bm, region_bottom=1, region_top=0)
    uv_layer = bm.loops.layers.uv.new("uv")
    lid_start = half - 1.7
    for face in bm.faces:
        centre = face.calc_center_median()
        on_lid_top = centre.z > lid_start and inset_distance(centre) > 5.0
        for loop in face.loops:
            loop[uv_layer].uv = tin_uv(loop.vert.co, centre, on_lid_top, half)
    finish(model, bm, math.radians(35), texture_pixels)
    return model


def inset(x, y, offset):
    """Moves a point of the tin's outline outwards."""
    core_x, core_y = TIN_WIDTH / 2 - TIN_RADIUS, TIN_DEPTH / 2 - TIN_RADIUS
    if offset < -TIN_RADIUS:
        # Further in than the corners are round: shrink towards the middle instead.
        factor_x = (TIN_WIDTH / 2 + offset) / (TIN_WIDTH / 2)
        factor_y = (TIN_DEPTH / 2 + offset) / (TIN_DEPTH / 2)
        return x * factor_x, y * factor_y
    near_x, near_y = min(max(x, -core_x), core_x), min(max(y, -core_y), core_y)
    length = math.hypot(x - near_x, y - near_y)
    scale = (length + offset) / length
    return near_x + (x - near_x) * scale, near_y + (y - near_y) * scale


def inset_distance(point):
    return min(TIN_WIDTH / 2 - abs(point.x), TIN_DEPTH / 2 - abs(point.y))


def tin_uv(position, face_centre, on_lid_top, half):
    if on_lid_top:
        u = 0.02 + 0.30 * (position.x / TIN_WIDTH + 0.5)
        v = TIN_WRAP_FRACTION + 0.02 + 0.21 * (position.y / TIN_DEPTH + 0.5)
        return u, v
    u = wrap_fraction(position.x, position.y)
    # Across the seam a face would run backwards through the whole label.
    centre_u = wrap_fraction(face_centre.x, face_centre.y)
    if u - centre_u > 0.5:
        u -= 1.0
    if centre_u - u > 0.5:
        u += 1.0
    return u, TIN_WRAP_FRACTION * min(max((position.z + half) / (2 * half), 0.0), 1.0)


@functools.lru_cache(maxsize=None)
def wrap_fraction(x, y):
    """How far around the tin a point is, 0 in the middle of the back, 0.5 in the middle of the front."""
    outline, arcs, perimeter = WRAP
    nearest = min(range(len(outline)), key=lambda i: (outline[i][0] - x) ** 2 + (outline[i][1] - y) ** 2)
    return (arcs[nearest] / perimeter + 0.5) % 1.0


WRAP = shapes.rounded_rectangle(TIN_WIDTH, TIN_DEPTH, TIN_RADIUS, 0.1)


def close_ends(bm, region_bottom, region_top):
    """Caps the two open ends of a loft."""
    bm.edges.ensure_lookup_table()
    open_edges = [edge for edge in bm.edges if len(edge.link_faces) == 1]
    middle = sum(edge.verts[0].co.z for edge in open_edges) / len(open_edges)
    for is_top, region in ((False, region_bottom), (True, region_top)):
        edges = [edge for edge in open_edges if (edge.verts[0].co.z > middle) == is_top]
        for face in bmesh.ops.contextual_create(bm, geom=edges)["faces"]:
            face.material_index = region


# ---- 2: turned pepper mill, symmetric about its axis ------------------------------------------------------------------


def pepper_mill():
    regions = [("walnut", (94, 58, 34)), ("walnut_light", (150, 104, 62)), ("steel", (190, 190, 188))]
    model = Model(2, "pepper mill", regions)
    model.symmetries_continuous = [{"axis": [0.0, 0.0, 1.0], "offset": [0.0, 0.0, 0.0]}]
    body = [
        (27.0, 2.0),
        (28.5, 8.0),
        (28.0, 16.0),
        (24.5, 26.0),
        (20.0, 40.0),
        (17.2, 56.0),
        (16.6, 66.0),
        (18.5, 80.0),
    ]
    body += [(22.0, 92.0), (23.0, 100.0)]
    head = [(23.0, 107.5), (24.0, 112.0), (25.5, 122.0), (25.0, 134.0), (21.0, 146.0), (14.0, 153.0)]
    profile = [(0.0, 0.0, 0), (20.0, 0.0, 0), (25.5, 0.3, 0)]
    profile += [(r, z, 0) for r, z in shapes.smooth_open(body, 3)]
    profile += [(22.4, 101.5, 0), (19.5, 102.0, 0), (19.5, 103.4, 2), (19.5, 105.0, 2), (22.4, 105.6, 0)]
    profile += [(r, z, 1 if 112.0 < z < 114.5 else 0) for r, z in shapes.smooth_open(head, 3)]
    profile += [(8.0, 154.5, 0), (7.0, 154.8, 2), (5.0, 156.5, 2), (4.6, 158.5, 2), (7.4, 161.0, 2), (8.6, 164.5, 2)]
    profile += [(7.4, 168.0, 2), (4.0, 170.2, 2), (0.0, 170.8, 2)]
    bm = bmesh.new()
    lift = -85.4
    shapes.lathe(bm, [(r, z + lift, region) for r, z, region in profile], 72)
    finish(model, bm, math.radians(35))
    return model


# ---- 3: hex nut, twelve ways round ------------------------------------------------------------------------------------


def hex_nut():
    model = Model(3, "hex nut", [("brass", (190, 162, 106)), ("brass_thread", (146, 118, 70))])
    flats, height, samples = 66.0, 34.0, 72
    half, rim, bore, crest = height / 2, flats / 2 * 0.955, 21.5, 19.0
    angles = [2 * math.pi * i / samples for i in range(samples)]

    def hexagon(angle):
        # Corners at multiples of 60 degrees.
        sector = (angle % (math.pi / 3)) - math.pi / 6
        return flats / 2 / math.cos(sector)

    def chamfered(angle, sign):
        radius = hexagon(angle)
        z = half - max(0.0, radius - rim) * math.tan(math.radians(30))
        return (radius * math.cos(angle), radius * math.sin(angle), sign * z)

    def circle(radius, z):
        return [(radius * math.cos(a), radius * math.sin(a), z) for a in angles]

    # A real thread is a helix, which has no symmetry; grooves have.
    turns = 9
    thread = []
    for i in range(2 * turns + 1):
        z = half - 3.2 - (height - 6.4) * i / (2 * turns)
        thread.append((circle(bore if i % 2 == 0 else crest, z), 1))
    middle = [(hexagon(a) * math.cos(a), hexagon(a) * math.sin(a), 0.0) for a in angles]
    below = [circle(24.0, -half), circle(rim, -half), [chamfered(a, -1) for a in angles]]
    above = [[chamfered(a, 1) for a in angles], circle(rim, half), circle(24.0, half)]
    rings = [(points, 0) for points in (*below, middle, *above)] + thread
    bm = bmesh.new()
    made = [shapes.ring(bm, points) for points, _ in rings]
    for i in range(len(made)):
        following = (i + 1) % len(made)
        shapes.bridge(bm, made[i], made[following], rings[following][1])
    finish(model, bm, math.radians(25))
    model.symmetries_discrete = dihedral(6)
    return model


def dihedral(order):
    """All proper rotations but the identity that map a regular prism onto itself, 4x4 row by row."""
    found = []
    for flip in (1.0, -1.0):
        for k in range(order):
            if flip > 0 and k == 0:
                continue
            c, s = math.cos(2 * math.pi * k / order), math.sin(2 * math.pi * k / order)
            # Half a turn about x first, where there is one.
            found.append([c, -s * flip, 0.0, 0.0, s, c * flip, 0.0, 0.0, 0.0, 0.0, flip, 0.0, 0.0, 0.0, 0.0, 1.0])
    return found


# ---- 4: mug with a handle ---------------------------------------------------------------------------------------------


def mug():
    regions = [("glaze_blue", (44, 86, 110)), ("glaze_cream", (226, 216, 196)), ("clay", (172, 120, 84))]
    model = Model(4, "mug", regions)
    outer = [(37.0, 12.0), (40.5, 24.0), (41.5, 42.0), (40.8, 62.0), (40.2, 80.0), (40.4, 92.0)]
    inner = [(36.4, 91.0), (35.9, 80.0), (36.3, 62.0), (36.9, 42.0), (35.6, 24.0), (30.0, 12.0), (20.0, 7.6)]
    profile = [
        (0.0, 2.5, 2),
        (26.0, 2.5, 2),
        (27.0, 0.0, 2),
        (31.0, 0.0, 2),
        (32.0, 3.0, 2),
        (33.6, 6.5, 2),
        (36.0, 10.5, 2),
    ]
    profile += [(r, z, 0 if z < 84.0 else 1) for r, z in shapes.smooth_open(outer, 5)]
    profile += [(40.2, 94.0, 1), (39.2, 95.4, 1), (38.2, 95.6, 1), (37.1, 94.6, 1)]
    profile += [(r, z, 1) for r, z in shapes.smooth_open(inner, 3)] + [(0.0, 6.8, 1)]
    lift = -48.0
    bm = bmesh.new()
    shapes.lathe(bm, [(r, z + lift, region) for r, z, region in profile], 80)
    # The handle's ends stop inside the wall.
    path = [
        (38.6, 76.0),
        (46.0, 78.5),
        (58.0, 78.0),
        (67.5, 70.0),
        (70.0, 56.0),
        (66.0, 42.0),
        (57.0, 31.0),
        (47.0, 25.0),
        (38.4, 22.0),
    ]
    path = shapes.smooth_open([(x, z + lift) for x, z in path], 4)
    # Thicker where it meets the body.
    swell = [abs(2 * i / (len(path) - 1) - 1) ** 3 for i in range(len(path))]
    radii = [(4.6 + 1.4 * s, 7.6 + 2.6 * s) for s in swell]
    shapes.sweep(bm, path, 18, radii, 0)
    finish(model, bm, math.radians(40))
    return model


# ---- 5: wooden toy car ------------------------------------------------------------------------------------------------


def toy_car():
    regions = [
        ("paint_red", (178, 44, 36)),
        ("beech", (206, 164, 112)),
        ("paint_dark", (46, 46, 50)),
        ("paint_cream", (236, 226, 200)),
        ("steel", (190, 190, 188)),
    ]
    model = Model(5, "toy car", regions)
    bm = bmesh.new()
    # Heading along +x. Bonnet low in front, cabin behind the middle.
    body = [
        (-62.0, 12.0),
        (-63.0, 26.0),
        (-58.0, 35.0),
        (-46.0, 40.0),
        (-38.0, 55.0),
        (-26.0, 63.0),
        (-6.0, 64.0),
        (8.0, 57.0),
    ]
    body += [
        (19.0, 42.0),
        (36.0, 38.5),
        (54.0, 34.0),
        (63.0, 26.0),
        (64.0, 14.0),
        (58.0, 9.0),
        (0.0, 8.0),
        (-56.0, 8.5),
    ]
    outline = shapes.smooth_closed(body, 4)
    front_window = shapes.smooth_closed([(-8.0, 43.0), (-8.0, 56.0), (1.0, 54.5), (9.5, 45.0), (8.0, 42.5)], 4)
    rear_window = shapes.smooth_closed([(-35.0, 43.0), (-29.0, 54.0), (-15.0, 57.0), (-14.0, 44.0)], 4)
    shapes.extrude(bm, [outline, front_window, rear_window], 46.0, 0, 3.2, 3)
    for x in (-37.0, 37.0):
        for side in (-1.0, 1.0):
            wheel(bm, x, side)
    along_x = Matrix.Rotation(math.pi / 2, 4, "Y")
    lamp = [(0.0, -4.0, 3), (6.5, -4.0, 3), (6.5, 1.0, 4), (5.6, 2.2, 4), (5.2, 2.0, 3), (3.2, 3.4, 3), (0.0, 4.0, 3)]
    for y in (-13.0, 13.0):
        shapes.lathe(bm, lamp, 24, Matrix.Translation((62.0, y, 23.0)) @ along_x)
    # A fuel cap on the left only, and a roof rack set to the rear: no half turn brings the car back onto itself.
    cap = [(0.0, -2.0, 4), (5.0, -2.0, 4), (5.0, 2.2, 4), (4.2, 3.0, 4), (0.0, 3.0, 4)]
    shapes.lathe(bm, cap, 24, Matrix.Translation((-50.0, 23.0, 29.0)) @ Matrix.Rotation(-math.pi / 2, 4, "X"))
    for y in (-12.0, 0.0, 12.0):
        rail = [(0.0, -17.0, 1), (2.6, -17.0, 1), (3.0, -16.2, 1), (3.0, 16.2, 1), (2.6, 17.0, 1), (0.0, 17.0, 1)]
        shapes.lathe(bm, rail, 16, Matrix.Translation((-15.0, y, 66.0)) @ along_x)
    bmesh.ops.translate(bm, vec=(0.0, 0.0, -32.0), verts=bm.verts[:])
    finish(model, bm, math.radians(35))
    return model


def wheel(bm, x, side):
    """Lies against the body's side with a little air, its axle goes in."""
    profile = [
        (0.0, -3.0, 1),
        (4.0, -3.0, 1),
        (4.0, 1.0, 1),
        (15.0, 1.0, 2),
        (17.2, 2.0, 2),
        (18.0, 4.0, 2),
        (18.0, 9.0, 2),
    ]
    profile += [
        (17.2, 11.0, 2),
        (15.0, 12.0, 2),
        (12.6, 12.0, 2),
        (12.0, 10.6, 1),
        (5.4, 10.6, 1),
        (5.2, 13.2, 3),
        (3.6, 14.4, 3),
        (0.0, 14.8, 3),
    ]
    turn = Matrix.Rotation(-math.pi / 2 if side > 0 else math.pi / 2, 4, "X")
    shapes.lathe(bm, profile, 40, Matrix.Translation((x, side * 23.0, 18.0)) @ turn)


# ---- from a bmesh to arrays, and from arrays to what is rendered ------------------------------------------------------


def finish(model, bm, smooth_angle, texture_pixels=None):
    """Triangulates, splits vertices where a normal or a colour jumps, and fills the model's arrays.

    The arrays, rounded as the file holds them, are what is rendered too: there is no second version of the shape.
    """
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces[:])
    bmesh.ops.triangulate(bm, faces=bm.faces[:])
    mesh = bpy.data.meshes.new(model.name)
    bm.to_mesh(mesh)
    bm.free()
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    mesh.use_auto_smooth = True
    mesh.auto_smooth_angle = smooth_angle
    mesh.calc_normals_split()
    uv = mesh.uv_layers.active.data if mesh.uv_layers.active else None
    rows, numbers, triangles, regions = [], {}, [], []
    for polygon in mesh.polygons:
        corners = []
        for loop_index in polygon.loop_indices:
            loop = mesh.loops[loop_index]
            normal = tuple(round(value, 4) for value in loop.normal)
            coordinates = tuple(round(value, 5) for value in uv[loop_index].uv) if uv else ()
            key = (loop.vertex_index, normal, polygon.material_index, coordinates)
            if key not in numbers:
                numbers[key] = len(rows)
                rows.append(key)
            corners.append(numbers[key])
        triangles.append(corners)
        regions.append(polygon.material_index)
    rows, triangles, regions = in_order(rows, triangles, regions, mesh)
    model.positions = np.array([mesh.vertices[row[0]].co[:] for row in rows], np.float32)
    model.normals = np.array([row[1] for row in rows], np.float32)
    model.colors = np.array([model.regions[row[2]][1] for row in rows], np.uint8)
    model.triangles = np.array(triangles, np.int32)
    model.triangle_regions = np.array(regions, np.int32)
    if uv:
        model.uvs = np.array([row[3] for row in rows], np.float32)
        model.colors = sample(texture_pixels, model.uvs)
    bpy.data.meshes.remove(mesh)


def in_order(rows, triangles, regions, mesh):
    """Vertices by where they are, triangles by their vertices: Blender's bevel numbers them differently each time."""
    order = sorted(range(len(rows)), key=lambda i: (mesh.vertices[rows[i][0]].co[:], rows[i][1:]))
    place = {old: new for new, old in enumerate(order)}
    sorted_triangles = []
    for corners, region in zip(triangles, regions):
        a, b, c = (place[corner] for corner in corners)
        sorted_triangles.append((min((a, b, c), (b, c, a), (c, a, b)), region))
    sorted_triangles.sort()
    return [rows[i] for i in order], [t for t, _ in sorted_triangles], [region for _, region in sorted_triangles]


def sample(texture, uvs):
    """The texture's colours at the vertices, for readers that know no textures."""
    height, width = texture.shape[:2]
    columns = np.clip((uvs[:, 0] % 1.0) * width, 0, width - 1).astype(int)
    rows = np.clip((1.0 - uvs[:, 1]) * height, 0, height - 1).astype(int)
    return texture[rows, columns, :3]


def to_blender(model, materials):
    """The object as it is rendered: the file's arrays, in metres."""
    mesh = bpy.data.meshes.new(model.name)
    mesh.from_pydata((model.positions.astype(np.float64) / 1000.0).tolist(), [], model.triangles.tolist())
    mesh.polygons.foreach_set("use_smooth", [True] * len(mesh.polygons))
    mesh.polygons.foreach_set("material_index", model.triangle_regions.tolist())
    mesh.use_auto_smooth = True
    mesh.auto_smooth_angle = math.pi
    mesh.normals_split_custom_set_from_vertices(model.normals.tolist())
    if model.uvs is not None:
        layer = mesh.uv_layers.new(name="uv")
        layer.data.foreach_set("uv", model.uvs[model.triangles.reshape(-1)].reshape(-1))
    for material_name, color in model.regions:
        mesh.materials.append(materials.get(material_name, color))
    found = bpy.data.objects.new(model.name, mesh)
    bpy.context.scene.collection.objects.link(found)
    found.pass_index = model.obj_id
    return found
