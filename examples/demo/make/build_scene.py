"""The table, the room, the light and the clutter. Metres here, as Blender likes; the table's top is z = 0."""

import math
import random

import bmesh
import bpy
from mathutils import Euler, Matrix, Vector, noise

import materials as paintbox
import shapes

MM = 0.001


def add(name, bm, material, smooth_deg=40.0):
    mesh = bpy.data.meshes.new(name)
    bmesh.ops.recalc_face_normals(bm, faces=bm.faces[:])
    bm.to_mesh(mesh)
    bm.free()
    for polygon in mesh.polygons:
        polygon.use_smooth = True
    mesh.use_auto_smooth = True
    mesh.auto_smooth_angle = math.radians(smooth_deg)
    for each in material if isinstance(material, list) else [material]:
        mesh.materials.append(each)
    found = bpy.data.objects.new(name, mesh)
    bpy.context.scene.collection.objects.link(found)
    return found


def box(name, size, location, material, rotation=(0.0, 0.0, 0.0), bevel=0.0):
    bm = bmesh.new()
    bmesh.ops.create_cube(bm, size=1.0)
    bmesh.ops.scale(bm, vec=size, verts=bm.verts[:])
    if bevel > 0.0:
        bmesh.ops.bevel(bm, geom=bm.edges[:], offset=bevel, segments=2, profile=0.5, affect="EDGES")
    found = add(name, bm, material)
    found.location, found.rotation_euler = location, rotation
    return found


def turned(name, profile_mm, location, material, rotation=(0.0, 0.0, 0.0), segments=48):
    bm = bmesh.new()
    shapes.lathe(bm, [(r * MM, z * MM, 0) for r, z in profile_mm], segments)
    found = add(name, bm, material)
    found.location, found.rotation_euler = location, rotation
    return found


def table(generator):
    top = paintbox.wood("oak", (136, 104, 74), "x", 1.0, 0.42, per_object=True)
    width = 0.118
    for i in range(-5, 5):
        shift = generator.uniform(-0.04, 0.04)
        box(f"plank {i}", (1.7, width - 0.0012, 0.034), (shift, (i + 0.5) * width, -0.017), top, bevel=0.0016)
    for x in (-0.7, 0.7):
        for y in (-0.5, 0.5):
            box("leg", (0.07, 0.07, 0.72), (x, y, -0.394), top)


def room():
    wall = paintbox.matte("plaster", (188, 186, 172), 0.9, 0.05, 6.0, 0.2)
    box("back wall", (5.0, 0.1, 3.2), (0.3, 2.05, 0.86), wall)
    box("right wall", (0.1, 5.0, 3.2), (2.5, -0.3, 0.86), wall)
    box("floor", (6.0, 6.0, 0.05), (0.0, 0.0, -0.78), paintbox.wood("floor", (122, 88, 60), "x", 0.5, 0.5))
    # The left wall stands around a window.
    box("left below", (0.1, 5.0, 0.95), (-1.75, -0.3, -0.27), wall)
    box("left above", (0.1, 5.0, 0.9), (-1.75, -0.3, 2.05), wall)
    box("left behind", (0.1, 1.5, 1.4), (-1.75, 1.45, 0.9), wall)
    box("left before", (0.1, 1.5, 1.4), (-1.75, -2.05, 0.9), wall)
    frame = paintbox.matte("window frame", (222, 220, 210), 0.5, 0.03)
    for y in (-1.3, -0.66, 0.02, 0.7):
        box("bar", (0.05, 0.06, 1.4), (-1.74, y, 0.9), frame)
    for z in (0.22, 0.62, 1.58):
        box("bar", (0.05, 2.0, 0.05), (-1.74, -0.3, z), frame)
    sideboard()


def sideboard():
    """What the camera sees out of focus behind the table."""
    generator = random.Random(5)
    board = paintbox.wood("sideboard", (110, 72, 46), "x", 0.8, 0.5)
    box("sideboard", (1.9, 0.4, 0.6), (-0.35, 1.78, -0.46), board, bevel=0.006)
    box("shelf", (1.6, 0.24, 0.03), (-0.2, 1.88, 0.42), board, bevel=0.003)
    x = -0.92
    tones = [(150, 62, 48), (58, 82, 96), (196, 176, 130), (92, 104, 76), (66, 58, 72), (206, 200, 186), (176, 118, 60)]
    covers = [paintbox.matte(f"cover {i}", tone, 0.7, 0.1) for i, tone in enumerate(tones)]
    while x < 0.1:
        width, height = generator.uniform(0.02, 0.045), generator.uniform(0.17, 0.25)
        box(
            "shelf book",
            (width, 0.16, height),
            (x + width / 2, 1.86, 0.435 + height / 2),
            generator.choice(covers),
            (0.0, generator.uniform(-0.03, 0.03), 0.0),
            0.002,
        )
        x += width + 0.002
    pot = paintbox.clay("terracotta", (168, 98, 66))
    turned(
        "pot", [(0, 0), (52, 0), (66, 96), (72, 98), (72, 116), (64, 116), (60, 92), (0, 90)], (0.42, 1.86, 0.435), pot
    )
    plant(Vector((0.42, 1.86, 0.54)), 26, 0.24, generator)
    turned(
        "vase",
        [(0, 0), (50, 0), (84, 70), (78, 150), (34, 210), (30, 250), (40, 268), (0, 268)],
        (-0.9, 1.74, -0.16),
        paintbox.glaze("vase", (92, 118, 104)),
    )
    turned(
        "bowl",
        [(0, 0), (60, 0), (130, 60), (136, 84), (130, 84), (0, 20)],
        (-0.35, 1.72, -0.16),
        paintbox.glaze("bowl", (208, 196, 172)),
    )
    for i, (x, z) in enumerate([(-0.41, -0.06), (-0.3, -0.06), (-0.36, -0.02)]):
        ball(f"orange {i}", (x, 1.72, z), 0.042, paintbox.matte(f"orange {i}", (214, 120, 30), 0.5, 0.06, 200.0, 0.3))
    lamp = paintbox.matte("lamp shade", (226, 206, 168), 0.9, 0.03)
    turned(
        "lamp foot",
        [(0, 0), (70, 0), (70, 12), (10, 20), (8, 250), (0, 250)],
        (0.3, 1.74, -0.16),
        paintbox.metal("lamp metal", (150, 130, 90)),
    )
    turned("lamp shade", [(110, 210), (75, 390)], (0.3, 1.74, -0.16), lamp)
    picture = paintbox.matte("picture", (74, 96, 112), 0.8, 0.5, 5.0, 0.0)
    box("picture", (0.62, 0.02, 0.44), (-0.2, 1.985, 1.05), picture)
    box("picture frame", (0.68, 0.016, 0.50), (-0.2, 1.992, 1.05), board)
    # Towards the right wall: a chair's back and a cupboard.
    cupboard = paintbox.paint("cupboard", (96, 112, 108), 0.55)
    box("cupboard", (0.5, 1.0, 1.7), (2.15, 0.9, 0.1), cupboard, bevel=0.008)
    box("cupboard door", (0.02, 0.42, 1.5), (1.89, 0.66, 0.1), cupboard, bevel=0.008)
    for z in (0.0, 0.12, 0.24):
        box("chair slat", (0.4, 0.025, 0.07), (0.85, 1.0, z + 0.02), board, (0.1, 0.0, -0.5), 0.006)
    for x in (-0.2, 0.2):
        box("chair post", (0.035, 0.035, 1.1), (0.85 + x * 0.88, 1.0 - x * 0.48, -0.22), board, bevel=0.006)


def ball(name, location, radius, material, squash=(1.0, 1.0, 1.0), rotation=(0.0, 0.0, 0.0)):
    bm = bmesh.new()
    bmesh.ops.create_uvsphere(bm, u_segments=32, v_segments=20, radius=radius)
    bmesh.ops.scale(bm, vec=squash, verts=bm.verts[:])
    found = add(name, bm, material, 180.0)
    found.location, found.rotation_euler = location, rotation
    return found


def plant(root, leaves, length, generator):
    green = [
        paintbox.matte(f"leaf {i}", tone, 0.45, 0.2, 60.0)
        for i, tone in enumerate([(62, 104, 52), (88, 126, 62), (48, 86, 52)])
    ]
    for _ in range(leaves):
        heading, rise, size = (
            generator.uniform(0, 2 * math.pi),
            generator.uniform(0.2, 1.3),
            length * generator.uniform(0.6, 1.0),
        )
        bm = bmesh.new()
        rows = []
        for i in range(9):
            t = i / 8
            half_width = 0.16 * size * math.sin(math.pi * min(1.0, t * 0.92 + 0.08)) ** 0.8 + 0.0004
            x = size * (t * math.cos(rise) + 0.15 * t * t)
            z = size * (t * math.sin(rise) - 0.45 * t * t)
            rows.append([bm.verts.new((x, y * half_width, z + abs(y) * half_width * 0.3)) for y in (-1.0, 0.0, 1.0)])
        for a, b in zip(rows, rows[1:]):
            for k in range(2):
                bm.faces.new([a[k], a[k + 1], b[k + 1], b[k]])
        found = add("leaf", bm, generator.choice(green), 180.0)
        found.location, found.rotation_euler = root, (0.0, 0.0, heading)


def light():
    scene = bpy.context.scene
    world = bpy.data.worlds.new("room")
    scene.world = world
    world.use_nodes = True
    world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.92, 0.92, 0.95, 1.0)
    world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.30
    lamp(
        "window",
        "AREA",
        (-1.62, -0.3, 0.9),
        (0.0, math.radians(-98), 0.0),
        30.0,
        (0.86, 0.93, 1.0),
        size=1.9,
        size_y=1.3,
    )
    # Afternoon sun through the bars of the window: the hard light.
    sun = lamp("sun", "SUN", (0, 0, 0), (0, 0, 0), 6.5, (1.0, 0.89, 0.74))
    direction = Vector((1.74, 0.22, -0.98))
    sun.rotation_euler = direction.to_track_quat("-Z", "Y").to_euler()
    sun.data.angle = math.radians(0.9)
    # What the window shows to the camera and to mirrors; the lamps above do the lighting.
    sky = box("sky", (0.02, 3.0, 2.4), (-2.3, -0.3, 1.0), paintbox.glow("sky", (206, 222, 240), 5.0))
    sky.visible_diffuse = False
    sky.visible_shadow = False
    sky.data.materials[0].cycles.sample_as_light = False


def lamp(name, kind, location, rotation, power, color, **settings):
    data = bpy.data.lights.new(name, kind)
    data.energy, data.color = power, color
    if kind == "AREA":
        data.shape = "RECTANGLE"
    for key, value in settings.items():
        setattr(data, key, value)
    found = bpy.data.objects.new(name, data)
    found.location, found.rotation_euler = location, rotation
    found.visible_camera = False
    bpy.context.scene.collection.objects.link(found)
    return found


def clutter(build_folder, generator):
    books()
    paper(build_folder)
    pencils()
    cable()
    napkin()
    small_things(generator)
    crumbs(generator)


def books():
    pages = paintbox.matte("pages", (222, 212, 186), 0.9, 0.08, 400.0)
    stack = [
        ((0.235, 0.168, 0.032), (112, 44, 40), 12.0),
        ((0.205, 0.142, 0.024), (54, 78, 92), 4.0),
        ((0.18, 0.124, 0.019), (186, 164, 112), 20.0),
    ]
    z = 0.0
    for i, (size, tone, turn) in enumerate(stack):
        cover = paintbox.fabric(f"book cloth {i}", tone)
        rotation = (0.0, 0.0, math.radians(turn))
        x, y = -0.325 + 0.008 * i, 0.185 - 0.004 * i
        for dz in (0.0014, size[2] - 0.0014):
            box("cover", (size[0], size[1], 0.0028), (x, y, z + dz), cover, rotation, 0.0006)
        spine = Matrix.Rotation(rotation[2], 4, "Z") @ Vector((0.0, -size[1] / 2, 0.0))
        box("spine", (size[0], 0.0028, size[2]), (x + spine.x, y + spine.y, z + size[2] / 2), cover, rotation, 0.0006)
        box("pages", (size[0] - 0.008, size[1] - 0.006, size[2] - 0.005), (x, y, z + size[2] / 2), pages, rotation)
        z += size[2] + 0.0006
    box(
        "matchbox",
        (0.054, 0.036, 0.014),
        (-0.315, 0.165, z + 0.0072),
        paintbox.paint("matchbox", (40, 70, 110), 0.7),
        (0.0, 0.0, 0.5),
        0.0006,
    )


def paper(build_folder):
    """A sheet that does not lie quite flat, under the car and the nut."""
    page = paintbox.printed("page", build_folder / "page.png", 0.85)
    bm = bmesh.new()
    layer = bm.loops.layers.uv.new("uv")
    nx, ny, width, height = 24, 34, 0.19, 0.268
    grid = []
    for j in range(ny + 1):
        row = []
        for i in range(nx + 1):
            u, v = i / nx, j / ny
            x, y = (u - 0.5) * width, (v - 0.5) * height
            # Flat where things stand on it, one corner curls up.
            curl = max(0.0, u * 0.9 + (1.0 - v) - 1.55)
            row.append((bm.verts.new((x, y, 0.0002 + 0.085 * curl * curl)), (u, v)))
        grid.append(row)
    for j in range(ny):
        for i in range(nx):
            corners = [grid[j][i], grid[j][i + 1], grid[j + 1][i + 1], grid[j + 1][i]]
            face = bm.faces.new([vertex for vertex, _ in corners])
            for loop, (_, uv) in zip(face.loops, corners):
                loop[layer].uv = uv
    found = add("paper", bm, page, 180.0)
    found.location, found.rotation_euler = (0.012, -0.135, 0.0), (0.0, 0.0, math.radians(17))


def pencils():
    wood = paintbox.wood("pencil wood", (206, 164, 112), "x", 3.0)
    lead = paintbox.matte("lead", (38, 38, 40), 0.5, 0.02)
    for name, tone, (x, y), heading, length in [
        ("pencil a", (206, 150, 30), (0.092, -0.154), 19.0, 160.0),
        ("pencil b", (38, 66, 52), (-0.245, -0.133), 63.0, 150.0),
    ]:
        lacquer = paintbox.paint(name, tone, 0.3)
        turn = Euler((0.0, math.radians(90), math.radians(heading))).to_matrix().to_4x4()
        place = Matrix.Translation((x, y, 0.0036)) @ turn
        for part, profile, material in [
            ("body", [(0, 0), (3.7, 0), (3.7, length), (0, length)], lacquer),
            ("cone", [(3.7, length), (1.0, length + 13)], wood),
            ("tip", [(1.0, length + 13), (0.2, length + 17)], lead),
        ]:
            bm = bmesh.new()
            shapes.lathe(bm, [(r * MM, z * MM, 0) for r, z in profile], 6 if part == "body" else 18)
            found = add(f"{name} {part}", bm, material, 25.0)
            found.matrix_world = place


def cable():
    """A charging cable that crosses the table's right side."""
    rubber = paintbox.matte("cable", (232, 230, 224), 0.55, 0.03)
    points = [
        (0.62, 0.30),
        (0.45, 0.22),
        (0.33, 0.245),
        (0.235, 0.18),
        (0.27, 0.08),
        (0.345, 0.05),
        (0.36, -0.03),
        (0.285, -0.06),
        (0.232, -0.03),
    ]
    path = shapes.smooth_open(points, 12)
    curve = bpy.data.curves.new("cable", "CURVE")
    curve.dimensions, curve.bevel_depth, curve.bevel_resolution = "3D", 0.0019, 3
    spline = curve.splines.new("POLY")
    spline.points.add(len(path) - 1)
    for point, (x, y) in zip(spline.points, path):
        point.co = (x, y, 0.002, 1.0)
    curve.materials.append(rubber)
    bpy.context.scene.collection.objects.link(bpy.data.objects.new("cable", curve))
    direction = math.atan2(path[-1][1] - path[-3][1], path[-1][0] - path[-3][0])
    box(
        "plug",
        (0.024, 0.011, 0.006),
        (path[-1][0] - 0.008, path[-1][1] + 0.006, 0.0032),
        rubber,
        (0.0, 0.0, direction),
        0.0015,
    )
    box(
        "contact",
        (0.009, 0.008, 0.0026),
        (path[-1][0] - 0.021, path[-1][1] + 0.016, 0.0032),
        paintbox.metal("plug metal", (190, 190, 190)),
        (0.0, 0.0, direction),
        0.0006,
    )


def napkin():
    """A kitchen cloth pushed together at the left."""
    cloth = paintbox.fabric("kitchen cloth", (222, 216, 202), (46, 78, 118))
    bm = bmesh.new()
    count, size = 110, 0.27
    grid = []
    for j in range(count + 1):
        row = []
        for i in range(count + 1):
            x, y = (i / count - 0.5) * size, (j / count - 0.5) * size * 0.72
            p = Vector((x, y, 0.0))
            fold = 0.5 + 0.5 * math.sin(34.0 * (x + 0.5 * y) + 3.0 * noise.noise(p * 9.0))
            edge = min(1.0, 9.0 * min(i / count, 1 - i / count, j / count, 1 - j / count))
            z = 0.002 + (0.017 * fold**2 + 0.008 * noise.noise(p * 22.0 + Vector((3, 1, 0)))) * (0.25 + 0.75 * edge)
            row.append(
                bm.verts.new(
                    (
                        x * 0.92 + 0.012 * noise.noise(p * 7.0),
                        y + 0.016 * noise.noise(p * 6.0 + Vector((9, 0, 0))),
                        max(0.0008, z),
                    )
                )
            )
        grid.append(row)
    for j in range(count):
        for i in range(count):
            bm.faces.new([grid[j][i], grid[j][i + 1], grid[j + 1][i + 1], grid[j + 1][i]])
    found = add("kitchen cloth", bm, cloth, 180.0)
    found.location, found.rotation_euler = (-0.335, -0.03, 0.0), (0.0, 0.0, math.radians(63))


def small_things(generator):
    lemon = paintbox.matte("lemon", (226, 186, 44), 0.42, 0.08, 260.0, 0.5)
    profile = [
        (0, -39),
        (4, -37),
        (7, -33),
        (16, -27),
        (25, -14),
        (27.5, 0),
        (25, 14),
        (16, 27),
        (8, 34),
        (5, 38),
        (0, 40),
    ]
    turned(
        "lemon",
        shapes.smooth_open([(float(r), float(z)) for r, z in profile], 4),
        (0.232, 0.165, 0.0272),
        lemon,
        (math.radians(84), 0.0, math.radians(-50)),
    )
    ball(
        "garlic",
        (0.285, 0.115, 0.0185),
        0.0225,
        paintbox.matte("garlic", (226, 214, 202), 0.5, 0.08, 90.0),
        (1.0, 1.0, 0.84),
    )
    for i, (x, y, tone) in enumerate(
        [(0.075, -0.185, (176, 132, 84)), (0.098, -0.176, (190, 186, 178)), (0.172, 0.002, (170, 120, 74))]
    ):
        coin = paintbox.metal(f"coin {i}", tone, 0.3)
        turned(
            f"coin {i}",
            [(0, 0), (10.5, 0), (11, 0.3), (11, 1.7), (10.5, 2.0), (9.8, 2.0), (9.6, 1.7), (0, 1.7)],
            (x, y, 0.0007),
            coin,
            (0.0, 0.0, generator.uniform(0, 6)),
        )
    spoon()
    # A glass jar of sugar behind, mostly hidden.
    jar = [(0, 0), (38, 0), (40, 3), (40, 70), (32, 80), (32, 84), (36, 84), (36, 100), (0, 100)]
    turned("jar", jar, (-0.02, 0.235, 0.0), paintbox.glaze("stoneware", (196, 184, 160)))
    turned(
        "cork",
        [(0, 98), (30, 98), (31, 112), (0, 113)],
        (-0.02, 0.235, 0.0),
        paintbox.matte("cork", (176, 130, 84), 0.9, 0.3, 300.0, 0.5),
    )
    turned(
        "herb pot",
        [(0, 0), (36, 0), (46, 70), (50, 71), (50, 84), (45, 84), (43, 68), (0, 66)],
        (0.325, 0.30, 0.0),
        paintbox.clay("herb clay", (176, 104, 72)),
    )
    plant(Vector((0.325, 0.30, 0.075)), 30, 0.115, random.Random(3))


def spoon():
    """In front, pointing away: bowl and handle as one lofted strip."""
    steel = paintbox.metal("spoon", (196, 194, 188), 0.18)
    bm = bmesh.new()
    rows = []
    for i in range(41):
        t = i / 40
        x = 0.142 * t
        if t < 0.32:
            half_width = 0.0145 * math.sqrt(max(0.0, 1 - ((t - 0.16) / 0.162) ** 2)) + 0.0008
        else:
            half_width = 0.0026 + 0.0042 * max(0.0, (t - 0.5) / 0.5) ** 2 + 0.004 * max(0.0, 0.40 - t)
        sink = 0.0065 * max(0.0, 1 - ((t - 0.16) / 0.16) ** 2) if t < 0.32 else 0.0
        rise = (
            0.0075
            + 0.008 * math.sin(min(1.0, max(0.0, (t - 0.32) / 0.5)) * math.pi)
            - 0.006 * max(0.0, t - 0.75) / 0.25
        )
        rows.append(
            [
                bm.verts.new((x, s * half_width, rise - sink * (1 - s * s)))
                for s in (-1, -0.75, -0.5, -0.25, 0, 0.25, 0.5, 0.75, 1)
            ]
        )
    for a, b in zip(rows, rows[1:]):
        for k in range(8):
            bm.faces.new([a[k], a[k + 1], b[k + 1], b[k]])
    found = add("spoon", bm, steel, 180.0)
    modifier = found.modifiers.new("thick", "SOLIDIFY")
    modifier.thickness, modifier.offset = 0.0012, 0.0
    found.location, found.rotation_euler = (-0.168, -0.196, 0.0), (0.0, 0.0, math.radians(22))


def crumbs(generator):
    bread = paintbox.matte("crumb", (186, 132, 76), 0.9, 0.3, 500.0)
    for _ in range(90):
        spread = generator.gauss(0.0, 0.055), generator.gauss(0.0, 0.04)
        size = generator.uniform(0.0006, 0.0023)
        bm = bmesh.new()
        bmesh.ops.create_icosphere(bm, subdivisions=1, radius=size)
        for vertex in bm.verts:
            vertex.co *= generator.uniform(0.6, 1.25)
        found = add("crumb", bm, bread, 30.0)
        found.location = (0.02 + spread[0], -0.20 + spread[1], size * 0.7)
